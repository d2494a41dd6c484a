// SPDX-License-Identifier: LGPL-2.1-or-later
#include "facets.hpp"

namespace ngslac {
namespace {
// The sides of facets may be off those of their face by this part of the facet's size: it only
// decides to which of two neighbouring faces a point near their common edge belongs.
constexpr double tolerance = 0.002;
constexpr int most_divisions = 4;

int Divisions(const Surface<3> & surface, size_t face) {
  // Compared before the conversion to an integer: for a collapsed face it may be huge, or NaN.
  double wanted = ceil(sqrt(surface.Bulge(face) / tolerance));
  return wanted > 1 ? int(min(wanted, double(most_divisions))) : 1;
}

Facet MakeFacet(const Surface<3> & surface, size_t face, bool whole,
                std::initializer_list<Vec<2>> corners) {
  Facet facet;
  facet.face = face;
  facet.whole = whole;
  facet.n = 0;
  for (auto & xi : corners) {
    facet.xi[facet.n] = xi;
    facet.x[facet.n++] = surface.Point(face, xi);
  }
  Mat<3, 2> sides;
  sides.Col(0) = facet.x[facet.n - 2] - facet.x[0];
  sides.Col(1) = facet.x[facet.n - 1] - facet.x[facet.n - 3];
  if (facet.n == 3)
    sides.Col(0) = facet.x[1] - facet.x[0], sides.Col(1) = facet.x[2] - facet.x[0];
  facet.normal = surface.Normal(face, sides);
  facet.size = 0;
  for (int i : Range(facet.n))
    for (int j : Range(i))
      facet.size = max(facet.size, L2Norm(facet.x[i] - facet.x[j]));
  return facet;
}

void Divide(const Surface<3> & surface, size_t face, int k, FlatArray<Facet> facets) {
  size_t count = 0;
  auto at = [&](int i, int j) { return Vec<2>(double(i) / k, double(j) / k); };
  bool trig = surface.Type(face) == ET_TRIG;
  for (int j : Range(k))
    for (int i : Range(trig ? k - j : k)) {
      auto a = at(i, j), b = at(i + 1, j), c = at(i + 1, j + 1), d = at(i, j + 1);
      if (!trig) {
        facets[count++] = MakeFacet(surface, face, k == 1, {a, b, c, d});
        continue;
      }
      facets[count++] = MakeFacet(surface, face, k == 1, {a, b, d});
      if (i + j + 2 <= k)
        facets[count++] = MakeFacet(surface, face, k == 1, {b, c, d});
    }
}
} // namespace

Vec<3> Facet::Center() const {
  Vec<3> sum = 0.0;
  for (int i : Range(n))
    sum += x[i];
  return (1.0 / n) * sum;
}

Vec<2> Facet::Reference(Vec<2> local) const {
  // A cell of a square is a rectangle: its sides are parallel to the axes, as a triangle's two.
  return xi[0] + local(0) * (xi[1] - xi[0]) + local(1) * (xi[n - 1] - xi[0]);
}

Facets::Facets(const Surface<3> & surface) : first(surface.Size() + 1) {
  static Timer timer("ngslac::Facets");
  RegionTimer reg(timer);
  Array<int> divisions(surface.Size());
  ParallelFor(surface.Size(), [&](size_t f) { divisions[f] = Divisions(surface, f); });
  first[0] = 0;
  for (size_t f : Range(surface.Size()))
    first[f + 1] = first[f] + sqr(divisions[f]);
  facets.SetSize(first.Last());
  ParallelFor(surface.Size(), [&](size_t f) {
    Divide(surface, f, divisions[f], facets.Range(first[f], first[f + 1]));
  });
}
} // namespace ngslac
