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
  ToolSliding(const ContactSetup & setup, shared_ptr<LACSpace> space, const ProxyInfo & u,
              shared_ptr<MacroLaw<D>> law, shared_ptr<ToolPath<D>> apath)
      : Base(setup, space, u, law), path(apath) {}

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
unique_ptr<Kinematics<D>> MakeToolSliding(const ContactSetup & setup, shared_ptr<LACSpace> space,
                                          const ProxyInfo & u, shared_ptr<MacroLaw<D>> law,
                                          shared_ptr<ToolPath<D>> path) {
  if (!setup.finite || setup.tied)
    throw Exception("LACContact: a tool in space needs finite=True, and no tied surfaces");
  return make_unique<ToolSliding<D>>(setup, space, u, law, path);
}

#define INSTANTIATE(D)                                                                             \
  template unique_ptr<Kinematics<D>> MakeToolSliding(const ContactSetup &, shared_ptr<LACSpace>,   \
                                                     const ProxyInfo &, shared_ptr<MacroLaw<D>>,   \
                                                     shared_ptr<ToolPath<D>>);
INSTANTIATE(2)
INSTANTIATE(3)
} // namespace ngslac
