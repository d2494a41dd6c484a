#pragma once

#include <comp.hpp>
#include <meshing.hpp>

namespace ngslac {
using namespace ngcomp;

// Splitting of slave faces in place. The bits of `slave` are numbered like the boundary elements;
// the caller updates the topology of the mesh.

// Two-dimensional meshes.
void SplitEdges(netgen::Mesh & mesh, const BitArray & slave);

// Three-dimensional meshes. `hexes`: a quadrilateral between hexahedra alone is divided into
// quadrilaterals, and these hexahedra into hexahedra.
void SplitFaces(netgen::Mesh & mesh, const BitArray & slave, bool hexes);
} // namespace ngslac
