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

public:
  Array<double> c;                   // traction per displacement
  Array<double> friction, threshold; // means over the macro-elements, -1: none
  Array<double> offset;              // of the gap, means over the macro-elements
  Array<double> adjusted;            // minus the gaps of the start that count as zero
  Array<double> end_c;               // of points where contact ends inside, whatever c is
  bool has_ends = true;              // else pressures are even everywhere
  Array<Vec<D>> lean;                // turn the directions of pressures; empty: none do
  Array<int> dofs;                   // of the multipliers, D for each
  bool own;                          // the answers are those of another law

  MacroLaw(const ContactSetup & setup, shared_ptr<LACSpace> aspace, const ProxyInfo & alam);

  /// Finds the multipliers over the faces of a surface.
  void FindDofs(const Surface<D> & slave);
  /// Evaluates the coefficients; no scale is known.
  void Reset();
  /// Evaluates what Parameters and other functions may have changed.
  void Reevaluate();
  /// Forgets the slip directions of the last iteration.
  void BeginSolve() { direction = Vec<D>(0.0); }

  /// What is added to the gap between the surfaces.
  double Clearance(size_t m) const { return offset[m] + adjusted[m]; }
  /// The gap between the surfaces at the start counts as zero if it is as small as is adjusted.
  void Adjust(size_t m, double gap) { adjusted[m] = fabs(gap) <= adjust ? -gap : 0; }
  /// What clearances ask of a search for partners.
  SearchMargin Margin() const;

  Vec<D> Multiplier(size_t m, FlatVector<> x) const;
  Array<Vec<D>> Multipliers(FlatVector<> x) const {
    Array<Vec<D>> all(c.Size());
    for (size_t m : Range(all))
      all[m] = Multiplier(m, x);
    return all;
  }
  /// The pressure that it stands for before the projection, at rest.
  double GivenPressure(size_t m, const Vec<D> & normal, FlatVector<> x) const;
  /// How the pressure spreads over the points of a macro-element that contact ends in.
  EndPressure Spread(size_t m, const EndPoints & points) const {
    return EndPressure::Of(points, end_c[m]);
  }
  Compliance<D> ComplianceOf(size_t m) const { return Compliance<D>(space->ReachOf(m), tied); }
  /// The answer of the law at a place and the multiplier of x.
  Answer<D> At(size_t m, const MacroPlace<D> & place, FlatVector<> x) const {
    return AnswerOf(m, place, Project(Data(m, place), Trial(m, place, x)), x);
  }
  /// The same for a Newton step: what slips the other way than in the last one sticks.
  Answer<D> AtStep(size_t m, const MacroPlace<D> & place, FlatVector<> x);
  /// Factor of the multiplier's rows, which makes the matrix symmetric where contact ends, too.
  ngbla::Mat<D, D> RowFactor(size_t m, const MacroPlace<D> & place) const;
  /// Does it look at slip?
  bool Slides(size_t m) const { return own || max(friction[m], threshold[m]) >= 0; }
  /// Slip that comes back when the tangential traction is taken away: it counts on.
  Vec<D> ElasticSlip(size_t m, const Vec<D> & normal, FlatVector<> x) const;

private:
  Answer<D> AnswerOf(size_t m, const MacroPlace<D> & place, const Projection<D> & p,
                     FlatVector<> x) const;
  LawData<D> Data(size_t m, const MacroPlace<D> & place) const;
  /// The traction before the projection. Macro-elements without a partner stay open.
  Vec<D> Trial(size_t m, const MacroPlace<D> & place, FlatVector<> x) const;
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
