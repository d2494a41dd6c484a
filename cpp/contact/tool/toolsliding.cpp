// SPDX-License-Identifier: LGPL-2.1-or-later
#include "contact/finite/movingsliding.hpp"
#include "toolscene.hpp"

namespace ngslac {
namespace {
/// A rigid tool.
///
/// The points on the slave faces never change; which of them face the tool does.
template <int D>
class ToolSliding : public MovingSliding<D> {
  using Base = MovingSliding<D>;
  using Base::setup, Base::slave_reference, Base::slave_shapes, Base::space, Base::u;

  shared_ptr<ToolPath<D>> path;
  shared_ptr<Pairing<D>> all; // points, with all their weights

public:
  explicit ToolSliding(const KinematicsParts<D> & parts) : Base(parts), path(parts.path) {}

  void LearnStiffness(FlatVector<>) override {} // a tool is the stiffer one

protected:
  void Begin(FlatVector<> x, Meeting meeting) override {
    int degree = u.Order(*slave_reference) + 2 * (slave_reference->Degree() - 1);
    all = AllPoints<D>(*slave_reference, 2 * degree);
    this->fullarea = MacroJump<D>(*space, *slave_reference, *all).area;
    if (meeting == Meeting::now && setup.active)
      CheckSideOfTool<D>(*MakeScene(x), *all, setup.maxdist);
  }

  optional<Paired<D>> PairAt(FlatVector<> x) override {
    auto scene = MakeScene(x);
    scene->slave.CheckFinite();
    Paired<D> paired{make_shared<Surface<D>>(scene->slave), nullptr, FacingPoints<D>(*all, *scene)};
    paired.unknowns = scene->tool.dofs;
    return paired;
  }

  shared_ptr<Scene<D>> SceneAt(FlatVector<> x) override { return MakeScene(x); }

private:
  shared_ptr<ToolScene<D>> MakeScene(FlatVector<> x) const {
    path->Reevaluate();
    return make_shared<ToolScene<D>>(*slave_shapes, *slave_reference, *path, x, this->points);
  }
};
} // namespace

template <int D>
unique_ptr<Kinematics<D>> MakeToolSliding(const KinematicsParts<D> & parts) {
  if (!parts.setup.finite || parts.setup.tied)
    throw Exception("LACContact: a tool in space needs finite=True, and no tied surfaces");
  return make_unique<ToolSliding<D>>(parts);
}

template unique_ptr<Kinematics<2>> MakeToolSliding(const KinematicsParts<2> &);
template unique_ptr<Kinematics<3>> MakeToolSliding(const KinematicsParts<3> &);
} // namespace ngslac
