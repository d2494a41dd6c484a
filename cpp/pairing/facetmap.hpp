// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include "facets.hpp"
#include "polygon.hpp"

namespace ngslac {
/// Two unit vectors that make up a right-handed frame with a unit normal.
void Tangents(Vec<3> normal, Vec<3> (&tangents)[2]);

/// The auxiliary plane of a slave facet: where overlaps are cut, and the way back to the face.
class FacetMap {
  const Facet & facet;
  Vec<3> origin, tangents[2];
  Polygon outline;
  bool reversed; // against the reference orientation
  Mat<2, 2> inverse;
  Vec<2> twist; // what a quadrilateral has more than a parallelogram

public:
  explicit FacetMap(const Facet & facet);

  const Facet & GetFacet() const { return facet; }
  Vec<3> Origin() const { return origin; }
  Vec<3> Normal() const { return facet.normal; }
  Vec<3> Tangent(int i) const { return tangents[i]; }
  /// the facet in the plane
  const Polygon & Outline() const { return outline; }

  Vec<2> Project(Vec<3> x) const {
    return {InnerProduct(tangents[0], x - origin), InnerProduct(tangents[1], x - origin)};
  }
  /// Reference coordinates of the face, and their area per area of the plane.
  pair<Vec<2>, double> Reference(Vec<2> p) const;
};

/// Quadrature rules on triangles for the polynomials that a pair of facets leads to.
class Quadratures {
  int order;
  Array<IntegrationRule> rules;

public:
  explicit Quadratures(int order);
  /// Shape functions of a quadrilateral are of twice the degree, and rational in the plane unless
  /// it is a parallelogram.
  const IntegrationRule & For(const Facet & slave, const Facet & master) const;
};
} // namespace ngslac
