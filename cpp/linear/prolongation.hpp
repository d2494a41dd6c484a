// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <la.hpp>

namespace ngslac {
using namespace ngla;

/// Rows of a sparse matrix, in single precision.
struct SparseRows {
  Array<int> starts, columns; // of row i: columns[starts[i]], ..., before starts[i + 1]
  Array<float> values;

  size_t Size() const { return starts.Size() - 1; }
  IntRange Row(size_t row) const { return IntRange(starts[row], starts[row + 1]); }
  SparseRows Transposed(size_t width) const;
};

/// From a coarse space to some slots of a NodeOrder, and back.
class Prolongation {
public:
  /// Row i of `rows` belongs to dofs[i]; `slot` is that of each dof.
  Prolongation(const SparseRows & rows, FlatArray<int> dofs, FlatArray<int> slot, size_t width);

  /// Where the coarse functions do not vanish, in ascending order.
  FlatArray<int> Slots() const { return slots; }
  /// coarse = P^T left,  with `left` on the slots
  void Restrict(FlatArray<float> left, FlatVector<> coarse) const;
  /// add(slot, value) with the values  P coarse
  template <typename F>
  void Add(FlatVector<> coarse, F add) const {
    ParallelFor(slots.Size(), [&](size_t i) {
      double sum = 0;
      for (size_t j : rows.Row(i))
        sum += rows.values[j] * coarse(rows.columns[j]);
      add(slots[i], float(sum));
    });
  }

private:
  Array<int> slots;
  SparseRows rows, transposed;
};
} // namespace ngslac
