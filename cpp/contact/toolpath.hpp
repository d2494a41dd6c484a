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

/// Distance and normal of a tool at a point of the slave.
template <int D>
struct ToolHit {
  double distance;
  Vec<D> gradient;
  Vec<D> normal; // unit, out of the tool; 0 where the gradient is 0
};

/// A tool at its current place.
template <int D>
class ToolPosition {
  SomeTool<D> shape;

public:
  Placement<D> place;
  Array<ToolDof<D>> dofs;

  ToolPosition(SomeTool<D> ashape, const Placement<D> & aplace) : shape(ashape), place(aplace) {}
  ToolHit<D> At(const Vec<D> & x) const {
    auto [there, rest] = place.ToToolWithRest(x);
    auto near = shape->At(there);
    Vec<D> gradient = place.turn * near.gradient;
    double length = L2Norm(gradient);
    return {near.distance + InnerProduct(near.gradient, rest), gradient,
            length > 0 ? Vec<D>(1 / length * gradient) : Vec<D>(0.0)};
  }

  /// Derivative of the normal by the point.
  Mat<D, D> Bend(const Vec<D> & x, const ToolHit<D> & hit) const {
    double length = L2Norm(hit.gradient);
    if (length == 0)
      return Mat<D, D>(0.0);
    Mat<D, D> second = shape->Hessian(place.ToTool(x));
    Mat<D, D> bend = place.turn * Mat<D, D>(second * Trans(place.turn));
    Vec<D> along = Trans(bend) * hit.normal;
    return 1 / length * (bend - hit.normal * Trans(along));
  }
};

/// The motion of a tool along its path, and by its unknowns.
template <int D>
class ToolPath {
  SomeTool<D> shape;
  std::vector<ToolMotion> motions;
  struct Drive {
    ToolDrive motion;
    int dof;
  };
  Array<Drive> drives;
  Array<unique_ptr<Watch>> watches;
  Placement<D> place;
  Array<double> loads;
  int version = 0;

public:
  ToolPath(const RigidTool & tool, const ProxyInfo & u)
      : shape(dynamic_pointer_cast<SignedDistance<D>>(tool.shape)), motions(tool.motions) {
    if (!shape)
      throw Exception("LACContact: obstacle is a tool in " + ToString(tool.shape->Dim()) +
                      "D, the mesh is in " + ToString(D) + "D");
    Array<shared_ptr<CoefficientFunction>> functions;
    shape->CollectFunctions(functions);
    for (auto & motion : motions)
      functions += Array<shared_ptr<CoefficientFunction>>{motion.shift, motion.angle};
    for (auto & drive : tool.drives) {
      ProxyInfo unknown(*drive.travel, "travel");
      if (unknown.fes != u.fes || unknown.component->GetNDof() != 1)
        throw Exception(
            "LACContact: the travel of a tool must be a trial function of a NumberSpace "
            "in the product space of u and lam");
      dofs.Append(unknown.offset * u.fes->GetDimension());
      if (dofs.Pos(dofs.Last()) + 1 < dofs.Size())
        throw Exception("LACContact: two motions of a tool are one unknown: give each a trial "
                        "function of a NumberSpace of its own");
      drives.Append(Drive{drive, dofs.Last()});
      functions.Append(drive.load);
    }
    for (auto & function : functions)
      if (function)
        watches.Append(make_unique<Watch>(function));
    Reevaluate();
  }

  /// Evaluates place and loads again if Parameters have changed them.
  void Reevaluate() {
    bool changed = version == 0;
    for (auto & watch : watches)
      watch->WhereChanged([&] { changed = true; });
    if (!changed)
      return;
    version++;
    place = Follow<D>(motions);
    loads.SetSize0();
    for (auto & drive : drives)
      loads.Append(drive.motion.load ? ValuesOf(*drive.motion.load)(0) : 0.0);
  }

  /// A number that changes whenever the values of Parameters do.
  int Version() const { return version; }
  ToolPosition<D> At(FlatVector<> x) const {
    ToolPosition<D> position(shape, place);
    Vec<D> way = 0.0;
    for (auto & drive : drives)
      if (int k = drive.motion.component; k >= 0)
        way(k) += x(drive.dof);
    for (auto & drive : drives) {
      auto & motion = drive.motion;
      if (motion.component >= 0) {
        Vec<D> linear = 0.0;
        linear(motion.component) = 1;
        position.dofs.Append(ToolDof<D>{drive.dof, linear, Mat<D, D>(0.0), false});
        continue;
      }
      Vec<D> center = place.ToSpace(FirstOf<D>(motion.center));
      position.place.Turn(Rotation<D>(x(drive.dof), motion.axis), center);
      Mat<D, D> spin = Spin<D>(motion.axis);
      Vec<D> linear = -1 * (spin * Vec<D>(center + way));
      position.dofs.Append(ToolDof<D>{drive.dof, linear, spin, true});
    }
    position.place.Shift(way);
    return position;
  }

  /// The dofs of the unknowns, in the order of ToolPosition::dofs.
  FlatArray<int> Dofs() const { return dofs; }
  /// Subtracts the loads on the tool.
  void AddLoads(FlatVector<> y) const {
    for (int i : Range(drives))
      y(drives[i].dof) -= loads[i];
  }

private:
  Array<int> dofs;
};
} // namespace ngslac
