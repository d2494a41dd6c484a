// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include "coefficients.hpp"
#include "compliance.hpp"
#include "endlaw.hpp"
#include "pairfinder.hpp"

namespace ngslac {
/// Where a macro-element is: means over its paired part.
template <int D>
struct MacroPlace {
  Vec<D> normal;
  double gap;           // along it
  Vec<D> slip;          // of this step, perpendicular to the normal
  Vec<D> jump;          // what has to vanish: slip minus gap n, or all of u1 - u2 of tied surfaces
  double area, rowarea; // paired; factor of the multiplier's rows, see MacroJump::RowArea
  const EndPoints * ends = nullptr; // where contact ends inside of it
};

/// Of surfaces that slide; the slip may have a part along the normal.
template <int D>
MacroPlace<D> PlaceAt(const Vec<D> & normal, double gap, Vec<D> slip, double area, double rowarea) {
  slip -= InnerProduct(slip, normal) * normal;
  return {normal, gap, slip, slip - gap * normal, area, rowarea};
}

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
  Array<int> dofs;                   // of the multipliers, D for each

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
  /// The pressure that it stands for before the projection, at rest.
  double GivenPressure(size_t m, const Vec<D> & normal, FlatVector<> x) const;
  /// How the pressure spreads over the points of a macro-element that contact ends in.
  EndPressure Spread(size_t m, const EndPoints & points) const {
    return EndPressure::Of(points, end_c[m]);
  }
  /// Factor of the multiplier's rows that makes the matrix symmetric where contact ends.
  ngbla::Mat<D, D> EndFactor(size_t m, const Vec<D> & normal) const;
  Compliance<D> ComplianceOf(size_t m) const { return Compliance<D>(space->ReachOf(m), tied); }
  Projection<D> ProjectAt(size_t m, const MacroPlace<D> & place, FlatVector<> x) const {
    return Project(Data(m, place), Trial(m, place, x));
  }
  /// The projection, but what slips the other way than in the last Newton step sticks.
  Projection<D> ProjectWithMemory(size_t m, const MacroPlace<D> & place, FlatVector<> x);
  /// Adds the residual of the multiplier's rows.
  void AddResidual(size_t m, const MacroPlace<D> & place, const Projection<D> & p, FlatVector<> x,
                   FlatVector<> y) const;
  /// Derivative of a multiplier's rows by the multiplier, from that of the projection.
  ngbla::Mat<D, D> MultiplierBlock(size_t m, const Vec<D> & normal, double rowarea,
                                   const ngbla::Mat<D, D> & projection) const;
  /// The same where contact ends inside of the macro-element.
  ngbla::Mat<D, D> EndBlock(size_t m, const Vec<D> & normal, double rowarea,
                            const ngbla::Mat<D, D> & projection, const EndPressure & spread) const;
  /// Slip that comes back when the tangential traction is taken away: it counts on.
  Vec<D> ElasticSlip(size_t m, const Vec<D> & normal, FlatVector<> x) const;

private:
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
