// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include "distance.hpp"
#include "twofold.hpp"

namespace ngslac {
/// The half space behind a plane, in 2D behind a line.
template <int D>
class HalfSpace final : public SignedDistance<D> {
  Vec<D> point, normal; // unit, out of the tool

public:
  HalfSpace(const Vec<D> & apoint, const Vec<D> & anormal)
      : point(apoint), normal(1 / L2Norm(anormal) * anormal) {}
  Nearness<D> At(const Vec<D> & x) const override {
    return {Apart<D>(x, point).Along(normal).Value(), normal};
  }
  Mat<D, D> Hessian(const Vec<D> &) const override { return Mat<D, D>(0.0); }
};

/// All that is near a point, or in 3D near a straight line: a disc, a ball, an infinite cylinder.
template <int D>
class Ball final : public SignedDistance<D> {
  Vec<D> center;
  double radius;
  Vec<D> axis;      // of the line, unit or 0
  Mat<D, D> across; // projection to the plane across the line

  /// Of a ball with a far center too, where length and radius have many digits in common.
  double Distance(const Vec<D> & x, double length) const {
    Apart<D> apart(x, center);
    Twofold difference = apart.Square(); // of the squares
    if (L2Norm2(axis) > 0)
      difference.AddSquare(-1, apart.Along(axis));
    difference.AddSquare(-1, Twofold(radius));
    double distance = difference.Value() / (length + radius);
    // Squares of extreme numbers over- or underflow.
    return fabs(length - radius) > 0.1 * radius || !isfinite(distance) ? length - radius : distance;
  }

public:
  /// `axis`: of the line, 0 for a point
  Ball(const Vec<D> & acenter, double aradius, const Vec<D> & aaxis)
      : center(acenter), radius(aradius), axis(0.0), across(Id<D>()) {
    if (double length = L2Norm(aaxis); length > 0)
      axis = 1 / length * aaxis;
    across -= axis * Trans(axis);
  }

  Nearness<D> At(const Vec<D> & x) const override {
    Vec<D> away = across * (x - center);
    double length = L2Norm(away);
    return {Distance(x, length), length > 0 ? Vec<D>(1 / length * away) : Vec<D>(0.0)};
  }
  Mat<D, D> Hessian(const Vec<D> & x) const override {
    auto near = At(x);
    double length = near.distance + radius;
    if (length <= 0)
      return Mat<D, D>(0.0);
    return 1 / length * (across - near.gradient * Trans(near.gradient));
  }
};

/// The tip of a cone in its meridian plane, with coordinates from the axis and along it.
class Wedge final : public SignedDistance<2> {
  Vec<2> along, normal; // of the flank

public:
  explicit Wedge(double half_angle)
      : along(sin(half_angle), cos(half_angle)), normal(cos(half_angle), -sin(half_angle)) {}
  Nearness<2> At(const Vec<2> & x) const override {
    double length = L2Norm(x);
    if (InnerProduct(along, x) >= 0 || length == 0)
      return {Apart<2>(x, Vec<2>(0.0)).Along(normal).Value(), normal};
    return {length, 1 / length * x};
  }

  Mat<2, 2> Hessian(const Vec<2> & x) const override {
    double length = L2Norm(x);
    if (InnerProduct(along, x) >= 0 || length == 0)
      return Mat<2, 2>(0.0);
    Vec<2> direction = 1 / length * x;
    return 1 / length * (Id<2>() - direction * Trans(direction));
  }
};

/// A plane profile turned about an axis; its coordinates are the distance from it, and that along.
class Revolution final : public SignedDistance<3> {
  SomeTool<2> profile;
  Vec<3> point, axis; // unit
  struct Meridian {
    Vec<2> at;     // distance from the axis, and along it
    Vec<2> rest;   // the digits that these leave out
    Vec<3> radial; // unit, 0 on the axis
  };
  Meridian MeridianOf(const Vec<3> & x) const {
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
            Vec<2>(fabs(rest) < 1e-12 * radius ? rest : 0, height.Rest()),
            Vec<3>(1 / radius * away)};
  }

public:
  Revolution(SomeTool<2> aprofile, const Vec<3> & apoint, const Vec<3> & aaxis)
      : profile(aprofile), point(apoint), axis(1 / L2Norm(aaxis) * aaxis) {}
  Nearness<3> At(const Vec<3> & x) const override {
    auto meridian = MeridianOf(x);
    auto near = profile->At(meridian.at);
    return {near.distance + InnerProduct(near.gradient, meridian.rest),
            near.gradient(0) * meridian.radial + near.gradient(1) * axis};
  }

  Mat<3, 3> Hessian(const Vec<3> & x) const override {
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

  void CollectFunctions(Array<shared_ptr<CoefficientFunction>> & all) const override {
    profile->CollectFunctions(all);
  }
};

/// All points that are as near a tool as that: its convex corners become round.
template <int D>
class Grown final : public SignedDistance<D> {
  SomeTool<D> tool;
  double by;

public:
  Grown(SomeTool<D> atool, double aby) : tool(atool), by(aby) {}
  Nearness<D> At(const Vec<D> & x) const override {
    auto near = tool->At(x);
    return {near.distance - by, near.gradient};
  }
  Mat<D, D> Hessian(const Vec<D> & x) const override { return tool->Hessian(x); }
  void CollectFunctions(Array<shared_ptr<CoefficientFunction>> & all) const override {
    tool->CollectFunctions(all);
  }
};

/// The complement of a tool.
template <int D>
class Complement final : public SignedDistance<D> {
  SomeTool<D> tool;

public:
  explicit Complement(SomeTool<D> atool) : tool(atool) {}
  Nearness<D> At(const Vec<D> & x) const override {
    auto near = tool->At(x);
    return {-near.distance, -near.gradient};
  }
  Mat<D, D> Hessian(const Vec<D> & x) const override { return -1 * tool->Hessian(x); }
  void CollectFunctions(Array<shared_ptr<CoefficientFunction>> & all) const override {
    tool->CollectFunctions(all);
  }
};

/// Two tools as one.
template <int D>
class Together final : public SignedDistance<D> {
  SomeTool<D> first, second;
  const SignedDistance<D> & Nearer(const Vec<D> & x) const {
    return first->At(x).distance <= second->At(x).distance ? *first : *second;
  }

public:
  Together(SomeTool<D> one, SomeTool<D> other) : first(one), second(other) {}
  Nearness<D> At(const Vec<D> & x) const override {
    auto one = first->At(x), other = second->At(x);
    return one.distance <= other.distance ? one : other;
  }
  Mat<D, D> Hessian(const Vec<D> & x) const override { return Nearer(x).Hessian(x); }
  void CollectFunctions(Array<shared_ptr<CoefficientFunction>> & all) const override {
    first->CollectFunctions(all);
    second->CollectFunctions(all);
  }
};
} // namespace ngslac
