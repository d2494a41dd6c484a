// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include "tool/motion.hpp"

namespace ngslac {
/// A part of a tool's motion that is not given, but follows from the balance of forces.
struct ToolDrive {
  shared_ptr<CoefficientFunction> travel; // trial function of one number
  shared_ptr<CoefficientFunction> load;   // force or moment on the tool; null: none
  int component;                          // of the shift; -1: a rotation
  Vec<3> center, axis;                    // of the rotation, before the tool moves
};

/// A rigid body that is no mesh: what it is, how it moves by itself, and how loads move it.
struct RigidTool {
  shared_ptr<ToolShape> shape;
  std::vector<ToolMotion> motions;
  std::vector<ToolDrive> drives;
};
} // namespace ngslac
