// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include "gmres.hpp"
#include "starsweeps.hpp"

namespace ngslac {
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

/// Preconditioner: a sweep forward, a correction on a coarse space, and a sweep backward.
///
/// Symmetric where the system and the correction are.
class TwoLevel : public SquareOperator {
public:
  using Node = BlockedRows::Node;

  /// The coarse operator takes what the residual is on a coarse space, and returns the correction.
  TwoLevel(const Condensation & system, shared_ptr<StarSweeps> sweeps,
           shared_ptr<BaseMatrix> coarse, const SparseRows & prolongation, FlatArray<int> dofs);

  /// y = M^-1 x
  void Mult(const BaseVector & x, BaseVector & y) const override;
  /// y = K x  without what macro-elements add, to single precision.
  void MultBulk(const BaseVector & x, BaseVector & y) const;

private:
  static constexpr int width = NodeOrder::width;
  void Correct(FlatArray<Node> b, FlatArray<Node> z) const;

  shared_ptr<StarSweeps> sweeps;
  shared_ptr<BaseMatrix> coarse;
  Prolongation prolongation;
};

/// With this preconditioner, to single precision.
class TwoLevelProduct : public PreconditionedProduct {
public:
  TwoLevelProduct(shared_ptr<TwoLevel> pre, shared_ptr<Condensation> system)
      : pre(pre), system(system) {}
  shared_ptr<BaseVector> MakeVector() const override { return system->CreateColVector(); }
  void Apply(const BaseVector & x, BaseVector & z, BaseVector & image) const override;

private:
  shared_ptr<TwoLevel> pre;
  shared_ptr<Condensation> system;
};
} // namespace ngslac
