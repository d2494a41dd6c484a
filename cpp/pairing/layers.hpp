// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include "boxtree.hpp"
#include "facets.hpp"
#include "polygon.hpp"

namespace ngslac {
/// A part of a slave facet that faces one master facet.
struct Piece {
  Polygon polygon;
  const Facet * master;
  double gap;  // to the plane of the master facet, at the origin of the slave facet
  Vec<2> tilt; // its slope
  double Gap(Vec<2> p) const { return gap + InnerProduct(tilt, p); }
};

/// The pieces of one slave facet, which may lie behind each other.
class Layers {
  Array<Piece> pieces;
  optional<BoxTree<2>> tree; // of the pieces that are left

public:
  void Clear() { pieces.SetSize0(); }
  void Append(const Piece & piece) { pieces.Append(piece); }
  auto begin() const { return pieces.begin(); }
  auto end() const { return pieces.end(); }

  /// Where master facets lie behind each other only the nearest counts.
  void RemoveHidden(double tolerance);
  /// Leaves out those that are marked.
  void Remove(FlatArray<bool> marked);
  size_t Size() const { return pieces.Size(); }
  const Piece & operator[](size_t i) const { return pieces[i]; }
  /// The piece that covers a point, if there is one.
  const Piece * Covering(Vec<2> point) const;

private:
  void Plant();
  /// Pieces before this one in the list that share more than an edge with it.
  void FindOverlaps(int i, double tolerance, Array<int> & found) const;
};
} // namespace ngslac
