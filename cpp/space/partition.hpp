#pragma once
#include <comp.hpp>

namespace ngslac {
using namespace ngcomp;

/// Slave faces grouped into macro-elements, each with the support of a free basis function inside.
struct MacroPartition {
  Array<int> macro_of_face; // one entry per boundary element of the mesh, -1 off the slave surface
  size_t nmacros = 0;
  Array<Array<int>> cores; // the displacement dofs whose trace lives in the macro-element alone
};

/// The partition that the displacement space itself suggests (Abbas, Drouet, Hild, Pignet 2017,
/// section 2.2: a macro-element contains the support of at least one basis function).
///
/// Supports of free basis functions are chosen disjoint, the smallest first; a face left over joins
/// a neighbour. Throws where no free basis function can be found.
MacroPartition PartitionBySupports(const FESpace & displacement, const BitArray & boundaries);

/// A partition that the caller gives (one number per slave face, in the order of the mesh), checked
/// for a free basis function inside of each macro-element.
MacroPartition CheckedPartition(const FESpace & displacement, const BitArray & boundaries,
                                FlatArray<int> macros);
} // namespace ngslac
