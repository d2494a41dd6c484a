// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include "gmres.hpp"
#include "starsweeps.hpp"

namespace ngslac {
/// Preconditioner: a sweep forward, a correction on a coarse space, and a sweep backward.
///
/// Symmetric where the system and the correction are.
class TwoLevel : public SquareOperator {
public:
  using Node = BlockedRows::Node;

  /// The coarse operator takes the residual on some dofs, and returns their correction.
  TwoLevel(const Condensation & system, shared_ptr<StarSweeps> sweeps,
           shared_ptr<BaseMatrix> coarse, FlatArray<int> dofs);

  /// y = M^-1 x
  void Mult(const BaseVector & x, BaseVector & y) const override;
  /// y = K x  without what macro-elements add, to single precision.
  void MultBulk(const BaseVector & x, BaseVector & y) const;

private:
  static constexpr int width = NodeOrder::width;
  void Correct(FlatArray<Node> b, FlatArray<Node> z) const;

  shared_ptr<StarSweeps> sweeps;
  shared_ptr<BaseMatrix> coarse;
  Array<std::pair<int, int>> places; // slot of each dof, in ascending order, and its number
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
