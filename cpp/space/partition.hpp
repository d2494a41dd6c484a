// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <comp.hpp>

namespace ngslac {
using namespace ngcomp;

/// Slave faces grouped into macro-elements, each with the support of a free basis function inside,
/// apart from those whose displacement is prescribed.
struct MacroPartition {
  Array<int> macro_of_face; // one entry per boundary element of the mesh, -1 off the slave surface
  size_t nmacros = 0;
  Array<Array<int>> cores; // the displacement dofs whose trace lives in the macro-element alone
  Array<Mat<3, 3>> reach;  // projection on the directions in which these move the mean
};

/// The partition that the displacement space itself suggests (Abbas, Drouet, Hild, Pignet 2017,
/// section 2.2: a macro-element contains the support of at least one basis function).
///
/// Supports of free basis functions are chosen disjoint, the smallest first; a face left over joins
/// a neighbour that has not grown too large, or else, if it can move, the smallest one. Directions
/// in which all displacements of its faces are prescribed are not asked of a macro-element. What is
/// left then are faces that cannot move along the normal: macro-elements of one face that reach
/// nothing. Throws where no support is found, or for faces that could move and have no neighbour to
/// join.
MacroPartition PartitionBySupports(const FESpace & displacement, const BitArray & boundaries);

/// A partition that the caller gives (one number per slave face, in the order of the mesh), checked
/// for a free basis function inside of each macro-element.
MacroPartition CheckedPartition(const FESpace & displacement, const BitArray & boundaries,
                                FlatArray<int> macros);
} // namespace ngslac
