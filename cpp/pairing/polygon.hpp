// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <bla.hpp>

namespace ngslac {
using namespace ngbla;

/// A convex polygon in the plane, corners counterclockwise.
class Polygon {
  static constexpr int capacity = 64;
  Vec<2> corners[capacity];
  int n = 0;

public:
  Polygon() = default;
  Polygon(std::initializer_list<Vec<2>> points) {
    for (auto & p : points)
      Append(p);
  }
  Polygon(const Polygon & other) { *this = other; }
  Polygon & operator=(const Polygon & other) {
    n = other.n;
    std::copy(other.corners, other.corners + n, corners);
    return *this;
  }

  int Size() const { return n; }
  const Vec<2> & operator[](int i) const { return corners[i]; }
  void Append(Vec<2> point) {
    if (n == capacity)
      throw Exception("Polygon: too many corners");
    corners[n++] = point;
  }
  void Reverse() { std::reverse(corners, corners + n); }
  /// Positive if the corners are counterclockwise.
  double Area() const;
  Vec<2> Centroid() const;
  bool IsConvex() const;
  bool Contains(Vec<2> point) const;
};

/// The part of `polygon` on the left of the line from a to b. Corners nearer than `tolerance` count
/// as on the line: they are kept and make no new ones.
Polygon Clip(const Polygon & polygon, Vec<2> a, Vec<2> b, double tolerance);

/// The common part of two convex polygons; fewer than three corners if there is none.
Polygon Intersection(const Polygon & p, const Polygon & q, double tolerance);

/// Do the polygons share more than a strip of width `tolerance`?
bool Overlap(const Polygon & p, const Polygon & q, double tolerance);

/// Appends convex polygons that make up p without q.
void Subtract(const Polygon & p, const Polygon & q, double tolerance, Array<Polygon> & parts);
} // namespace ngslac
