// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include "blockedrows.hpp"

namespace ngslac {
/// Sweeps over overlapping stars of nodes, each of which solves for all of a star at once.
///
/// A star holds a vertex and the nodes of edges, faces and elements around it; where that is the
/// vertex alone these are Gauss-Seidel sweeps. What inside of elements couples more strongly than
/// single nodes can tell, as where stiffness jumps there, a star knows. (Multiplicative Schwarz
/// method; for high order Schoeberl, Melenk, Pechstein, Zaglmayr, IMA J. Numer. Anal. 28 (2008)
/// 1-24.)
class StarSweeps {
public:
  using Node = BlockedRows::Node;

  /// Of the scalar dofs `which`. `stars` are dofs, each of which has `dim` entries; what is not in
  /// `which` does not count, and a node in no star makes one.
  StarSweeps(const Condensation & system, const BitArray & which, FlatTable<int> stars, int dim);
  /// Takes over a system whose rows differ from the last one only where either is condensed.
  void Update(const Condensation & system);

  const NodeOrder & Order() const { return order; }
  const BlockedRows & Rows() const { return rows; }
  /// Of nodes and macro-elements.
  size_t NValues() const { return rows.Size() + terms.Size(); }
  /// Makes the values of macro-elements from those of the nodes.
  void SetMacroValues(FlatArray<Node> z) const;
  /// Improves z in  A z = b, star by star, the other way round with `back`; keeps the values of
  /// macro-elements up to date.
  void Sweep(FlatArray<Node> b, FlatArray<Node> z, bool back) const;
  void Gather(FlatVector<> values, FlatArray<Node> nodes) const;
  void Scatter(FlatArray<Node> nodes, FlatVector<> values) const;

private:
  static constexpr int width = NodeOrder::width;

  struct Star {
    Array<int> nodes;
    Array<float> inverse; // column by column
  };

  void FindStars(FlatTable<int> given, int dim);
  void Arrange();
  void AddTerms(const Star & star, Matrix<> & dense) const;
  void Invert(Star & star) const;
  void Solve(const Star & star, FlatArray<Node> b, FlatArray<Node> z) const;
  Array<int> Neighbours(int star) const;
  Array<bool> Changed(const Condensation & system) const;
  void SetTerms(const Condensation & system);
  bool Fill(const Condensation & system, size_t row);

  NodeOrder order;
  BlockedRows rows;
  Array<NodeTerm> terms;          // of the macro-elements
  Table<BlockedRows::Link> links; // of each node
  Array<bool> condensed; // nodes of the present system to which macro-elements add something
  Array<Star> stars;
  Table<int> holding;  // the stars of each node
  Table<int> sharing;  // the stars of each macro-element
  Array<int> sequence; // of the stars
  Array<IntRange> chunks[2];
};
} // namespace ngslac
