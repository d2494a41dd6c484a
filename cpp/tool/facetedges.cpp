// SPDX-License-Identifier: LGPL-2.1-or-later
#include "facetedges.hpp"

namespace ngslac {
template <>
EdgeMap<3>::Side EdgeMap<3>::SideOf(int facet, int corner) const {
  auto & c = list.corners[facet];
  return {c[(corner + 1) % 3], c[(corner + 2) % 3]};
}

/// An end point has a direction, too: edges begin, or end there.
template <>
EdgeMap<2>::Side EdgeMap<2>::SideOf(int facet, int corner) const {
  int point = list.corners[facet][1 - corner];
  return {corner == 1 ? point : -1 - point};
}

template <int D>
EdgeMap<D>::EdgeMap(const FacetList<D> & alist) : list(alist) {
  for (int f : Range(list.corners))
    for (int i : Range(D))
      if (auto [at, isnew] = facets.insert({SideOf(f, i), f}); !isnew)
        throw Exception("tool: facets " + ToString(at->second) + " and " + ToString(f) +
                        " meet, but turn their normals to different sides, or more than two "
                        "facets meet there; repair the surface");
}

template <>
int EdgeMap<3>::Beyond(int facet, int corner) const {
  auto [a, b] = SideOf(facet, corner);
  auto found = facets.find({b, a});
  return found == facets.end() ? -1 : found->second;
}

template <>
int EdgeMap<2>::Beyond(int facet, int corner) const {
  auto found = facets.find({-1 - SideOf(facet, corner)[0]});
  return found == facets.end() ? -1 : found->second;
}

template <int D>
void CheckFacets(const FacetList<D> & list, bool closed) {
  if (list.corners.Size() == 0)
    throw Exception("tool: it has no facets");
  int n = list.points.Size();
  for (auto & p : list.points)
    if (!isfinite(L2Norm2(p)))
      throw Exception("tool: a point has NaN or infinite coordinates");
  for (int f : Range(list.corners))
    for (int v : list.corners[f])
      if (v < 0 || v >= n)
        throw Exception("tool: facet " + ToString(f) + " has corner " + ToString(v) + " of " +
                        ToString(n) + " points");
  EdgeMap<D> edges(list);
  for (int f : Range(list.corners))
    for (int i : Range(closed ? D : 0))
      if (edges.Beyond(f, i) < 0)
        throw Exception("tool: its surface is open beside facet " + ToString(f) +
                        "; close it, or give closed=False if what touches it stays away from its "
                        "rim");
}

template class EdgeMap<2>;
template class EdgeMap<3>;
template void CheckFacets(const FacetList<2> &, bool);
template void CheckFacets(const FacetList<3> &, bool);
} // namespace ngslac
