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
  /// Improves z in  A z = b, star by star, the other way round with `back`.
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
  bool IsArranged(FlatArray<int> some) const;
  void Invert(Star & star) const;
  void Solve(const Star & star, FlatArray<Node> b, FlatArray<Node> z) const;
  Array<int> Neighbours(int star) const;
  Array<bool> Changed(const Condensation & system) const;

  NodeOrder order;
  BlockedRows rows;
  Array<bool> condensed; // rows of the present system that are not those of the bulk
  Array<Star> stars;
  Table<int> holding;  // the stars of each node
  Array<int> sequence; // of the stars
  Array<int> chunk;    // of each star
  Array<IntRange> chunks[2];
};
} // namespace ngslac
