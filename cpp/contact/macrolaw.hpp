// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include "coefficients.hpp"
#include "law.hpp"
#include "pairfinder.hpp"
#include "place.hpp"

namespace ngslac {
/// How a multiplier gives in directions in which the slave's displacements are prescribed.
///
/// There the slave cannot follow, and a constraint would rest on the master alone: singular where
/// that is prescribed, too, unstable where it is coarser. So it sticks elastically in them,
///   c j = - share M lambda,
/// a hundredth of what the surface gives anyhow, while it slips at the same bound. The constraint
/// along the normal stays rigid as long as any free displacement has a part in it.
template <int D>
class Compliance {
  static constexpr double share = 0.01;
  Mat<D, D> fixed; // projection on the directions in which the slave cannot move
  bool rigid;      // without those directions
  bool whole;      // whatever the normal is

public:
  /// `reach`: projection on the directions in which it can; `whole`: all constraints are alike, as
  /// those of tied surfaces
  Compliance(const Mat<3, 3> & reach, bool awhole) {
    double moves = 0;
    for (int k : Range(D)) {
      moves += reach(k, k);
      for (int l : Range(D))
        fixed(k, l) = (k == l) - reach(k, l);
    }
    rigid = moves > D - 0.5;
    whole = awhole || moves < 0.5;
  }

  bool IsRigid() const { return rigid; }

  /// share M
  Mat<D, D> At(const Vec<D> & normal) const {
    if (rigid)
      return Mat<D, D>(0.0);
    if (whole)
      return share * fixed;
    Mat<D, D> across = Across(normal);
    return share * Mat<D, D>(across * Mat<D, D>(fixed * across));
  }

  /// Derivative of  share M lambda  by the normal.
  Mat<D, D> ByNormal(const Vec<D> & normal, const Vec<D> & lambda) const {
    Mat<D, D> result = 0.0;
    if (rigid || whole)
      return result;
    Mat<D, D> across = Across(normal);
    Vec<D> tangential = across * lambda;
    for (int k : Range(D)) {
      Vec<D> turn = 0.0;
      turn(k) = 1;
      Mat<D, D> change = -1 * (turn * Trans(normal) + normal * Trans(turn));
      Vec<D> changed = change * lambda;
      result.Col(k) =
          share * Vec<D>(change * Vec<D>(fixed * tangential) + across * Vec<D>(fixed * changed));
    }
    return result;
  }

private:
  static Mat<D, D> Across(const Vec<D> & normal) { return Id<D>() - normal * Trans(normal); }
};

/// The contact law of all macro-elements: multipliers, scales and coefficients.
template <int D>
class MacroLaw {
  shared_ptr<LACSpace> space;
  ProxyInfo lam;
  bool tied, bilateral;
  double adjust;
  Watch watch_friction, watch_threshold, watch_offset;
  Array<Vec<D>> direction; // of slip in the last Newton step
  ContactFields fields;
  bool looks = false;                // do the fields have the values of a solution?
  std::map<string, Matrix<>> slopes; // of the functions, at the last derivatives
  NamedNumbers flowing;              // of flows, at the last evaluation
  Array<double> give; // of the offset under a pressure, >= 0; empty: not known in this solve

public:
  Array<double> c;                   // traction per displacement
  Array<double> friction, threshold; // means over the macro-elements, -1: none
  Array<double> offset;              // of the gap, means over the macro-elements
  Array<double> adjusted;            // minus the gaps of the start that count as zero
  Array<double> end_c;               // of points where contact ends inside, whatever c is
  bool has_ends = true;              // else pressures are even everywhere
  Array<Vec<D>> lean;                // turn the directions of pressures; empty: none do
  Array<int> dofs;                   // of the multipliers
  bool own;                          // the answers are those of another law

  MacroLaw(const ContactSetup & setup, shared_ptr<LACSpace> aspace, const ProxyInfo & alam)
      : space(aspace), lam(alam), tied(setup.tied), bilateral(setup.bilateral),
        adjust(setup.adjust), watch_friction(setup.friction), watch_threshold(setup.threshold),
        watch_offset(setup.offset), fields(setup.fields), own(setup.law != nullptr) {}

  /// May pressures be uneven where contact ends? Points do not know of an offset that depends.
  bool HasEnds() const { return has_ends && !Gives(); }
  /// Does the offset depend on the fields of the contact?
  bool Gives() const { return fields.slopes.count("offset"); }
  /// Do coefficients depend on the fields of the contact?
  bool Depends() const { return fields.values.size() > 0; }
  /// Evaluates the coefficients where the fields have such values (a function of the number of a
  /// macro-element), and after such a memory; derives: their derivatives, too.
  template <typename F>
  void DependOn(F values, const NamedNumbers & kept, bool derives) {
    for (auto & field : fields.values)
      FitMesh(*field);
    for (auto & [name, memory] : fields.memory) {
      FitMesh(*memory.first);
      auto before = memory.first->GetVector().template FV<double>();
      for (size_t m : Range(c))
        before(m) = kept.at(name)[m];
    }
    for (size_t m : Range(c)) {
      Vector<> numbers = values(m);
      if (auto slip = numbers.Range(0, D); L2Norm2(slip) == 0)
        slip(0) = 1e-150; // where its length has a derivative
      for (int k : Range(numbers))
        fields.values[k]->GetVector().template FV<double>()(m) = numbers(k);
    }
    looks = true;
    Reevaluate();
    looks = false;
    for (auto & flow : fields.flows) {
      flowing[flow.name + "out"] = MeansOf(*flow.out, flow.name + "out");
      flowing[flow.name + "in"] = MeansOf(*flow.into, flow.name + "in");
    }
    if (derives || give.Size() != c.Size())
      FindSlopes();
  }

private:
  Array<double> MeansOf(const CoefficientFunction & function, const string & name) const {
    return MacroMeans(function, *space, name, -std::numeric_limits<double>::infinity());
  }

  void FindSlopes() {
    for (auto & [name, functions] : fields.slopes) {
      auto & found = slopes[name];
      found.SetSize(c.Size(), functions.size());
      found = 0.0;
      for (size_t k : Range(functions.size()))
        if (functions[k]) {
          auto means = MeansOf(*functions[k], "the derivative of " + name);
          for (size_t m : Range(means))
            found(m, k) = means[m];
        }
    }
    give.SetSize(c.Size());
    auto found = slopes.find("offset");
    for (size_t m : Range(give))
      give[m] = found == slopes.end() ? 0 : max(0.0, found->second(m, D + 1));
  }

public:
  /// The memory after a step that ends with the fields of the last evaluation.
  NamedNumbers Remembered() const {
    NamedNumbers now;
    for (auto & [name, memory] : fields.memory)
      now[name] = MeansOf(*memory.second, name);
    return now;
  }

  /// How a function of the fields changes with the traction and with the place.
  struct Slope {
    Vec<D> by_traction, by_jump, by_normal;
    FlatVector<> by_scalars;
  };
  Slope SlopeOf(const string & name, size_t m, const MacroPlace<D> & place,
                const Vec<D> & traction) const {
    auto row = slopes.at(name).Row(m);
    auto & n = place.normal;
    Vec<D> by_slip = row.Range(0, D);
    double across = InnerProduct(by_slip, n), gap = -InnerProduct(place.jump, n);
    double by_gap = row(D), by_pressure = InnerProduct(n, traction) < 0 ? row(D + 1) : 0;
    Slope slope;
    slope.by_jump = by_slip - (across + by_gap) * n;
    slope.by_normal = gap * by_slip - (across + by_gap) * place.jump - by_pressure * traction;
    slope.by_traction = row.Range(D + 2, 2 * D + 2);
    slope.by_traction -= by_pressure * n;
    auto scalars = row.Range(2 * D + 2, row.Size());
    slope.by_scalars.AssignMemory(scalars.Size(), scalars.Data());
    return slope;
  }

  /// Adds to an answer how the coefficients change with the fields.
  void AddSlopes(size_t m, const MacroPlace<D> & place, FlatVector<> x, Answer<D> & answer) const {
    Vec<D> by_offset = -1 * (answer.by_jump * place.normal);
    answer.by_scalars.SetSize(D, 2 * fields.scalars.size());
    answer.by_scalars = 0.0;
    auto add = [&](const string & name, const Vec<D> & by) {
      if (!slopes.count(name))
        return;
      auto slope = SlopeOf(name, m, place, Multiplier(m, x));
      answer.by_jump += by * Trans(slope.by_jump);
      answer.by_multiplier += by * Trans(slope.by_traction);
      answer.by_normal += by * Trans(slope.by_normal);
      answer.by_scalars += by * Trans(slope.by_scalars);
    };
    add("friction", answer.by_friction);
    add("tresca", answer.by_threshold);
    add("offset", by_offset);
  }

  FlatArray<Flow> Flows() { return {fields.flows.size(), fields.flows.data()}; }
  /// The rate of a flow out of the slave ("out") or into the master ("in"), at the last evaluation.
  double Flowing(const Flow & flow, const char * end, size_t m) const {
    return flowing.at(flow.name + end)[m];
  }
  const NamedNumbers & Flowing() const { return flowing; }
  /// How the rate of a flow ("out", "in") grows with the field on the slave, at the last
  /// derivatives; 0: unknown.
  double GrowthOf(const Flow & flow, const char * end, size_t m) const {
    auto found = slopes.find(flow.name + end);
    return found == slopes.end() ? 0 : found->second(m, 2 * D + 2 + 2 * flow.field);
  }

  /// Numbers of each multiplier: D, or 1 of a scalar, the jump of which has D equal components.
  int Components() const { return lam.evaluator->Dim(); }
  /// The multipliers of a macro-element.
  FlatArray<int> Dofs(size_t m) const {
    return dofs.Range(Components() * m, Components() * (m + 1));
  }
  /// Finds the multipliers over the faces of a surface.
  void FindDofs(const Surface<D> & slave) {
    dofs.SetSize(Components() * space->NMacros());
    LocalHeap lh(1000 * 1000, "ngslac-multipliers");
    int block = lam.fes->GetDimension();
    Array<DofId> own;
    for (size_t f : Range(slave.Size())) {
      HeapReset hr(lh);
      ElementId ei(BND, slave.Element(f));
      lam.fes->GetDofNrs(ei, own);
      IntRange used = lam.evaluator->UsedDofs(lam.fes->GetFE(ei, lh));
      for (int k : Range(Components()))
        dofs[Components() * space->MacroOfFace()[ei.Nr()] + k] =
            block * own[(used.First() + k) / block] + (used.First() + k) % block;
    }
  }

  /// Evaluates the coefficients; no scale is known.
  void Reset() {
    Reevaluate();
    c.SetSize(space->NMacros()), direction.SetSize(space->NMacros());
    c = 0.0;
    adjusted.SetSize(space->NMacros()), end_c.SetSize(space->NMacros());
    adjusted = 0.0, end_c = 0.0;
    BeginSolve();
  }

  /// Evaluates what Parameters and other functions may have changed.
  void Reevaluate() {
    auto means = [&](Watch & watch, const char * name, Array<double> & values, double least,
                     double none) {
      if (fields.slopes.count(name) && !looks) {
        if (values.Size() != space->NMacros())
          values.SetSize(space->NMacros()), values = 0.0;
        return;
      }
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

  /// Forgets the slip directions of the last iteration.
  void BeginSolve() { direction = Vec<D>(0.0), give.SetSize(0); }

  /// What is added to the gap between the surfaces.
  double Clearance(size_t m) const { return offset[m] + adjusted[m]; }
  /// The gap between the surfaces at the start counts as zero if it is as small as is adjusted.
  void Adjust(size_t m, double gap) { adjusted[m] = fabs(gap) <= adjust ? -gap : 0; }
  /// How much farther clearances make the search for partners reach.
  SearchMargin Margin() const {
    SearchMargin margin{adjust, adjust};
    for (double value : offset)
      margin = {max(margin.farther, adjust - value), max(margin.deeper, adjust + value)};
    return margin;
  }

  Vec<D> Multiplier(size_t m, FlatVector<> x) const {
    Vec<D> traction = 0.0;
    auto own = Dofs(m);
    for (int k : Range(own))
      traction(k) = x(own[k]);
    return traction;
  }

  Array<Vec<D>> Multipliers(FlatVector<> x) const {
    Array<Vec<D>> all(c.Size());
    for (size_t m : Range(all))
      all[m] = Multiplier(m, x);
    return all;
  }

  /// The pressure that it stands for before the projection, at rest.
  double GivenPressure(size_t m, const Vec<D> & normal, FlatVector<> x) const {
    Vec<D> traction = Multiplier(m, x);
    return -InnerProduct(normal, traction - ComplianceOf(m).At(normal) * traction);
  }
  /// How the pressure spreads over the points of a macro-element that contact ends in.
  EndPressure Spread(size_t m, const EndPoints & points) const {
    return EndPressure::Of(points, NormalScale(m, true));
  }
  Compliance<D> ComplianceOf(size_t m) const { return Compliance<D>(space->ReachOf(m), tied); }
  /// The answer of the law at a place and the multiplier of x.
  Answer<D> At(size_t m, const MacroPlace<D> & place, FlatVector<> x) const {
    return AnswerOf(m, place, Project(Data(m, place), Trial(m, place, x)), x);
  }
  /// The same for a Newton step: what slips the other way than in the last one sticks.
  Answer<D> AtStep(size_t m, const MacroPlace<D> & place, FlatVector<> x) {
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

  /// Factor of the multiplier's rows, which makes the matrix symmetric where contact ends, too.
  ngbla::Mat<D, D> RowFactor(size_t m, const MacroPlace<D> & place) const {
    ngbla::Mat<D, D> factor = (place.rowarea / c[m]) * Id<D>();
    double softer = c[m] / NormalScale(m, place.ends) - 1;
    factor += (place.rowarea / c[m]) * softer * place.normal * Trans(place.normal);
    return factor;
  }

  /// Traction per displacement along the normal. A surface that gives under a pressure is softer:
  /// else a pressure that is too large would open the contact.
  double NormalScale(size_t m, bool ends) const {
    double scale = ends ? end_c[m] : c[m];
    return give.Size() ? scale / (1 + scale * give[m]) : scale;
  }

  /// Does the law depend on slip?
  bool Slides(size_t m) const { return own || Depends() || max(friction[m], threshold[m]) >= 0; }
  /// Slip that comes back when the tangential traction is taken away: it counts on.
  Vec<D> ElasticSlip(size_t m, const Vec<D> & normal, FlatVector<> x) const {
    if (own || ComplianceOf(m).IsRigid() || !(c[m] > 0))
      return Vec<D>(0.0);
    Vec<D> slip = (1 / c[m]) * (ComplianceOf(m).At(normal) * Multiplier(m, x));
    return slip - InnerProduct(slip, normal) * normal;
  }

private:
  /// Gives a field the size that its mesh asks for by now.
  void FitMesh(GridFunction & field) const {
    if (field.GetVector().Size() != c.Size())
      field.GetFESpace()->Update(), field.Update();
  }
  Answer<D> AnswerOf(size_t m, const MacroPlace<D> & place, const Projection<D> & p,
                     FlatVector<> x) const {
    auto & n = place.normal;
    auto compliance = ComplianceOf(m);
    double scale = NormalScale(m, place.ends);
    ngbla::Mat<D, D> multiplier = Id<D>() - compliance.At(n), jump = c[m] * Id<D>();
    jump += (scale - c[m]) * n * Trans(n);
    if (place.ends) { // the mean pressure of its points in place of the trial pressure
      double growth = Spread(m, *place.ends).by_multiplier - 1;
      multiplier += growth * n * Trans(Vec<D>(Trans(multiplier) * n));
    }
    Answer<D> answer;
    answer.traction = p.traction;
    answer.by_multiplier = p.derivative * multiplier;
    answer.by_jump = -1 * (p.derivative * jump);
    answer.by_normal = p.by_normal - p.derivative * compliance.ByNormal(n, Multiplier(m, x));
    if (!place.ends && scale != c[m]) { // normals of ends do not turn
      answer.by_normal -= (scale - c[m]) * (p.derivative * Turned(n, place.jump));
      Mat<D, D> row = Turned(n, p.traction - Multiplier(m, x));
      row += (scale / c[m] - 1) * n * Trans(Vec<D>(Trans(row) * n));
      answer.by_normal += (c[m] / scale - 1) * row;
    }
    answer.by_friction = p.by_friction, answer.by_threshold = p.by_threshold;
    answer.status = p.status;
    return answer;
  }

  /// Derivative of  n (n.v)  by n.
  static Mat<D, D> Turned(const Vec<D> & n, const Vec<D> & v) {
    return n * Trans(v) + InnerProduct(n, v) * Id<D>();
  }
  LawData<D> Data(size_t m, const MacroPlace<D> & place) const {
    bool paired = place.area > 0;
    return {place.normal, c[m], friction[m], threshold[m], tied && paired, bilateral && paired};
  }
  /// The traction before the projection. Macro-elements without a partner stay open.
  Vec<D> Trial(size_t m, const MacroPlace<D> & place, FlatVector<> x) const {
    if (place.area == 0)
      return place.normal;
    Vec<D> traction = Multiplier(m, x);
    auto & n = place.normal;
    Vec<D> trial = traction - ComplianceOf(m).At(n) * traction - c[m] * place.jump;
    if (!place.ends)
      return trial - (NormalScale(m, place.ends) - c[m]) * InnerProduct(n, place.jump) * n;
    double mean = Spread(m, *place.ends).mean;
    if (mean <= 0)
      return n; // open, whatever rounding does
    return trial - (InnerProduct(trial, n) + mean) * n;
  }
};

/// Pressures are even everywhere while it lives.
template <int D>
class EvenPressures {
  MacroLaw<D> & law;
  bool before;

public:
  explicit EvenPressures(MacroLaw<D> & alaw) : law(alaw), before(alaw.has_ends) {
    law.has_ends = false;
  }
  ~EvenPressures() { law.has_ends = before; }
};
} // namespace ngslac
