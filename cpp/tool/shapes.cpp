// SPDX-License-Identifier: LGPL-2.1-or-later
#include "shapes.hpp"
#include "twofold.hpp"

namespace ngslac {
template <int D>
Nearness<D> HalfSpace<D>::At(const Vec<D> & x) const {
  return {Apart<D>(x, point).Along(normal).Value(), normal};
}

template <int D>
Ball<D>::Ball(const Vec<D> & acenter, double aradius, const Vec<D> & aaxis)
    : center(acenter), radius(aradius), axis(0.0), across(Id<D>()) {
  if (double length = L2Norm(aaxis); length > 0)
    axis = 1 / length * aaxis;
  across -= axis * Trans(axis);
}

template <int D>
Nearness<D> Ball<D>::At(const Vec<D> & x) const {
  Vec<D> away = across * (x - center);
  double length = L2Norm(away);
  return {Distance(x, length), length > 0 ? Vec<D>(1 / length * away) : Vec<D>(0.0)};
}

/// Of a ball with a far center too, where length and radius have many digits in common.
template <int D>
double Ball<D>::Distance(const Vec<D> & x, double length) const {
  Apart<D> apart(x, center);
  Twofold difference = apart.Square(); // of the squares
  if (L2Norm2(axis) > 0)
    difference.AddSquare(-1, apart.Along(axis));
  difference.AddSquare(-1, Twofold(radius));
  double distance = difference.Value() / (length + radius);
  // Squares of extreme numbers are none.
  return fabs(length - radius) > 0.1 * radius || !isfinite(distance) ? length - radius : distance;
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
    return {Apart<2>(x, Vec<2>(0.0)).Along(normal).Value(), normal};
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
  Vec<2> rest;   // the digits that these leave out
  Vec<3> radial; // unit, 0 on the axis
};

Revolution::Meridian Revolution::MeridianOf(const Vec<3> & x) const {
  Apart<3> apart(x, point);
  Twofold height = apart.Along(axis), square = apart.Square();
  square.AddSquare(-1, height);
  Vec<3> away = apart.Value() - height.Value() * axis;
  double radius = L2Norm(away);
  if (radius == 0)
    return {Vec<2>(0, height.Value()), Vec<2>(0, height.Rest()), Vec<3>(0.0)};
  square.AddSquare(-1, Twofold(radius));
  double rest = square.Value() / (2 * radius);
  return {Vec<2>(radius, height.Value()),
          Vec<2>(fabs(rest) < 1e-12 * radius ? rest : 0, height.Rest()), Vec<3>(1 / radius * away)};
}

Nearness<3> Revolution::At(const Vec<3> & x) const {
  auto meridian = MeridianOf(x);
  auto near = profile->At(meridian.at);
  return {near.distance + InnerProduct(near.gradient, meridian.rest),
          near.gradient(0) * meridian.radial + near.gradient(1) * axis};
}

Mat<3, 3> Revolution::Hessian(const Vec<3> & x) const {
  auto [at, rest, radial] = MeridianOf(x);
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
