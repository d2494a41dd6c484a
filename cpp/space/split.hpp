#pragma once

#include <comp.hpp>

namespace ngslac {
using namespace ngcomp;

// The paper's mesh modification: a new mesh in which every edge of the slave region carries nodes
// of its own, so that a lowest order displacement has a basis function supported by the parent edge
// alone. Only the volume elements on these edges are split. The given mesh stays as it is; the new
// one is curved to the same order.
shared_ptr<MeshAccess> SplitSlaveFaces(shared_ptr<MeshAccess> mesh, const Region & slave);

// Quoted names of all boundaries, for messages.
string BoundaryNames(const MeshAccess & ma);
} // namespace ngslac
