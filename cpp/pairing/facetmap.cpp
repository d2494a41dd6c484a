// SPDX-License-Identifier: LGPL-2.1-or-later
#include "facetmap.hpp"

namespace ngslac {
namespace {
constexpr int highest_order = 20;

/// How far a facet is from a parallelogram, relative to its size.
double Twist(const Facet & facet) {
  if (facet.n == 3 || !facet.whole) // a part of a curved face is nearly a parallelogram
    return 0;
  return L2Norm(facet.x[0] - facet.x[1] + facet.x[2] - facet.x[3]) / facet.size;
}
} // namespace

void Tangents(Vec<3> normal, Vec<3> (&tangents)[2]) {
  int least = 0;
  for (int k : {1, 2})
    if (fabs(normal(k)) < fabs(normal(least)))
      least = k;
  Vec<3> axis = 0.0;
  axis(least) = 1;
  tangents[0] = Cross(normal, axis);
  tangents[0] *= 1 / L2Norm(tangents[0]);
  tangents[1] = Cross(normal, tangents[0]);
}

FacetMap::FacetMap(const Facet & afacet) : facet(afacet), origin(afacet.Center()) {
  Tangents(facet.normal, tangents);
  for (int i : Range(facet.n))
    outline.Append(Project(facet.x[i]));
  Vec<2> a = outline[1] - outline[0], b = outline[facet.n - 1] - outline[0];
  twist = facet.n == 3 ? Vec<2>(0.0) : Vec<2>(outline[2] - outline[0] - a - b);
  Mat<2, 2> map;
  map.Col(0) = a, map.Col(1) = b;
  inverse = Inv(map);
  reversed = outline.Area() < 0;
  if (reversed)
    outline.Reverse();
}

pair<Vec<2>, double> FacetMap::Reference(Vec<2> p) const {
  Vec<2> corner = outline[reversed ? facet.n - 1 : 0];
  // p = corner + map local + local_0 local_1 twist, by Newton's method from the parallelogram
  Vec<2> local = inverse * (p - corner), bent = inverse * twist;
  Mat<2, 2> derivative = Id<2>();
  if (facet.n == 4) {
    Vec<2> target = local;
    for (int it = 0; it < 20; it++) {
      derivative = Id<2>();
      derivative.Col(0) += local(1) * bent;
      derivative.Col(1) += local(0) * bent;
      Vec<2> step = Inv(derivative) * (local + local(0) * local(1) * bent - target);
      local -= step;
      if (!(L2Norm(step) > 1e-15))
        break;
    }
  }
  Vec<2> e0 = facet.xi[1] - facet.xi[0], e1 = facet.xi[facet.n - 1] - facet.xi[0];
  double area = fabs((e0(0) * e1(1) - e0(1) * e1(0)) * Det(inverse) / Det(derivative));
  return {facet.Reference(local), area};
}

Quadratures::Quadratures(int aorder) : order(aorder) {
  for (int n : Range(max(2 * order, highest_order) + 1))
    rules.Append(IntegrationRule(ET_TRIG, n));
}

const IntegrationRule & Quadratures::For(const Facet & slave, const Facet & master) const {
  if (slave.n == 3 && master.n == 3)
    return rules[order];
  double twist = max(Twist(slave), Twist(master));
  // The error of a rule of order n falls like (twist / 2)^n.
  int extra = twist > 1e-13 ? int(ceil(-12 / log10(min(0.5, 0.5 * twist)))) : 0;
  return rules[min(max(2 * order, highest_order), 2 * order + extra)];
}
} // namespace ngslac
