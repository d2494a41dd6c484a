#include "pairing.hpp"

namespace ngslac {
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

template SegmentTable MakeSegmentTable(const Pairing<2> &, const Surface<2> &, const Surface<2> *);
template SegmentTable MakeSegmentTable(const Pairing<3> &, const Surface<3> &, const Surface<3> *);
} // namespace ngslac
