#include "coefficients.hpp"

namespace ngslac {
namespace {
string PointText(FlatVector<> x) {
  string text = "(";
  for (size_t k : Range(x.Size()))
    text += (k ? ", " : "") + ToString(x(k));
  return text + ")";
}
} // namespace

Array<double> MacroMeans(const CoefficientFunction & function, const LACSpace & space,
                         const string & name) {
  auto ma = space.GetMeshAccess();
  Array<double> means(space.NMacros()), area(space.NMacros());
  means = 0.0, area = 0.0;
  LocalHeap heap(1000 * 1000, "ngslac-means", true);
  ParallelForRange(ma->GetNE(BND), [&](IntRange range) {
    LocalHeap lh = heap.Split();
    for (int i : range) {
      int macro = space.MacroOfFace()[i];
      if (macro < 0)
        continue;
      HeapReset hr(lh);
      ElementId ei(BND, i);
      auto & trafo = ma->GetTrafo(ei, lh);
      IntegrationRule rule(trafo.GetElementType(), 2);
      for (auto & ip : rule) {
        auto & mip = trafo(ip, lh);
        double value = function.Evaluate(mip);
        if (!isfinite(value) || value < 0)
          throw Exception("LACContact: " + name + " is " + ToString(value) + " at " +
                          PointText(mip.GetPoint()) + " on boundary '" +
                          string(ma->GetMaterial(ei)) + "'; it must be a number >= 0");
        AtomicAdd(means[macro], mip.GetWeight() * value);
        AtomicAdd(area[macro], mip.GetWeight());
      }
    }
  });
  for (size_t m : Range(means))
    means[m] /= area[m];
  return means;
}

template <int D>
void SetObstacleGaps(const CoefficientFunction & gap, const MeshAccess & ma,
                     const Surface<D> & slave, Pairing<D> & pairing) {
  LocalHeap heap(1000 * 1000, "ngslac-obstacle", true);
  ParallelForRange(pairing.Size(), [&](IntRange range) {
    LocalHeap lh = heap.Split();
    for (auto s : range) {
      HeapReset hr(lh);
      int face = pairing.segments[s].slave;
      auto & trafo = ma.GetTrafo(ElementId(BND, slave.Element(face)), lh);
      auto set = [&](PairPoint<D> & p) {
        HeapReset hr(lh);
        auto ip = ToIntegrationPoint(p.slave);
        p.gap = gap.Evaluate(trafo(ip, lh));
        if (!isfinite(p.gap))
          throw Exception("LACContact: the gap to the obstacle is " + ToString(p.gap) + " at " +
                          PointText(trafo(ip, lh).GetPoint()));
      };
      for (auto & p : pairing.points.Range(pairing.Points(s)))
        set(p);
      for (auto & p : pairing.corners.Range(pairing.Corners(s)))
        set(p);
    }
  });
}

template void SetObstacleGaps(const CoefficientFunction &, const MeshAccess &, const Surface<2> &,
                              Pairing<2> &);
template void SetObstacleGaps(const CoefficientFunction &, const MeshAccess &, const Surface<3> &,
                              Pairing<3> &);
} // namespace ngslac
