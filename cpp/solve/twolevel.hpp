#pragma once
#include "sweeporder.hpp"

namespace ngslac {
/// Preconditioner: a Gauss-Seidel sweep forward, a correction, and a sweep backward.
///
/// Symmetric where the system and the correction are. Solves for all dofs of a node at once. The
/// first sweep starts from zero, so that it reads one triangle of the matrix. What counts is memory
/// traffic: the triangles are copied to blocks in single precision.
class TwoLevel : public BaseMatrix {
public:
  /// `coarse` is an approximate inverse of the part of the system that belongs to `coarsedofs`.
  TwoLevel(const Condensation & system, shared_ptr<BaseMatrix> coarse, const BitArray & coarsedofs);

  bool IsComplex() const override { return false; }
  int VHeight() const override { return order.slot.Size(); }
  int VWidth() const override { return order.slot.Size(); }
  VecFormat RowFormat() const override { return format; }
  VecFormat ColFormat() const override { return format; }
  void Mult(const BaseVector & x, BaseVector & y) const override;
  void MultAdd(double s, const BaseVector & x, BaseVector & y) const override;

private:
  static constexpr int width = SweepOrder::width;
  using Node = std::array<float, width>;
  using Block = std::array<float, width * width>; // column by column

  /// Blocks on one side of the diagonal, and one more.
  struct Triangle {
    Array<size_t> first;
    Array<int> columns;
    Array<Block> blocks;

    Node Times(size_t row, FlatArray<Node> z) const;
  };

  void AllocateTriangles();
  void FillRow(const Condensation & system, size_t row, FlatArray<Block *> place);
  Node Solved(size_t row, Node right, const Node & product) const;
  void Correct(FlatArray<Node> z) const;

  SweepOrder order;
  VecFormat format;
  shared_ptr<BaseMatrix> coarse;
  Array<int> coarseslots;
  Array<Block> diagonal; // inverses
  Triangle lower, upper;
};
} // namespace ngslac
