// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include "condense.hpp"

namespace ngslac {
/// The nodes of a graph in the order of breadth-first searches, in chunks for sweeps in parallel.
///
/// A chunk, one level of a search or several, is coupled to the two chunks beside it only; there is
/// one chunk for all where that is impossible. The order does not depend on the number of threads.
struct Levels {
  Array<int> nodes;
  Array<IntRange> chunks; // of positions in nodes

  explicit Levels(FlatArray<Array<int>> neighbours);
};

/// Some dofs of a system, gathered to nodes that follow each other in a breadth-first search.
struct NodeOrder {
  static constexpr int width = 3; // at most so many dofs to a node

  Array<int> slot; // of each dof: width * (position of its node) + number there, or -1
  Array<int> dofs; // of each slot, -1 where a node has fewer

  /// Those in `which`: dofs with equal rows, multipliers aside, make a node.
  NodeOrder(const Condensation & system, const BitArray & which);

  size_t Size() const { return dofs.Size() / width; }
};
} // namespace ngslac
