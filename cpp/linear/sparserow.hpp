// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include "indexmap.hpp"

namespace ngslac {
/// Columns and values.
struct SparseRow {
  Array<int> columns;
  Array<double> values;
};

/// Calls f(i, sum) for all i, in parallel, with one RowSum per range.
template <typename F>
void ForEachSum(size_t count, F f) {
  ParallelForRange(count, [&](IntRange range) {
    RowSum sum;
    for (auto i : range)
      f(i, sum);
  });
}
} // namespace ngslac
