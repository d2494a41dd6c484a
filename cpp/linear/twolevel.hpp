#pragma once
#include "indexmap.hpp"
#include "prolongation.hpp"
#include "sweeporder.hpp"

namespace ngslac {
/// Preconditioner: a Gauss-Seidel sweep forward, a correction, and a sweep backward.
///
/// Symmetric where the system and the correction are. Solves for all dofs of a node at once. The
/// first sweep starts from zero, so that it reads one triangle of the matrix. What counts is memory
/// traffic: the triangles are copied to blocks in single precision.
class TwoLevel : public SquareOperator {
public:
  /// The coarse operator takes what the residual is on a coarse space, and returns the correction.
  TwoLevel(const Condensation & system, shared_ptr<BaseMatrix> coarse,
           const SparseRows & prolongation, FlatArray<int> dofs);

  void Mult(const BaseVector & x, BaseVector & y) const override { Apply(x, y, nullptr); }
  /// y = M^-1 x, and A y where `image` is given, to single precision: what the last sweep leaves.
  void Apply(const BaseVector & x, BaseVector & y, BaseVector * image) const;

private:
  static constexpr int width = SweepOrder::width;
  using Node = std::array<float, width>;
  using Block = std::array<float, width * width>; // column by column

  /// Blocks on one side of the diagonal.
  struct Triangle {
    Array<size_t> first;
    Array<int> columns;
    Array<Block> blocks;

    Node Times(size_t row, FlatArray<Node> z) const;
  };

  void AllocateTriangles();
  void FillRow(const Condensation & system, size_t row, IndexMap & places);
  Node Solved(size_t row, Node right, const Node & product) const;
  void Correct(FlatArray<Node> z) const;

  SweepOrder order;
  shared_ptr<BaseMatrix> coarse;
  Prolongation prolongation;
  Array<Block> diagonal; // inverses
  Triangle lower, upper;
};

/// A M^-1  for this preconditioner M of a matrix A, to single precision.
class TwoLevelProduct : public SquareOperator {
public:
  TwoLevelProduct(shared_ptr<TwoLevel> pre, shared_ptr<Condensation> system)
      : SquareOperator(*pre), pre(pre), system(system) {}
  void Mult(const BaseVector & x, BaseVector & y) const override;

private:
  shared_ptr<TwoLevel> pre;
  shared_ptr<Condensation> system;
};
} // namespace ngslac
