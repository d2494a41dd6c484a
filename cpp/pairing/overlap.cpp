#include "pairing.hpp"

namespace ngslac {
template <int D>
Array<double> OverlapDepths(const Surface<D> & slave, const Surface<D> & master) {
  auto options = SearchOptions(slave, master, 0, 0, 1);
  options.penetration = options.maxdist;
  options.maxdist = 0;
  options.backs = true; // where one is nearer the slave lies behind another body
  auto pairing = Pair<D>(slave, master, options);
  Array<double> depths(slave.Size());
  depths = 0.0;
  for (size_t s : Range(pairing.Size())) {
    auto & segment = pairing.segments[s];
    for (auto & p : pairing.corners.Range(pairing.Corners(s))) {
      Vec<D> x;
      Mat<D, D - 1> dx;
      master.Evaluate(segment.master, p.master, x, dx);
      if (InnerProduct(p.normal, master.Normal(segment.master, dx)) < 0)
        depths[segment.slave] = max(depths[segment.slave], -p.gap);
    }
  }
  return depths;
}

template Array<double> OverlapDepths(const Surface<2> &, const Surface<2> &);
template Array<double> OverlapDepths(const Surface<3> &, const Surface<3> &);
} // namespace ngslac
