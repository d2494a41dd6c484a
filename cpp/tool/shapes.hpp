// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include "distance.hpp"

namespace ngslac {
/// What lies behind a plane, in 2D a line.
template <int D>
class HalfSpace final : public SignedDistance<D> {
  Vec<D> point, normal; // unit, out of the tool

public:
  HalfSpace(const Vec<D> & apoint, const Vec<D> & anormal)
      : point(apoint), normal(1 / L2Norm(anormal) * anormal) {}
  Nearness<D> At(const Vec<D> & x) const override;
  Mat<D, D> Hessian(const Vec<D> &) const override { return Mat<D, D>(0.0); }
};

/// What is near a point, in 3D also near a straight line: a ball, a disc, an infinite cylinder.
template <int D>
class Ball final : public SignedDistance<D> {
  Vec<D> center;
  double radius;
  Vec<D> axis;      // of the line, unit or 0
  Mat<D, D> across; // projection to the plane across the line
  double Distance(const Vec<D> & x, double length) const;

public:
  /// `axis`: of the line, 0 for a point
  Ball(const Vec<D> & acenter, double aradius, const Vec<D> & aaxis);
  Nearness<D> At(const Vec<D> & x) const override;
  Mat<D, D> Hessian(const Vec<D> & x) const override;
};

/// The tip of a cone in its meridian plane, with coordinates from the axis and along it.
class Wedge final : public SignedDistance<2> {
  Vec<2> along, normal; // of the flank

public:
  explicit Wedge(double half_angle);
  Nearness<2> At(const Vec<2> & x) const override;
  Mat<2, 2> Hessian(const Vec<2> & x) const override;
};

/// A plane profile turned about an axis; its coordinates are the distance from it, and that along.
class Revolution final : public SignedDistance<3> {
  SomeTool<2> profile;
  Vec<3> point, axis; // unit
  struct Meridian;
  Meridian MeridianOf(const Vec<3> & x) const;

public:
  Revolution(SomeTool<2> aprofile, const Vec<3> & apoint, const Vec<3> & aaxis)
      : profile(aprofile), point(apoint), axis(1 / L2Norm(aaxis) * aaxis) {}
  Nearness<3> At(const Vec<3> & x) const override;
  Mat<3, 3> Hessian(const Vec<3> & x) const override;
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

/// All that a tool is not.
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
