// SPDX-License-Identifier: LGPL-2.1-or-later
#include "overlap.hpp"
#include "pieces.hpp"

namespace ngslac {
namespace {
// The way out against the slave normal may be longer than the shortest one by this factor: the side
// of a body that is pressed in a little leads along the master, not out of it.
constexpr double detour = 2;

/// Keeps reference coordinates inside of a face.
Vec<1> Inside(Vec<1> xi, ELEMENT_TYPE) {
  return Vec<1>(min(1.0, max(0.0, xi(0))));
}
Vec<2> Inside(Vec<2> xi, ELEMENT_TYPE type) {
  for (int k : Range(2))
    xi(k) = min(1.0, max(0.0, xi(k)));
  double beyond = xi(0) + xi(1) - 1;
  if (type != ET_TRIG || beyond <= 0)
    return xi;
  xi -= Vec<2>(0.5 * beyond, 0.5 * beyond);
  for (int k : Range(2)) {
    xi(k) = min(1.0, max(0.0, xi(k)));
    xi(1 - k) = min(xi(1 - k), 1 - xi(k));
  }
  return xi;
}

/// Distance of a point and a face, from the nearest of its control sites by Gauss's method.
template <int D>
double Distance(const Surface<D> & surface, int face, const Vec<D> & p) {
  Vec<D - 1> xi = 0.0;
  double nearest = numeric_limits<double>::infinity();
  for (auto & site : surface.Sites(face))
    if (double d = L2Norm(surface.Point(face, site) - p); d < nearest)
      xi = site, nearest = d;
  for (int it = 0; it < 20; it++) {
    Vec<D> x;
    Mat<D, D - 1> dx;
    surface.Evaluate(face, xi, x, dx);
    Mat<D - 1, D - 1> metric = Trans(dx) * dx;
    Vec<D - 1> step = Inv(metric) * Vec<D - 1>(Trans(dx) * (p - x));
    Vec<D - 1> next = Inside(Vec<D - 1>(xi + step), surface.Type(face));
    double d = L2Norm(surface.Point(face, next) - p);
    if (!(d < (1 - 1e-6) * nearest))
      break;
    xi = next, nearest = d;
  }
  return nearest;
}

/// Distance of a point and the faces that count.
template <int D, typename F>
double Distance(const Surface<D> & surface, const BoxTree<D> & tree, const Vec<D> & p, F counts) {
  double nearest = numeric_limits<double>::max();
  netgen::Point<D> point;
  for (int k : Range(D))
    point(k) = p(k);
  tree.VisitNear(point, nearest, [&](int face) {
    if (counts(face))
      nearest = min(nearest, sqr(Distance<D>(surface, face, p)));
  });
  return sqrt(nearest);
}

/// Against the normals of the faces, whatever is nearest there.
template <int D>
PairingOptions Backwards(const Surface<D> & slave, const Surface<D> & master) {
  auto options = SearchOptions(slave, master, 0, 0, 1);
  options.penetration = options.maxdist;
  options.maxdist = 0;
  return options;
}

/// Is the master face met from its inner side?
template <int D>
bool LeadsOut(const Surface<D> & master, int face, const PairPoint<D> & p) {
  Vec<D> x;
  Mat<D, D - 1> dx;
  master.Evaluate(face, p.master, x, dx);
  return InnerProduct(p.normal, master.Normal(face, dx)) < 0;
}
} // namespace

template <int D>
Array<DeepPart> DeepParts(const Surface<D> & slave, const Surface<D> & master,
                          std::function<bool(int, int)> maypair, FlatArray<double> limits) {
  auto options = Backwards(slave, master);
  options.backs = true; // where one is nearer the slave lies behind another body
  options.maypair = maypair;
  auto pairing = Pair<D>(slave, master, options);
  auto tree = FaceTree(master);
  Array<DeepPart> parts;
  for (size_t s : Range(pairing.Size())) {
    auto & segment = pairing.segments[s];
    double limit = limits[segment.slave];
    DeepPart part{segment.slave, segment.master, limit};
    auto counts = [&](int face) { return maypair(segment.slave, face); };
    for (auto & p : pairing.corners.Range(pairing.Corners(s)))
      if (-p.gap > part.depth && LeadsOut(master, segment.master, p) &&
          -p.gap <= detour * Distance<D>(master, tree, slave.Point(segment.slave, p.slave), counts))
        part.depth = -p.gap;
    if (part.depth > limit)
      parts.Append(part);
  }
  return parts;
}

template <int D>
Array<double> ThicknessesBehind(const Surface<D> & surface, const Surface<D> & others,
                                std::function<bool(int face, int other)> maycount) {
  auto options = Backwards(surface, others);
  options.maypair = std::move(maycount);
  auto pairing = Pair<D>(surface, others, options);
  Array<double> thickness(surface.Size());
  thickness = 0.0;
  for (size_t s : Range(pairing.Size()))
    for (auto & p : pairing.points.Range(pairing.Points(s)))
      thickness[pairing.segments[s].slave] = max(thickness[pairing.segments[s].slave], -p.gap);
  for (double & t : thickness)
    if (t == 0)
      t = numeric_limits<double>::infinity();
  return thickness;
}

#define INSTANTIATE(D)                                                                             \
  template Array<DeepPart> DeepParts(const Surface<D> &, const Surface<D> &,                       \
                                     std::function<bool(int, int)>, FlatArray<double>);            \
  template Array<double> ThicknessesBehind(const Surface<D> &, const Surface<D> &,                 \
                                           std::function<bool(int, int)>);
INSTANTIATE(2)
INSTANTIATE(3)
} // namespace ngslac
