#pragma once
#include "condense.hpp"

namespace ngslac {
/// The free dofs of a system, gathered to nodes, in an order for sweeps in parallel.
///
/// Nodes follow the levels of a breadth-first search. A chunk, one level or several, is coupled to
/// the two chunks beside it only: all even chunks are swept at the same time, and then all odd
/// ones. The order, and with it the result, does not depend on the number of threads.
struct SweepOrder {
  static constexpr int width = 3; // at most so many dofs to a node

  Array<int> slot;           // of each dof: width * (position of its node) + number there, or -1
  Array<int> dofs;           // of each slot, -1 where a node has fewer
  Array<IntRange> chunks[2]; // positions
  Array<Array<int>> coupled; // of each position: the others in its rows

  /// Dofs with equal rows, multipliers aside, make a node.
  SweepOrder(const Condensation & system);

  size_t Size() const { return coupled.Size(); }
};
} // namespace ngslac
