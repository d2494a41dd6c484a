// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include "coefficients.hpp"
#include "compliance.hpp"
#include "law.hpp"
#include "pairfinder.hpp"
#include "place.hpp"

namespace ngslac {
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
