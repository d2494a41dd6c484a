// SPDX-License-Identifier: LGPL-2.1-or-later
#include "toolpath.hpp"

namespace ngslac {
template <int D>
ToolHit<D> ToolPosition<D>::At(const Vec<D> & x) const {
  auto [there, rest] = place.ToToolWithRest(x);
  auto near = shape->At(there);
  Vec<D> gradient = place.turn * near.gradient;
  double length = L2Norm(gradient);
  return {near.distance + InnerProduct(near.gradient, rest), gradient,
          length > 0 ? Vec<D>(1 / length * gradient) : Vec<D>(0.0)};
}

template <int D>
Mat<D, D> ToolPosition<D>::Bend(const Vec<D> & x, const ToolHit<D> & hit) const {
  double length = L2Norm(hit.gradient);
  if (length == 0)
    return Mat<D, D>(0.0);
  Mat<D, D> second = shape->Hessian(place.ToTool(x));
  Mat<D, D> bend = place.turn * Mat<D, D>(second * Trans(place.turn));
  Vec<D> along = Trans(bend) * hit.normal;
  return 1 / length * (bend - hit.normal * Trans(along));
}

template <int D>
ToolPath<D>::ToolPath(const RigidTool & tool, const ProxyInfo & u)
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
      throw Exception("LACContact: the travel of a tool must be a trial function of a NumberSpace "
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

template <int D>
void ToolPath<D>::Reevaluate() {
  bool changed = version == 0;
  for (auto & watch : watches)
    watch->WhereChanged([&] { changed = true; });
  if (!changed)
    return;
  version++;
  place = Follow<D>(motions);
  loads.SetSize0();
  for (auto & drive : drives)
    loads.Append(drive.given.load ? ValuesOf(*drive.given.load)(0) : 0.0);
}

template <int D>
ToolPosition<D> ToolPath<D>::At(FlatVector<> x) const {
  ToolPosition<D> position(shape, place);
  Vec<D> way = 0.0;
  for (auto & drive : drives)
    if (int k = drive.given.component; k >= 0)
      way(k) += x(drive.dof);
  for (auto & drive : drives) {
    auto & given = drive.given;
    if (given.component >= 0) {
      Vec<D> linear = 0.0;
      linear(given.component) = 1;
      position.dofs.Append(ToolDof<D>{drive.dof, linear, Mat<D, D>(0.0), false});
      continue;
    }
    Vec<D> center = place.ToSpace(FirstOf<D>(given.center));
    position.place.Turn(Rotation<D>(x(drive.dof), given.axis), center);
    Mat<D, D> spin = Spin<D>(given.axis);
    Vec<D> linear = -1 * (spin * Vec<D>(center + way));
    position.dofs.Append(ToolDof<D>{drive.dof, linear, spin, true});
  }
  position.place.Shift(way);
  return position;
}

template <int D>
void ToolPath<D>::AddLoads(FlatVector<> y) const {
  for (int i : Range(drives))
    y(drives[i].dof) -= loads[i];
}

template class ToolPosition<2>;
template class ToolPosition<3>;
template class ToolPath<2>;
template class ToolPath<3>;
} // namespace ngslac
