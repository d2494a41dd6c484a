// SPDX-License-Identifier: LGPL-2.1-or-later
#include "pieces.hpp"

namespace ngslac {
namespace {
template <int D>
void AddBounds(const Surface<D> & surface, netgen::Box<D> & box) {
  for (size_t f : Range(surface.Size())) {
    auto bounds = surface.Bounds(f);
    box.Add(bounds.PMin());
    box.Add(bounds.PMax());
  }
}
} // namespace

template <int D>
PairingOptions SearchOptions(const Surface<D> & slave, const Surface<D> & master, double maxdist,
                             double penetration, int order) {
  netgen::Box<D> box(netgen::Box<D>::EMPTY_BOX);
  AddBounds(slave, box);
  double own = box.Diam();
  AddBounds(master, box);
  maxdist = maxdist > 0 ? maxdist : box.Diam();
  return {maxdist, penetration > 0 ? penetration : min(maxdist, 0.1 * own), order, nullptr};
}

template <int D>
Pairing<D> PairWithObstacle(const Surface<D> & slave, int order) {
  return InPieces<D>(slave.Size(), [&](IntRange faces, Pairing<D> & part) {
    auto put = [&](Array<PairPoint<D>> & points, int f, Vec<D - 1> xi, double weight) {
      Vec<D> x;
      Mat<D, D - 1> dx;
      slave.Evaluate(f, xi, x, dx);
      points.Append(PairPoint<D>{xi, Vec<D - 1>(0.0), weight * slave.AreaElement(x, dx), 0.0,
                                 slave.Normal(f, dx)});
    };
    for (int f : faces) {
      part.segments.Append(Segment{f, -1, part.points.Size(), part.corners.Size()});
      IntegrationRule rule(slave.Type(f), order);
      for (auto & ip : rule)
        put(part.points, f, ReferencePoint<D - 1>(ip), ip.Weight());
      for (auto & xi : Corners<D - 1>(slave.Type(f)))
        put(part.corners, f, xi, 0);
    }
  });
}

template <int D>
SegmentTable MakeSegmentTable(const Pairing<D> & pairing, const Surface<D> & slave,
                              const Surface<D> * master) {
  SegmentTable table;
  for (size_t s : Range(pairing.Size())) {
    auto & segment = pairing.segments[s];
    double area = 0, gap = 0;
    for (auto & p : pairing.points.Range(pairing.Points(s)))
      area += p.weight, gap += p.weight * p.gap;
    table.values.Append(slave.Element(segment.slave));
    table.values.Append(segment.master < 0 ? -1 : master->Element(segment.master));
    table.values.Append(area);
    table.values.Append(gap / area);
    table.first.Append(segment.first_corner);
    for (auto & p : pairing.corners.Range(pairing.Corners(s))) {
      Vec<D> x = slave.Origin() + slave.Point(segment.slave, p.slave), y = x + p.gap * p.normal;
      for (auto * v : {&x, &y})
        for (int k : Range(D))
          table.corners.Append((*v)(k));
    }
  }
  table.first.Append(pairing.segments.Last().first_corner);
  return table;
}

template <int D>
Array<double> MakePointTable(const Pairing<D> & pairing, const Surface<D> & slave,
                             const Surface<D> * master) {
  constexpr int width = 8 + 2 * D;
  Array<double> table(width * pairing.points.Size());
  table = 0.0; // in 2D the second coordinates stay 0
  ParallelFor(pairing.Size(), [&](size_t s) {
    auto & segment = pairing.segments[s];
    for (size_t i : pairing.Points(s)) {
      auto & p = pairing.points[i];
      auto row = table.Range(width * i, width * (i + 1));
      Vec<D> x = slave.Origin() + slave.Point(segment.slave, p.slave);
      row[0] = slave.Element(segment.slave);
      row[1] = segment.master < 0 ? -1 : master->Element(segment.master);
      for (int k : Range(D - 1))
        row[2 + k] = p.slave(k), row[4 + k] = p.master(k);
      row[6] = p.weight, row[7] = p.gap;
      for (int k : Range(D))
        row[8 + k] = p.normal(k), row[8 + D + k] = x(k);
    }
  });
  return table;
}

#define INSTANTIATE(D)                                                                             \
  template PairingOptions SearchOptions(const Surface<D> &, const Surface<D> &, double, double,    \
                                        int);                                                      \
  template Pairing<D> PairWithObstacle(const Surface<D> &, int);                                   \
  template SegmentTable MakeSegmentTable(const Pairing<D> &, const Surface<D> &,                   \
                                         const Surface<D> *);                                      \
  template Array<double> MakePointTable(const Pairing<D> &, const Surface<D> &, const Surface<D> *);
INSTANTIATE(2)
INSTANTIATE(3)
} // namespace ngslac
