// SPDX-License-Identifier: LGPL-2.1-or-later
#include "contact/macrotables.hpp"
#include "macromotion.hpp"

namespace ngslac {
template <int D>
shared_ptr<MacroPoints<D>> MakePoints(shared_ptr<const Pairing<D>> pairing,
                                      const Surface<D> & slave, const LACSpace & space,
                                      FlatArray<double> area) {
  auto & segments = pairing->segments;
  auto of_segments = SegmentsOfMacros<D>(space, slave, *pairing);
  auto of_rim = OfMacros<D>(
      pairing->rim.Size(), [&](int i) { return segments[pairing->rim[i].segment].slave; }, slave,
      space);
  Array<Mat<D, D - 1>> dual(space.NMacros());
  for (size_t m : Range(dual))
    if (area[m] > 0) {
      auto & segment = segments[of_segments[m][0]];
      Vec<D> x;
      Mat<D, D - 1> dx;
      slave.Evaluate(segment.slave, pairing->points[segment.first].slave, x, dx);
      dual[m] = DualBasis<D>(dx);
    }
  return make_shared<MacroPoints<D>>(MacroPoints<D>{
      pairing, std::move(of_segments), std::move(of_rim), Array<double>(area), std::move(dual)});
}

template shared_ptr<MacroPoints<2>> MakePoints(shared_ptr<const Pairing<2>>, const Surface<2> &,
                                               const LACSpace &, FlatArray<double>);
template shared_ptr<MacroPoints<3>> MakePoints(shared_ptr<const Pairing<3>>, const Surface<3> &,
                                               const LACSpace &, FlatArray<double>);
} // namespace ngslac
