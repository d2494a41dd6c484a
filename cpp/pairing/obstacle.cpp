#include "pieces.hpp"

namespace ngslac {
template <int D>
Pairing<D> PairWithObstacle(const Surface<D> & slave, int order) {
  return InPieces<D>(slave.Size(), [&](IntRange faces, Pairing<D> & part) {
    auto put = [&](Array<PairPoint<D>> & points, int f, Vec<D - 1> xi, double weight) {
      Vec<D> x;
      Mat<D, D - 1> dx;
      slave.Evaluate(f, xi, x, dx);
      points.Append(
          PairPoint<D>{xi, Vec<D - 1>(0.0), weight * Measure(dx), 0.0, slave.Normal(f, dx)});
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

template Pairing<2> PairWithObstacle(const Surface<2> &, int);
template Pairing<3> PairWithObstacle(const Surface<3> &, int);
} // namespace ngslac
