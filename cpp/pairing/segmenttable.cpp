#include "pairing.hpp"

namespace ngslac {
template <int D>
Array<double> SegmentTable(const Pairing<D> & pairing, const Surface<D> & slave,
                           const Surface<D> * master) {
  Array<double> table;
  for (size_t s : Range(pairing.Size())) {
    auto & segment = pairing.segments[s];
    double area = 0, gap = 0;
    for (auto & p : pairing.points.Range(pairing.Points(s)))
      area += p.weight, gap += p.weight * p.gap;
    table.Append(slave.Element(segment.slave));
    table.Append(segment.master < 0 ? -1 : master->Element(segment.master));
    table.Append(area);
    table.Append(gap / area);
    for (auto & p : pairing.corners.Range(pairing.Corners(s))) {
      Vec<D> x = slave.Point(segment.slave, p.slave), y = x + p.gap * p.normal;
      for (auto * v : {&x, &y})
        for (int k : Range(D))
          table.Append((*v)(k));
    }
  }
  return table;
}

template Array<double> SegmentTable(const Pairing<2> &, const Surface<2> &, const Surface<2> *);
} // namespace ngslac
