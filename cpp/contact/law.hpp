// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <bla.hpp>

namespace ngslac {
using namespace ngbla;

enum class Status : int { open = 0, stick = 1, slip = 2 };

/// The largest tangential traction under a pressure.
struct FrictionBound {
  double size, by_pressure;
  bool is_coulomb; // proportional to the pressure, else it is Tresca's
};

/// The data of one macro-element that the law uses.
template <int D>
struct LawData {
  Vec<D> normal;    // out of the slave body
  double c;         // traction per displacement, the scale of the complementarity function
  double friction;  // Coulomb's coefficient, negative: none
  double threshold; // Tresca's bound of the tangential traction, negative: none
  bool tied;
  bool bilateral; // pressures have any sign

  /// Under a pressure of any sign. Friction with both constants is Coulomb's up to the threshold.
  FrictionBound Bound(double pressure) const {
    double coulomb = friction * fabs(pressure);
    if (threshold >= 0 && (friction < 0 || threshold < coulomb))
      return {threshold, 0, false};
    return friction >= 0 ? FrictionBound{coulomb, pressure < 0 ? -friction : friction, true}
                         : FrictionBound{0, 0, false};
  }
};

/// The projection of a trial traction, and its generalised derivative.
template <int D>
struct Projection {
  Vec<D> traction;
  Mat<D, D> derivative; // by the trial traction
  Mat<D, D> by_normal;  // where the normal moves, too
  Status status;
  Vec<D> by_friction = Vec<D>(0.0), by_threshold = Vec<D>(0.0);
};

/// The answer of a law at a place: the traction that the multiplier should be, and its derivatives.
///
/// The one by the normal counts at a fixed mean jump.
template <int D>
struct Answer {
  Vec<D> traction = Vec<D>(0.0);
  Mat<D, D> by_multiplier = Mat<D, D>(0.0);
  Mat<D, D> by_jump = Mat<D, D>(0.0), by_normal = Mat<D, D>(0.0);
  Vec<D> by_friction = Vec<D>(0.0), by_threshold = Vec<D>(0.0);
  Matrix<> by_scalars; // by the means of scalar fields, a column each; empty: it does not depend
  Status status = Status::open;
};

/// The derivative of a traction by the jump without the part by which a law softens.
///
/// Friction is not symmetric, and softens in no direction by more than that: it stays as it is.
/// A traction that pulls is not friction: all of its softening is left out.
template <int D>
Mat<D, D> Resisting(Mat<D, D> by_jump, bool pulls) {
  Mat<D, D> symmetric = -0.5 * (by_jump + Trans(by_jump)), directions;
  double skew = 0.5 * L2Norm(Mat<D, D>(by_jump - Trans(by_jump)));
  Vec<D> stiffness;
  CalcEigenSystem(symmetric, stiffness, directions);
  for (int k : Range(D)) {
    Vec<D> direction = directions.Row(k);
    if (stiffness(k) < (pulls ? 0 : -skew))
      by_jump += stiffness(k) * direction * Trans(direction);
  }
  return by_jump;
}

template <int D>
Projection<D> Sticking(Vec<D> trial) {
  return {trial, Id<D>(), Mat<D, D>(0.0), Status::stick};
}

/// Unilateral contact with friction as one projection.
///
/// With the trial traction  t = lambda - c (mean gap and slip vector)  and  p = -t.n  :
/// open (p <= 0) gives 0, stick (|t_T| <= F p) gives t itself, slip gives -p n + F p t_T/|t_T|.
/// Bilateral contact is never open, and its bound is F |p|.
/// With Tresca's bound in place of F p the projection jumps at p = 0: it presumes closed contact.
/// The contact conditions hold if and only if the projection equals lambda
/// (Alart and Curnier 1991; macro-element by macro-element as in Abbas et al. 2017, eq. 7).
template <int D>
Projection<D> Project(const LawData<D> & data, Vec<D> trial) {
  Projection<D> result{Vec<D>(0.0), Mat<D, D>(0.0), Mat<D, D>(0.0), Status::open};
  const Vec<D> & n = data.normal;
  Mat<D, D> identity = Id<D>();
  double pressure = -InnerProduct(trial, n);
  if (data.tied)
    return Sticking(trial);
  if (pressure <= 0 && !data.bilateral)
    return result;

  Vec<D> tangential = trial + pressure * n;
  double size = L2Norm(tangential);
  auto [bound, slope, is_coulomb] = data.Bound(pressure);
  if (size <= bound && bound > 0)
    return Sticking(trial);

  Mat<D, D> nn = n * Trans(n);
  result.status = Status::slip;
  result.traction = -pressure * n;
  result.derivative = nn;
  result.by_normal = n * Trans(trial) - pressure * identity;
  if (size > 0)
    (is_coulomb ? result.by_friction : result.by_threshold) =
        (is_coulomb ? fabs(pressure) : 1) / size * tangential;
  if (bound > 0) {
    Vec<D> direction = (1 / size) * tangential;
    Mat<D, D> across = (bound / size) * (identity - direction * Trans(direction));
    result.traction += bound * direction;
    result.derivative += across - (bound / size) * nn;
    result.derivative -= slope * direction * Trans(n);
    result.by_normal += pressure * across - across * n * Trans(trial);
    result.by_normal -= slope * direction * Trans(trial);
  }
  return result;
}
} // namespace ngslac
