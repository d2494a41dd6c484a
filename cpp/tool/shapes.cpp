// SPDX-License-Identifier: LGPL-2.1-or-later
#include "shapes.hpp"

namespace ngslac {
template <int D>
Nearness<D> HalfSpace<D>::At(const Vec<D> & x) const {
  return {InnerProduct(normal, x - point), normal};
}

template <int D>
Ball<D>::Ball(const Vec<D> & acenter, double aradius, const Vec<D> & axis)
    : center(acenter), radius(aradius), across(Id<D>()) {
  if (double square = L2Norm2(axis); square > 0)
    across -= (1 / square) * axis * Trans(axis);
}

template <int D>
Nearness<D> Ball<D>::At(const Vec<D> & x) const {
  Vec<D> away = across * (x - center);
  double length = L2Norm(away);
  return {length - radius, length > 0 ? Vec<D>(1 / length * away) : Vec<D>(0.0)};
}

template <int D>
Mat<D, D> Ball<D>::Hessian(const Vec<D> & x) const {
  auto near = At(x);
  double length = near.distance + radius;
  if (length <= 0)
    return Mat<D, D>(0.0);
  return 1 / length * (across - near.gradient * Trans(near.gradient));
}

Wedge::Wedge(double half_angle)
    : along(sin(half_angle), cos(half_angle)), normal(cos(half_angle), -sin(half_angle)) {}

Nearness<2> Wedge::At(const Vec<2> & x) const {
  double length = L2Norm(x);
  if (InnerProduct(along, x) >= 0 || length == 0)
    return {InnerProduct(normal, x), normal};
  return {length, 1 / length * x};
}

Mat<2, 2> Wedge::Hessian(const Vec<2> & x) const {
  double length = L2Norm(x);
  if (InnerProduct(along, x) >= 0 || length == 0)
    return Mat<2, 2>(0.0);
  Vec<2> direction = 1 / length * x;
  return 1 / length * (Id<2>() - direction * Trans(direction));
}

struct Revolution::Meridian {
  Vec<2> at;     // distance from the axis, and along it
  Vec<3> radial; // unit, 0 on the axis
};

Revolution::Meridian Revolution::MeridianOf(const Vec<3> & x) const {
  Vec<3> away = x - point;
  double height = InnerProduct(axis, away);
  away -= height * axis;
  double radius = L2Norm(away);
  return {Vec<2>(radius, height), radius > 0 ? Vec<3>(1 / radius * away) : Vec<3>(0.0)};
}

Nearness<3> Revolution::At(const Vec<3> & x) const {
  auto meridian = MeridianOf(x);
  auto near = profile->At(meridian.at);
  return {near.distance, near.gradient(0) * meridian.radial + near.gradient(1) * axis};
}

Mat<3, 3> Revolution::Hessian(const Vec<3> & x) const {
  auto [at, radial] = MeridianOf(x);
  auto second = profile->Hessian(at);
  Mat<3, 3> across = Id<3>() - axis * Trans(axis);
  if (at(0) == 0)
    return second(0, 0) * across + second(1, 1) * axis * Trans(axis);
  Mat<3, 3> around = across - radial * Trans(radial);
  double bend = profile->At(at).gradient(0) / at(0);
  return second(0, 0) * radial * Trans(radial) + second(1, 1) * axis * Trans(axis) +
         second(0, 1) * (radial * Trans(axis) + axis * Trans(radial)) + bend * around;
}

template class HalfSpace<2>;
template class HalfSpace<3>;
template class Ball<2>;
template class Ball<3>;
} // namespace ngslac
