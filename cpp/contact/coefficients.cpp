// SPDX-License-Identifier: LGPL-2.1-or-later
#include "coefficients.hpp"
#include "tool/leaves.hpp"

namespace ngslac {
namespace {
string PointText(FlatVector<> x) {
  string text = "(";
  for (size_t k : Range(x.Size()))
    text += (k ? ", " : "") + ToString(x(k));
  return text + ")";
}

bool IsCoordinate(const CoefficientFunction & function) {
  return function.GetDescription().rfind("coordinate ", 0) == 0;
}
} // namespace

Watch::Watch(shared_ptr<CoefficientFunction> afunction) : function(afunction) {
  if (!function)
    return;
  function->TraverseTree([&](CoefficientFunction & node) {
    if (node.InputCoefficientFunctions().Size())
      return;
    if (dynamic_cast<ParameterCoefficientFunction<double> *>(&node))
      parameters.Append(node.shared_from_this());
    else if (!IsNumber(node) && !IsCoordinate(node))
      fixed = false;
  });
}

Array<double> Watch::Values() const {
  Array<double> now;
  for (auto & parameter : parameters)
    now.Append(static_cast<ParameterCoefficientFunction<double> &>(*parameter).GetValue());
  return now;
}

namespace {
/// Integrals over the slave faces of a function and of 1.
struct FaceIntegral {
  double value = 0, area = 0;
};

FaceIntegral Integrate(const CoefficientFunction & function, const MeshAccess & ma, ElementId ei,
                       const string & name, double least, bool turns, LocalHeap & lh) {
  FaceIntegral sum;
  auto & trafo = ma.GetTrafo(ei, lh);
  IntegrationRule rule(trafo.GetElementType(), 2);
  for (auto & ip : rule) {
    auto & mip = trafo(ip, lh);
    Vec<1> values;
    function.Evaluate(mip, FlatVector<>(values)); // some derivatives have no other evaluation
    double value = values(0);
    if (!isfinite(value) || value < least)
      throw Exception("LACContact: " + name + " is " + ToString(value) + " at " +
                      PointText(mip.GetPoint()) + " on boundary '" + string(ma.GetMaterial(ei)) +
                      "'; it must be a " +
                      (isfinite(least) ? "number >= " + ToString(least) : "finite number"));
    double weight = mip.GetWeight() * (turns ? mip.GetPoint()(0) : 1); // of a body of revolution
    sum.value += weight * value;
    sum.area += weight;
  }
  return sum;
}
} // namespace

Array<double> MacroMeans(const CoefficientFunction & function, const LACSpace & space,
                         const string & name, double least) {
  auto ma = space.GetMeshAccess();
  auto macros = space.MacroOfFace();
  Array<FaceIntegral> integrals(macros.Size());
  LocalHeap heap(1000 * 1000, "ngslac-means", true);
  ParallelForRange(macros.Size(), [&](IntRange range) {
    LocalHeap lh = heap.Split();
    for (int i : range)
      if (macros[i] >= 0) {
        HeapReset hr(lh);
        integrals[i] =
            Integrate(function, *ma, ElementId(BND, i), name, least, space.IsAxisymmetric(), lh);
      }
  });
  Array<double> means(space.NMacros()), area(space.NMacros());
  means = 0.0, area = 0.0;
  for (size_t i : Range(macros)) // in their order, whatever the threads did
    if (macros[i] >= 0) {
      means[macros[i]] += integrals[i].value;
      area[macros[i]] += integrals[i].area;
    }
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
