// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include "macrotables.hpp"
#include "pairfinder.hpp"

namespace ngslac {
/// Between which limits the gap varies over the points of a macro-element that have a partner.
template <int D>
struct GapRange {
  double least = std::numeric_limits<double>::infinity(), greatest = -least;
  Vec<D> near = Vec<D>(0.0), far = Vec<D>(0.0); // on the slave, where it is these

  /// NaN is none.
  void Add(double gap, const Vec<D> & x) {
    if (gap < least)
      least = gap, near = x;
    if (gap > greatest)
      greatest = gap, far = x;
  }
};

/// At the corners and at the quadrature points of all segments: `gap` of a macro-element, a segment
/// and a point; NaN leaves a point out.
template <int D, typename F>
Array<GapRange<D>> GapRangesOf(const LACSpace & space, const Paired<D> & surfaces, F gap) {
  auto & slave = *surfaces.slave;
  auto & pairing = *surfaces.pairing;
  auto of_macro = SegmentsOfMacros<D>(space, slave, pairing);
  Array<GapRange<D>> ranges(of_macro.Size());
  ParallelFor(ranges.Size(), [&](size_t m) {
    GapRange<D> range;
    for (int s : of_macro[m]) {
      auto & segment = pairing.segments[s];
      auto add = [&](const PairPoint<D> & p) {
        range.Add(gap(m, segment, p), slave.Origin() + slave.Point(segment.slave, p.slave));
      };
      for (auto & p : pairing.corners.Range(pairing.Corners(s)))
        add(p);
      for (auto & p : pairing.points.Range(pairing.Points(s)))
        add(p);
    }
    ranges[m] = range;
  });
  return ranges;
}
} // namespace ngslac
