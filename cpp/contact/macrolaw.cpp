// SPDX-License-Identifier: LGPL-2.1-or-later
#include "macrolaw.hpp"

namespace ngslac {
template <int D>
MacroLaw<D>::MacroLaw(const ContactSetup & setup, shared_ptr<LACSpace> aspace,
                      const ProxyInfo & alam)
    : space(aspace), lam(alam), tied(setup.tied), bilateral(setup.bilateral), adjust(setup.adjust),
      watch_friction(setup.friction), watch_threshold(setup.threshold), watch_offset(setup.offset),
      own(setup.law != nullptr) {}

template <int D>
void MacroLaw<D>::FindDofs(const Surface<D> & slave) {
  dofs.SetSize(D * space->NMacros());
  LocalHeap lh(1000 * 1000, "ngslac-multipliers");
  int block = lam.fes->GetDimension();
  Array<DofId> own;
  for (size_t f : Range(slave.Size())) {
    HeapReset hr(lh);
    ElementId ei(BND, slave.Element(f));
    lam.fes->GetDofNrs(ei, own);
    IntRange used = lam.evaluator->UsedDofs(lam.fes->GetFE(ei, lh));
    for (int k : Range(D))
      dofs[D * space->MacroOfFace()[ei.Nr()] + k] =
          block * own[(used.First() + k) / block] + (used.First() + k) % block;
  }
}

template <int D>
void MacroLaw<D>::Reset() {
  Reevaluate();
  c.SetSize(space->NMacros()), direction.SetSize(space->NMacros());
  c = 0.0;
  adjusted.SetSize(space->NMacros()), end_c.SetSize(space->NMacros());
  adjusted = 0.0, end_c = 0.0;
  BeginSolve();
}

template <int D>
void MacroLaw<D>::Reevaluate() {
  auto means = [&](Watch & watch, const char * name, Array<double> & values, double least,
                   double none) {
    watch.WhereChanged([&] {
      if (watch)
        values = MacroMeans(*watch, *space, name, least);
      else {
        values.SetSize(space->NMacros());
        values = none;
      }
    });
  };
  means(watch_friction, "friction", friction, 0, -1);
  means(watch_threshold, "tresca", threshold, 0, -1);
  means(watch_offset, "offset", offset, -std::numeric_limits<double>::infinity(), 0);
}

template <int D>
SearchMargin MacroLaw<D>::Margin() const {
  SearchMargin margin{adjust, adjust};
  for (double value : offset)
    margin = {max(margin.farther, adjust - value), max(margin.deeper, adjust + value)};
  return margin;
}

template <int D>
Vec<D> MacroLaw<D>::Multiplier(size_t m, FlatVector<> x) const {
  Vec<D> traction;
  for (int k : Range(D))
    traction(k) = x(dofs[D * m + k]);
  return traction;
}

template <int D>
LawData<D> MacroLaw<D>::Data(size_t m, const MacroPlace<D> & place) const {
  bool paired = place.area > 0;
  return {place.normal, c[m], friction[m], threshold[m], tied && paired, bilateral && paired};
}

template <int D>
Vec<D> MacroLaw<D>::Trial(size_t m, const MacroPlace<D> & place, FlatVector<> x) const {
  if (place.area == 0)
    return place.normal;
  Vec<D> traction = Multiplier(m, x);
  Vec<D> trial = traction - ComplianceOf(m).At(place.normal) * traction - c[m] * place.jump;
  if (!place.ends)
    return trial;
  double mean = Spread(m, *place.ends).mean;
  if (mean <= 0)
    return place.normal; // open, whatever rounding does
  return trial - (InnerProduct(trial, place.normal) + mean) * place.normal;
}

template <int D>
double MacroLaw<D>::GivenPressure(size_t m, const Vec<D> & normal, FlatVector<> x) const {
  Vec<D> traction = Multiplier(m, x);
  return -InnerProduct(normal, traction - ComplianceOf(m).At(normal) * traction);
}

template <int D>
ngbla::Mat<D, D> MacroLaw<D>::RowFactor(size_t m, const MacroPlace<D> & place) const {
  ngbla::Mat<D, D> factor = (place.rowarea / c[m]) * Id<D>();
  if (place.ends)
    factor += (place.rowarea / c[m]) * (c[m] / end_c[m] - 1) * place.normal * Trans(place.normal);
  return factor;
}

template <int D>
Answer<D> MacroLaw<D>::AtStep(size_t m, const MacroPlace<D> & place, FlatVector<> x) {
  Vec<D> now = 0.0, trial = Trial(m, place, x);
  auto data = Data(m, place);
  auto p = Project(data, trial);
  if (p.status == Status::slip && max(data.friction, data.threshold) > 0)
    now = trial - InnerProduct(trial, place.normal) * place.normal;
  if (InnerProduct(now, direction[m]) < 0) {
    p = Sticking(trial);
    now = 0.0;
  }
  direction[m] = now;
  return AnswerOf(m, place, p, x);
}

template <int D>
Answer<D> MacroLaw<D>::AnswerOf(size_t m, const MacroPlace<D> & place, const Projection<D> & p,
                                FlatVector<> x) const {
  auto & n = place.normal;
  auto compliance = ComplianceOf(m);
  ngbla::Mat<D, D> multiplier = Id<D>() - compliance.At(n), jump = c[m] * Id<D>();
  if (place.ends) { // the mean pressure of its points in place of the trial pressure
    double growth = Spread(m, *place.ends).by_multiplier - 1;
    multiplier += growth * n * Trans(Vec<D>(Trans(multiplier) * n));
    jump += (end_c[m] - c[m]) * n * Trans(n);
  }
  Answer<D> answer;
  answer.traction = p.traction;
  answer.by_multiplier = p.derivative * multiplier;
  answer.by_jump = -1 * (p.derivative * jump);
  answer.by_normal = p.by_normal - p.derivative * compliance.ByNormal(n, Multiplier(m, x));
  answer.status = p.status;
  return answer;
}

template <int D>
Vec<D> MacroLaw<D>::ElasticSlip(size_t m, const Vec<D> & normal, FlatVector<> x) const {
  if (own || ComplianceOf(m).IsRigid() || !(c[m] > 0))
    return Vec<D>(0.0);
  Vec<D> slip = (1 / c[m]) * (ComplianceOf(m).At(normal) * Multiplier(m, x));
  return slip - InnerProduct(slip, normal) * normal;
}

template class MacroLaw<2>;
template class MacroLaw<3>;
} // namespace ngslac
