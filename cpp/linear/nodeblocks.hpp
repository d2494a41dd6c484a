// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include "condense.hpp"

namespace ngslac {
/// Rows of square blocks, of `width` rows and columns each, in the order of their columns.
struct BlockRows {
  int width;
  Array<int> starts, columns;
  Array<double> values; // row by row of each block
};

/// The part of a system that belongs to some nodes, of `width` dofs each.
///
/// `nodes` lists the dofs node by node; -1, or what is not free, is a row of the identity.
BlockRows NodeBlocks(const Condensation & system, FlatArray<int> nodes, int width);
} // namespace ngslac
