// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <comp.hpp>
#include <meshing.hpp>

namespace ngslac {
using namespace ngcomp;

// Splitting of slave faces, which are boundary elements of these numbers, in place;
// the caller updates the topology of the mesh.

// Two-dimensional meshes.
void SplitEdges(netgen::Mesh & mesh, FlatArray<int> slave);

// Three-dimensional meshes. `hexes`: a quadrilateral between hexahedra alone is divided into
// quadrilaterals, and these hexahedra into hexahedra.
void SplitFaces(netgen::Mesh & mesh, FlatArray<int> slave, bool hexes);
} // namespace ngslac
