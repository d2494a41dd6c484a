#pragma once
#include <bla.hpp>

namespace ngslac {
using namespace ngbla;

enum class Status : int { open = 0, stick = 1, slip = 2 };

/// What the law needs to know of one macro-element.
template <int D>
struct LawData {
  Vec<D> normal;    // out of the slave body
  double c;         // traction per displacement, the scale of the complementarity function
  double friction;  // Coulomb's coefficient
  double threshold; // Tresca's bound of the tangential traction, added to Coulomb's
  bool tied;
};

/// The projection of a trial traction, and its generalised derivative.
template <int D>
struct Projection {
  Vec<D> traction;
  Mat<D, D> derivative;
  Status status;
};

/// Unilateral contact with friction as one projection.
///
/// With the trial traction  t = lambda - c (mean gap and slip vector)  and  p = -t.n  :
/// open (p <= 0) gives 0, stick (|t_T| <= F p) gives t itself, slip gives -p n + F p t_T/|t_T|.
/// The contact conditions hold if and only if the projection equals lambda
/// (Alart and Curnier 1991; macro-element by macro-element as in Abbas et al. 2017, eq. 7).
template <int D>
Projection<D> Project(const LawData<D> & data, Vec<D> trial) {
  Projection<D> result;
  const Vec<D> & n = data.normal;
  Mat<D, D> identity = Id<D>();
  double pressure = -InnerProduct(trial, n);
  if (data.tied)
    return {trial, identity, Status::stick};
  if (pressure <= 0)
    return {Vec<D>(0.0), Mat<D, D>(0.0), Status::open};

  Vec<D> tangential = trial + pressure * n;
  double size = L2Norm(tangential);
  double bound = data.friction * pressure + data.threshold;
  if (size <= bound && bound > 0)
    return {trial, identity, Status::stick};

  Mat<D, D> nn = n * Trans(n);
  result.status = Status::slip;
  result.traction = -pressure * n;
  result.derivative = nn;
  if (bound > 0) {
    Vec<D> direction = (1 / size) * tangential;
    result.traction += bound * direction;
    result.derivative += (bound / size) * (identity - nn - direction * Trans(direction));
    result.derivative -= data.friction * direction * Trans(n);
  }
  return result;
}
} // namespace ngslac
