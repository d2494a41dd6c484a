// SPDX-License-Identifier: LGPL-2.1-or-later
#include "layers.hpp"

namespace ngslac {
namespace {
netgen::Box<2> BoxOf(const Polygon & polygon) {
  netgen::Box<2> box(netgen::Box<2>::EMPTY_BOX);
  for (int i : Range(polygon.Size()))
    box.Add(netgen::Point<2>(polygon[i](0), polygon[i](1)));
  return box;
}

/// Is piece a nearer than piece b, in the middle of where they overlap?
bool IsNearer(const Piece & a, const Piece & b) {
  Vec<2> p = Intersection(a.polygon, b.polygon, 0).Centroid();
  return fabs(a.Gap(p)) <= fabs(b.Gap(p));
}

/// Appends what is left of a piece.
void Without(const Piece & piece, const Polygon & hole, double tolerance, Array<Piece> & rest) {
  Array<Polygon> polygons;
  Subtract(piece.polygon, hole, tolerance, polygons);
  for (auto & polygon : polygons)
    rest.Append(Piece{polygon, piece.master, piece.gap, piece.tilt});
}

/// The nearer of two pieces keeps the part that both cover, so that no part gets lost.
void Separate(Array<Piece> & old, Array<Piece> & parts, double tolerance) {
  Array<Piece> all;
  for (auto & other : old) {
    Array<Piece> rest, shortened{other};
    for (auto & part : parts)
      if (!Overlap(part.polygon, other.polygon, tolerance))
        rest.Append(part);
      else if (IsNearer(other, part))
        Without(part, other.polygon, tolerance, rest);
      else { // all parts belong to one master facet: what is left of the other one is behind
        rest.Append(part);
        Array<Piece> remaining;
        for (auto & piece : shortened)
          Without(piece, part.polygon, tolerance, remaining);
        Swap(shortened, remaining);
      }
    Swap(parts, rest);
    all += shortened;
  }
  Swap(old, all);
}
} // namespace

void Layers::Plant() {
  Array<netgen::Box<2>> boxes;
  for (auto & piece : pieces)
    boxes.Append(BoxOf(piece.polygon));
  tree.emplace(std::move(boxes));
}

void Layers::FindOverlaps(int i, double tolerance, Array<int> & found) const {
  found.SetSize0();
  auto & polygon = pieces[i].polygon;
  tree->Visit(BoxOf(polygon), [&](int j) {
    if (j < i && Overlap(polygon, pieces[j].polygon, tolerance))
      found.Append(j);
  });
  QuickSort(found);
}

void Layers::RemoveHidden(double tolerance) {
  Plant();
  Array<pair<int, int>> overlaps;
  Array<int> others;
  for (int i : Range(pieces)) {
    FindOverlaps(i, tolerance, others);
    for (int j : others)
      overlaps.Append(pair(j, i));
  }
  if (overlaps.Size() == 0)
    return;
  Array<Array<Piece>> visible(pieces.Size()); // parts of each
  for (int i : Range(pieces))
    visible[i].Append(pieces[i]);
  for (auto [j, i] : overlaps)
    Separate(visible[j], visible[i], tolerance);
  pieces.SetSize0();
  for (auto & parts : visible)
    pieces += parts;
  Plant();
}

void Layers::Remove(FlatArray<bool> marked) {
  size_t kept = 0;
  for (size_t i : Range(pieces))
    if (!marked[i])
      pieces[kept++] = Piece(pieces[i]);
  pieces.SetSize(kept);
  Plant();
}

const Piece * Layers::Covering(Vec<2> point) const {
  const Piece * found = nullptr;
  tree->Visit(BoxOf(Polygon{point}), [&](int i) {
    if (pieces[i].polygon.Contains(point) && (!found || &pieces[i] < found))
      found = &pieces[i];
  });
  return found;
}
} // namespace ngslac
