// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <comp.hpp>
#include <meshing.hpp>

namespace ngslac {
using namespace ngcomp;

// The paper's mesh modification: a new mesh in which every edge (in 3D: face) of the slave region
// carries vertices of its own, so that a lowest order displacement has a basis function supported
// by the parent alone. Only the volume elements on these edges or faces are split. The given mesh
// stays as it is; the new one is curved to the same order. `hexes` chooses the pattern of hexahedra
// in 3D: "pyramids" or "hexes".
shared_ptr<MeshAccess> SplitSlaveFaces(shared_ptr<MeshAccess> mesh, const Region & slave,
                                       const string & hexes = "pyramids");

// Splitting of slave faces, which are boundary elements of these numbers, in place;
// the caller updates the topology of the mesh.

// Two-dimensional meshes.
void SplitEdges(netgen::Mesh & mesh, FlatArray<int> slave);

// Three-dimensional meshes. `hexes`: a quadrilateral between hexahedra alone is divided into
// quadrilaterals, and these hexahedra into hexahedra.
void SplitFaces(netgen::Mesh & mesh, FlatArray<int> slave, bool hexes);
} // namespace ngslac
