// SPDX-License-Identifier: LGPL-2.1-or-later
#include "contact/bodycompliance.hpp"
#include "contact/periods.hpp"
#include "contact/selfcontact.hpp"
#include "movingsliding.hpp"
#include "tiescene.hpp"

namespace ngslac {
namespace {
template <int D>
double MeasureAt(const Surface<D> & surface, int face, const PairPoint<D> & p) {
  Vec<D> x;
  Mat<D, D - 1> dx;
  surface.Evaluate(face, p.slave, x, dx);
  return Measure(dx);
}

/// Makes the weights of a pairing in the current configuration those of areas in the reference one.
template <int D>
void CountReferenceAreas(const Surface<D> & reference, const Surface<D> & current,
                         Pairing<D> & pairing) {
  ParallelFor(pairing.Size(), [&](size_t s) {
    int face = pairing.segments[s].slave;
    for (auto & p : pairing.points.Range(pairing.Points(s)))
      p.weight *= MeasureAt(reference, face, p) / MeasureAt(current, face, p);
  });
  for (auto & r : pairing.rim)
    r.point.weight = MeasureAt(reference, pairing.segments[r.segment].slave, r.point);
}

/// Two surfaces.
template <int D>
class FiniteSliding : public MovingSliding<D> {
  using Base = MovingSliding<D>;
  using Base::accepted, Base::finder, Base::law, Base::now, Base::points, Base::setup,
      Base::slave_reference, Base::slave_shapes, Base::space, Base::surfaces, Base::u;

  unique_ptr<Surface<D>> master_reference;
  unique_ptr<FaceShapes<D>> master_shapes;
  Periods<D> periods;
  Array<int> along;             // macro-elements, for self-contact
  Meeting first = Meeting::now; // of the pairing of the start
  double share = 0.5;           // of the master in the stiffness of both bodies

public:
  using Base::Base;

  void LearnStiffness(FlatVector<> diagonal) override {
    if (!finder.IsSelfContact() && !setup.tied)
      share = MasterShare<D>(u, {*slave_shapes, *slave_reference},
                             {*master_shapes, *master_reference}, diagonal);
  }

  void Save(NamedNumbers & history) const override {
    Base::Save(history);
    if (!setup.tied)
      history["share"].Append(share);
  }
  void Load(const NamedNumbers & history) override {
    Base::Load(history);
    if (!setup.tied)
      share = history.at("share")[0];
  }

protected:
  void Begin(FlatVector<>, Meeting meeting) override {
    first = meeting;
    master_reference = finder.Master(nullptr);
    master_shapes = make_unique<FaceShapes<D>>(u, *master_reference, master_reference->Degree());
    periods = Periods<D>(u, *slave_reference, *master_reference, !setup.tied);
    Pairing<D> none;
    none.segments.Append(Segment{-1, -1, 0, 0});
    this->fullarea = MacroJump<D>(*space, *slave_reference, none).fullarea;
    if (finder.IsSelfContact())
      along = AlongSurface(*space);
  }

  optional<Paired<D>> PairAt(FlatVector<> x) override {
    auto slave = make_unique<Surface<D>>(slave_shapes->Displaced(*slave_reference, x));
    auto master = make_unique<Surface<D>>(master_shapes->Displaced(*master_reference, x));
    if (periods.Find(*slave, *master))
      AddImages(*master);
    auto margin = law->Margin();
    auto closed = finder.IsSelfContact() ? Closed(x) : BitArray(0);
    if (IsPairedIn(*slave, *master) && margin == surfaces.margin && closed == surfaces.closed)
      return nullopt;
    slave->CheckFinite();
    master->CheckFinite();
    auto paired =
        finder.Pair(std::move(slave), std::move(master), margin, points ? Meeting::later : first);
    paired.closed = closed;
    if (finder.IsSelfContact())
      KeepOneSide<D>(*paired.pairing, *paired.slave, *paired.master, *space, along, closed);
    CountReferenceAreas(*slave_reference, *paired.slave, *paired.pairing);
    return paired;
  }

  shared_ptr<Scene<D>> SceneAt(FlatVector<> x) override {
    auto make = [&](auto type, double weight) -> shared_ptr<Scene<D>> {
      return make_shared<typename decltype(type)::element_type>(
          *slave_shapes, *master_shapes, *slave_reference, *master_reference, weight, x, points);
    };
    return setup.tied ? make(shared_ptr<TieScene<D>>(), 0)
                      : make(shared_ptr<MeshScene<D>>(), share);
  }

private:
  /// To the master in all configurations, so that its faces have the same numbers.
  void AddImages(Surface<D> & master) {
    periods.Complete(master);
    periods.Complete(*master_reference, master_shapes.get());
    for (auto & scene : {now, accepted.scene})
      if (scene)
        periods.Complete(static_cast<MeshScene<D> &>(*scene).master);
    for (auto & kept : {surfaces.master, accepted.surfaces.master})
      if (kept)
        periods.Complete(*kept);
  }

  bool IsPairedIn(const Surface<D> & slave, const Surface<D> & master) const {
    return surfaces.jump && surfaces.slave->HasShapeOf(slave) &&
           surfaces.master->HasShapeOf(master);
  }

  BitArray Closed(FlatVector<> x) const {
    BitArray closed(space->NMacros());
    closed.Clear();
    for (size_t m : Range(law->dofs.Size() / D))
      if (L2Norm2(law->Multiplier(m, x)) > 0)
        closed.SetBit(m);
    return closed;
  }
};
} // namespace

template <int D>
unique_ptr<Kinematics<D>> MakeFiniteSliding(const ContactSetup & setup, shared_ptr<LACSpace> space,
                                            const ProxyInfo & u, shared_ptr<MacroLaw<D>> law) {
  return make_unique<FiniteSliding<D>>(setup, space, u, law);
}

#define INSTANTIATE(D)                                                                             \
  template unique_ptr<Kinematics<D>> MakeFiniteSliding(                                            \
      const ContactSetup &, shared_ptr<LACSpace>, const ProxyInfo &, shared_ptr<MacroLaw<D>>);
INSTANTIATE(2)
INSTANTIATE(3)
} // namespace ngslac
