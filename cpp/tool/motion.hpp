// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include "distance.hpp"
#include "twofold.hpp"

namespace ngslac {
/// Where a tool is: its point y is at  turn y + shift.
template <int D>
struct Placement {
  Mat<D, D> turn = Id<D>();
  Vec<D> shift = Vec<D>(0.0);

  Vec<D> ToSpace(const Vec<D> & y) const { return turn * y + shift; }
  Vec<D> ToTool(const Vec<D> & x) const { return Trans(turn) * (x - shift); }
  /// ToTool(x), and the remainder that rounding takes from it, which counts where a tool turns
  /// about a far point.
  pair<Vec<D>, Vec<D>> ToToolWithRest(const Vec<D> & x) const {
    Apart<D> apart(x, shift);
    Vec<D> value, rest;
    for (int k : Range(D)) {
      auto along = apart.Along(turn.Col(k));
      value(k) = along.Value(), rest(k) = along.Rest();
    }
    return {value, rest};
  }
  /// Adds a rotation about a point of the space after this motion.
  void Turn(const Mat<D, D> & by, const Vec<D> & about);
  /// Adds a shift after this motion.
  void Shift(const Vec<D> & by) { shift += by; }
  bool operator==(const Placement & other) const;
};

/// The rotation by an angle about an axis, and its derivative at the angle 0. In 2D the axis is
/// ignored and points to the viewer.
template <int D>
Mat<D, D> Rotation(double angle, const Vec<3> & axis);
template <int D>
Mat<D, D> Spin(const Vec<3> & axis);

/// A rotation about an axis through a point, and then a shift, as functions of Parameters.
struct ToolMotion {
  shared_ptr<CoefficientFunction> shift, angle; // null: none
  Vec<3> center, axis;
};

/// A part of a tool's motion that is unknown and follows from the balance of forces.
struct ToolDrive {
  shared_ptr<CoefficientFunction> travel; // trial function of one number
  shared_ptr<CoefficientFunction> load;   // force or moment on the tool; null: none
  int component;                          // of the shift; -1: a rotation
  Vec<3> center, axis;                    // of the rotation, before the tool moves
};

/// A rigid body without a mesh: its shape, its motions by Parameters, and its motions by loads.
struct RigidTool {
  shared_ptr<ToolShape> shape;
  std::vector<ToolMotion> motions;
  std::vector<ToolDrive> drives;
};

/// Throws if a function depends on more than numbers and Parameters.
void CheckParametric(CoefficientFunction & function, const string & name);
/// Values of a function of numbers and Parameters.
Vec<3> ValuesOf(const CoefficientFunction & function);

/// The placement after these motions, one after the other. Centers, axes and shifts are those of
/// the space, not of the moved tool.
template <int D>
Placement<D> Follow(const std::vector<ToolMotion> & motions);

template <int D>
Vec<D> FirstOf(const Vec<3> & x) {
  Vec<D> result;
  for (int k : Range(D))
    result(k) = x(k);
  return result;
}
} // namespace ngslac
