// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include "facets.hpp"
#include <map>

namespace ngslac {
/// Throws where facets are none, have corners that there are not, or leave the surface open
/// (unless that is allowed) or without two sides.
template <int D>
void CheckFacets(const FacetList<D> & list, bool closed);

/// What lies beyond the sides of facets: in 3D their edges, in 2D their end points.
template <int D>
class EdgeMap {
  using Side = std::array<int, D - 1>; // its points, in the order of the facet
  const FacetList<D> & list;
  std::map<Side, int> facets; // each side belongs to one facet

public:
  /// Throws where two facets have a side in the same direction.
  explicit EdgeMap(const FacetList<D> & alist);
  /// The facet beyond the side opposite to a corner; -1: none.
  int Beyond(int facet, int corner) const;

private:
  Side SideOf(int facet, int corner) const;
};

template <int D>
netgen::Point<D> AsPoint(const Vec<D> & x) {
  netgen::Point<D> p;
  for (int k : Range(D))
    p(k) = x(k);
  return p;
}
} // namespace ngslac
