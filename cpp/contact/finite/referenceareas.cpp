// SPDX-License-Identifier: LGPL-2.1-or-later
#include "referenceareas.hpp"

namespace ngslac {
namespace {
template <int D>
double MeasureAt(const Surface<D> & surface, int face, const PairPoint<D> & p) {
  Vec<D> x;
  Mat<D, D - 1> dx;
  surface.Evaluate(face, p.slave, x, dx);
  return Measure(dx);
}
} // namespace

template <int D>
void CountReferenceAreas(const Surface<D> & reference, const Surface<D> & current,
                         Pairing<D> & pairing) {
  ParallelFor(pairing.Size(), [&](size_t s) {
    int face = pairing.segments[s].slave;
    for (auto & p : pairing.points.Range(pairing.Points(s)))
      p.weight *= MeasureAt(reference, face, p) / MeasureAt(current, face, p);
  });
  for (auto & r : pairing.rim)
    r.point.weight = MeasureAt(reference, pairing.segments[r.segment].slave, r.point);
}

template void CountReferenceAreas(const Surface<2> &, const Surface<2> &, Pairing<2> &);
template void CountReferenceAreas(const Surface<3> &, const Surface<3> &, Pairing<3> &);
} // namespace ngslac
