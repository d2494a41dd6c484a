// SPDX-License-Identifier: LGPL-2.1-or-later
#include "facets.hpp"
#include "twofold.hpp"
#include <map>

namespace ngslac {
namespace {
// Nearer than that, relative to the size of the tool, a point lies on its surface.
constexpr double touching = 1e-13;

/// The neighbours of facets across their sides: in 3D edges, in 2D end points.
template <int D>
class EdgeMap {
  using Side = std::array<int, D - 1>; // its points, in the order of the facet
  const FacetList<D> & list;
  std::map<Side, int> facets; // each side belongs to one facet

public:
  /// Throws where two facets have a side in the same direction.
  explicit EdgeMap(const FacetList<D> & alist) : list(alist) {
    for (int f : Range(list.corners))
      for (int i : Range(D))
        if (auto [at, isnew] = facets.insert({SideOf(f, i), f}); !isnew)
          throw Exception("tool: facets " + ToString(at->second) + " and " + ToString(f) +
                          " meet, but turn their normals to different sides, or more than two "
                          "facets meet there; repair the surface");
  }

  /// The facet beyond the side opposite to a corner; -1: none.
  int Beyond(int facet, int corner) const {
    Side side = SideOf(facet, corner);
    if constexpr (D == 3)
      Swap(side[0], side[1]);
    else
      side[0] = -1 - side[0];
    auto found = facets.find(side);
    return found == facets.end() ? -1 : found->second;
  }

private:
  /// In 2D an end point has a direction, too: edges begin, or end there.
  Side SideOf(int facet, int corner) const {
    auto & c = list.corners[facet];
    if constexpr (D == 3)
      return {c[(corner + 1) % 3], c[(corner + 2) % 3]};
    else
      return {corner == 1 ? c[0] : -1 - c[1]};
  }
};

/// Throws for facets that are degenerate or have unknown corners, and for a surface that is open
/// (unless that is allowed) or has no two sides.
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

template <int D>
netgen::Point<D> AsPoint(const Vec<D> & x) {
  netgen::Point<D> p;
  for (int k : Range(D))
    p(k) = x(k);
  return p;
}

template <int D>
BoxTree<D> TreeOf(const FacetList<D> & list) {
  Array<netgen::Box<D>> boxes;
  for (auto & corners : list.corners) {
    netgen::Box<D> box(netgen::Box<D>::EMPTY_BOX);
    for (int v : corners)
      box.Add(AsPoint<D>(list.points[v]));
    boxes.Append(box);
  }
  return BoxTree<D>(std::move(boxes));
}

Vec<2> AreaVectorOf(const Vec<2> & a, const Vec<2> & b, const Vec<2> &) {
  return {b(1) - a(1), a(0) - b(0)};
}
Vec<3> AreaVectorOf(const Vec<3> & a, const Vec<3> & b, const Vec<3> & c) {
  return 0.5 * Vec<3>(Cross(Vec<3>(b - a), Vec<3>(c - a)));
}
} // namespace

template <int D>
Facets<D>::Facets(FacetList<D> alist, bool closed) : list(std::move(alist)), tree(TreeOf(list)) {
  CheckFacets(list, closed);
  netgen::Box<D> box(netgen::Box<D>::EMPTY_BOX);
  for (auto & p : list.points)
    box.Add(AsPoint<D>(p));
  size = box.Diam();
  SetNormals();
  SetEdgeNormals();
  if (closed && VolumeInside() <= 0)
    throw Exception("tool: its surface is turned inside out: normals point into it; reverse the "
                    "order of the corners, or put a minus before the tool if it is a cavity");
}

template <int D>
void Facets<D>::SetNormals() {
  vertex_normals.SetSize(list.points.Size());
  vertex_normals = Vec<D>(0.0);
  for (int f : Range(list.corners)) {
    Vec<D> area = AreaVectorOf(Corner(f, 0), Corner(f, 1), Corner(f, D - 1));
    double length = L2Norm(area);
    if (!(length > pow(touching * size, D - 1)))
      throw Exception("tool: facet " + ToString(f) + " has no area; remove it, or repair the file");
    normals.Append(1 / length * area);
    for (int i : Range(D))
      vertex_normals[list.corners[f][i]] += AngleAt(f, i) * normals[f];
  }
}

template <>
double Facets<2>::AngleAt(int, int) const {
  return 1;
}

template <>
double Facets<3>::AngleAt(int facet, int corner) const {
  Vec<3> x = Corner(facet, corner), a = Corner(facet, (corner + 1) % 3) - x,
         b = Corner(facet, (corner + 2) % 3) - x;
  return atan2(L2Norm(Vec<3>(Cross(a, b))), InnerProduct(a, b));
}

template <>
void Facets<2>::SetEdgeNormals() {}

template <>
void Facets<3>::SetEdgeNormals() {
  EdgeMap<3> edges(list);
  for (int f : Range(list.corners))
    for (int i : Range(3)) {
      int other = edges.Beyond(f, i);
      edge_normals.Append(other < 0 ? normals[f] : Vec<3>(normals[f] + normals[other]));
    }
}

template <int D>
double Facets<D>::VolumeInside() const {
  double sum = 0;
  for (int f : Range(list.corners)) {
    Vec<D> a = Corner(f, 0);
    Vec<D> area = AreaVectorOf(a, Corner(f, 1), Corner(f, D - 1));
    sum += InnerProduct(a - list.points[0], area);
  }
  return sum;
}

template <>
Facets<2>::Foot Facets<2>::FootOn(int facet, const Vec<2> & x) const {
  Vec<2> a = Corner(facet, 0), edge = Corner(facet, 1) - a;
  double along = InnerProduct(x - a, edge) / L2Norm2(edge);
  Foot foot{a + along * edge, facet, On::facet, 0, 0};
  if (along <= 0 || along >= 1) {
    foot.number = along >= 1;
    foot.point = Corner(facet, foot.number);
    foot.on = On::vertex;
  }
  foot.square = L2Norm2(x - foot.point);
  return foot;
}

template <>
Facets<3>::Foot Facets<3>::FootOn(int facet, const Vec<3> & x) const {
  auto & n = normals[facet];
  Foot best{Vec<3>(x - InnerProduct(n, x - Corner(facet, 0)) * n), facet, On::facet, 0, 0};
  bool inside = true;
  for (int i : Range(3)) {
    Vec<3> edge = Corner(facet, (i + 2) % 3) - Corner(facet, (i + 1) % 3);
    inside = inside && InnerProduct(Vec<3>(Cross(n, edge)), x - Corner(facet, (i + 1) % 3)) > 0;
  }
  best.square = L2Norm2(x - best.point);
  if (inside)
    return best;
  best.square = std::numeric_limits<double>::max();
  for (int i : Range(3)) { // the edge opposite to corner i
    Vec<3> a = Corner(facet, (i + 1) % 3), edge = Corner(facet, (i + 2) % 3) - a;
    double along = InnerProduct(x - a, edge) / L2Norm2(edge);
    Foot foot{a + along * edge, facet, On::edge, i, 0};
    if (along <= 0 || along >= 1) {
      foot.number = (i + (along <= 0 ? 1 : 2)) % 3;
      foot.point = Corner(facet, foot.number);
      foot.on = On::vertex;
    }
    foot.square = L2Norm2(x - foot.point);
    if (foot.square < best.square)
      best = foot;
  }
  return best;
}

template <int D>
typename Facets<D>::Foot Facets<D>::Nearest(const Vec<D> & x) const {
  Foot best;
  best.square = std::numeric_limits<double>::max();
  tree.VisitNear(AsPoint<D>(x), best.square, [&](int facet) {
    if (auto foot = FootOn(facet, x); foot.square < best.square)
      best = foot;
  });
  return best;
}

template <int D>
const Vec<D> & Facets<D>::NormalAt(const Foot & foot) const {
  switch (foot.on) {
  case On::vertex:
    return vertex_normals[list.corners[foot.facet][foot.number]];
  case On::edge:
    return edge_normals[D * foot.facet + foot.number];
  default:
    return normals[foot.facet];
  }
}

template <int D>
Nearness<D> Facets<D>::At(const Vec<D> & x) const {
  auto foot = Nearest(x);
  auto & normal = NormalAt(foot);
  Vec<D> away = x - foot.point;
  double sign = InnerProduct(away, normal) >= 0 ? 1 : -1, distance = sqrt(foot.square);
  if (foot.on == On::facet)
    return {Apart<D>(x, Corner(foot.facet, 0)).Along(normal).Value(), normal};
  if (distance <= touching * size) {
    double length = L2Norm(normal);
    return {sign * distance, length > 0 ? Vec<D>(1 / length * normal) : Vec<D>(0.0)};
  }
  return {sign * distance, sign / distance * away};
}

template <int D>
Mat<D, D> Facets<D>::Hessian(const Vec<D> & x) const {
  auto foot = Nearest(x);
  auto [distance, gradient] = At(x);
  if (foot.on == On::facet || fabs(distance) <= touching * size)
    return Mat<D, D>(0.0);
  Mat<D, D> across = Id<D>() - gradient * Trans(gradient);
  if (foot.on == On::edge) {
    Vec<D> edge =
        Corner(foot.facet, (foot.number + 2) % D) - Corner(foot.facet, (foot.number + 1) % D);
    across -= 1 / L2Norm2(edge) * edge * Trans(edge);
  }
  return 1 / distance * across;
}

template class Facets<2>;
template class Facets<3>;
} // namespace ngslac
