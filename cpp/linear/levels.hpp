// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <la.hpp>

namespace ngslac {
using namespace ngla;

/// The nodes of a graph in the order of breadth-first searches, in chunks for sweeps in parallel.
///
/// A chunk, one level of a search or several, is coupled to the two chunks beside it only; there is
/// one chunk for all where that is impossible. The order does not depend on the number of threads.
struct Levels {
  Array<int> nodes;
  Array<IntRange> chunks; // of positions in nodes

  explicit Levels(FlatArray<Array<int>> neighbours);
};
} // namespace ngslac
