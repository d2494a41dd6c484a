// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include "coefficients.hpp"
#include "contactform.hpp"

namespace ngslac {
/// How the points of a tool move with an unknown of its motion:  linear + spin x.
template <int D>
struct ToolDof {
  int dof;
  Vec<D> linear;
  Mat<D, D> spin;
  bool turns;
  Vec<D> At(const Vec<D> & x) const { return linear + spin * x; }
};

/// A point of the slave, and a tool.
template <int D>
struct ToolHit {
  double distance;
  Vec<D> gradient;
  Vec<D> normal; // unit, out of the tool; 0 where it has none
};

/// A tool where it is.
template <int D>
class ToolPosition {
  SomeTool<D> shape;

public:
  Placement<D> place;
  Array<ToolDof<D>> dofs;

  ToolPosition(SomeTool<D> ashape, const Placement<D> & aplace) : shape(ashape), place(aplace) {}
  ToolHit<D> At(const Vec<D> & x) const;
  /// Derivative of the normal by the point.
  Mat<D, D> Bend(const Vec<D> & x, const ToolHit<D> & hit) const;
};

/// The motion of a tool: that of its path, and that of its unknowns.
template <int D>
class ToolPath {
  SomeTool<D> shape;
  std::vector<ToolMotion> motions;
  struct Drive {
    ToolDrive given;
    int dof;
  };
  Array<Drive> drives;
  Array<unique_ptr<Watch>> watches;
  Placement<D> place;
  Array<double> loads;
  int version = 0;

public:
  ToolPath(const RigidTool & tool, const ProxyInfo & u);
  /// Evaluates what Parameters may have changed.
  void Reevaluate();
  /// Another number for other values of Parameters.
  int Version() const { return version; }
  ToolPosition<D> At(FlatVector<> x) const;
  /// Of the unknowns, in the order of ToolPosition::dofs.
  FlatArray<int> Dofs() const { return dofs; }
  /// Subtracts the loads on the tool.
  void AddLoads(FlatVector<> y) const;

private:
  Array<int> dofs;
};
} // namespace ngslac
