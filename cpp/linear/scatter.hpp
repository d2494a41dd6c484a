// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <bla.hpp>

namespace ngslac {
using namespace ngbla;

/// Numbers to be added to a vector later: threads that add at once would do so in the order in
/// which they arrive, and sums would differ in the last bits from run to run.
class Scatter {
  Array<std::pair<int, double>> entries;

public:
  void Add(int dof, double value) { entries.Append(std::pair(dof, value)); }
  FlatArray<std::pair<int, double>> Entries() const { return entries; }
  void AddTo(FlatVector<> y) const {
    for (auto [dof, value] : entries)
      y(dof) += value;
  }
};

/// Runs f(i, heap, scatter) for 0 <= i < n in threads, and adds up in the order of i.
template <typename F>
void ScatterInOrder(size_t n, FlatVector<> y, F f) {
  Array<Scatter> parts(4 * TaskManager::GetNumThreads());
  LocalHeap heap(20 * 1000 * 1000, "ngslac-scatter", true);
  ParallelFor(
      parts.Size(),
      [&](size_t part) {
        LocalHeap lh = heap.Split();
        for (auto i : IntRange(n).Split(part, parts.Size())) {
          HeapReset hr(lh);
          f(i, lh, parts[part]);
        }
      },
      parts.Size());
  for (auto & part : parts)
    part.AddTo(y);
}
} // namespace ngslac
