// SPDX-License-Identifier: LGPL-2.1-or-later
#include "contact/bodycompliance.hpp"
#include "contact/kinematics.hpp"
#include "contact/periods.hpp"
#include "contact/selfcontact.hpp"
#include "couplings.hpp"
#include "forceblocks.hpp"
#include "referenceareas.hpp"

namespace ngslac {
namespace {
/// What is known of one configuration; macro-elements without a partner are left out.
template <int D>
struct Motion {
  MovingSurfaces<D> surfaces;
  shared_ptr<const MacroPoints<D>> points, start;
  Array<RayHit<D>> hits; // of the points
  Array<MacroGap<D>> mean;
  Array<Vec<D>> slip; // since the start, of macro-elements that slide
};

/// Partners, gap, slip, normals and forces are those of the current configuration.
///
/// Areas, and with them the multipliers, count in the reference configuration. Between two calls of
/// Follow the points on the slave faces and their master faces stay; the derivative is exact for
/// that. Moving the points, too, would change nothing but errors of quadrature, since what is
/// integrated is continuous across the edges of segments, except at the rim of the master.
template <int D>
class FiniteSliding : public Kinematics<D> {
  using Base = Kinematics<D>;
  using Base::finder, Base::law, Base::reference, Base::Size, Base::space, Base::surfaces, Base::u;

  unique_ptr<Surface<D>> slave_reference, master_reference;
  unique_ptr<FaceShapes<D>> slave_shapes, master_shapes;
  Periods<D> periods;
  Array<int> along;                        // macro-elements, for self-contact
  Array<double> fullarea;                  // in the reference configuration
  shared_ptr<const MacroPoints<D>> points; // of the last Follow
  shared_ptr<const MacroPoints<D>> start;  // of the last Commit: slip counts from there
  Array<Vec<D>> met;                       // see LookBack
  Array<double> last_gap;                  // at the last Commit
  Meeting first = Meeting::now;            // of the pairing of the start
  SearchMargin searched;                   // in the last Follow
  BitArray closed;                         // in the last Follow, for self-contact
  shared_ptr<Motion<D>> now;               // of the last At
  double share = 0.5;                      // of the master in the stiffness of both bodies
  Couplings<D> couplings;                  // of the last Linearize
  Array<Vec<D>> lean;                      // of the pressures of macro-elements; empty: none
  struct {
    Paired<D> surfaces;
    shared_ptr<Motion<D>> motion;
    SearchMargin searched;
    BitArray closed;
  } accepted; // at the last Commit

public:
  using Base::Base;

  void Start(shared_ptr<GridFunction>, FlatVector<> x, Meeting meeting) override {
    first = meeting;
    slave_reference = finder.Slave(nullptr);
    master_reference = finder.Master(nullptr);
    slave_shapes = make_unique<FaceShapes<D>>(u, *slave_reference, slave_reference->Degree());
    master_shapes = make_unique<FaceShapes<D>>(u, *master_reference, master_reference->Degree());
    periods = Periods<D>(u, *slave_reference, *master_reference, true);
    Pairing<D> none;
    none.segments.Append(Segment{-1, -1, 0, 0});
    fullarea = MacroJump<D>(*space, *slave_reference, none).fullarea;
    if (finder.IsSelfContact())
      along = AlongSurface(*space);
    law->Reset();
    law->FindDofs(*slave_reference); // which tell what is closed
    Follow(x);
    start = points;
    reference.SetSize(Size()), last_gap.SetSize(Size());
    reference = Vec<D>(0.0);
    At(x);
    this->AdjustStart();
    for (size_t m : Range(last_gap))
      last_gap[m] = Place(m).gap;
    Accept();
  }

  void LearnStiffness(FlatVector<> diagonal) override {
    if (!finder.IsSelfContact())
      share = MasterShare<D>(u, {*slave_shapes, *slave_reference},
                             {*master_shapes, *master_reference}, diagonal);
  }

  void Save(NamedNumbers & history) const override {
    history["memory"] = last_gap;
    history["share"].Append(share);
  }
  void Load(const NamedNumbers & history) override {
    last_gap = history.at("memory");
    share = history.at("share")[0];
  }

  void Follow(FlatVector<> x) override {
    static Timer timer("ngslac::FiniteSliding::Follow");
    RegionTimer reg(timer);
    auto slave = make_unique<Surface<D>>(slave_shapes->Displaced(*slave_reference, x));
    auto master = make_unique<Surface<D>>(master_shapes->Displaced(*master_reference, x));
    if (periods.Find(*slave, *master))
      AddImages(*master);
    auto margin = law->Margin();
    auto closed_now = finder.IsSelfContact() ? Closed(x) : BitArray(0);
    if (IsPairedIn(*slave, *master) && margin == searched && closed_now == closed)
      return;
    slave->CheckFinite();
    master->CheckFinite();
    auto paired =
        finder.Pair(std::move(slave), std::move(master), margin, start ? Meeting::later : first);
    searched = margin;
    closed = closed_now;
    if (finder.IsSelfContact())
      KeepOneSide<D>(*paired.pairing, *paired.slave, *paired.master, *space, along, closed);
    CountReferenceAreas(*slave_reference, *paired.slave, *paired.pairing);
    this->Take(paired);
    surfaces.jump->fullarea = fullarea;
    points = MakePoints<D>(surfaces.pairing, *surfaces.slave, *space, surfaces.jump->area);
    if (start)
      LookBack();
  }

  /// Finds rays and means, unless the configuration is still the same.
  void At(FlatVector<> x) override {
    auto slave = slave_shapes->Displaced(*slave_reference, x);
    auto master = master_shapes->Displaced(*master_reference, x);
    bool same = now && now->points == points && now->surfaces.share == share &&
                now->surfaces.slave.HasShapeOf(slave) && now->surfaces.master.HasShapeOf(master);
    if (same && now->start == start)
      return;
    if (!same) {
      bool reuse = now && now != accepted.motion; // the memory
      auto hits = reuse ? std::move(now->hits) : Array<RayHit<D>>();
      hits.SetSize(points->pairing->points.Size());
      now = make_shared<Motion<D>>(
          Motion<D>{{*slave_shapes, *master_shapes, std::move(slave), std::move(master), share},
                    points,
                    start,
                    std::move(hits),
                    Array<MacroGap<D>>(Size()),
                    Array<Vec<D>>(Size())});
    }
    now->start = start;
    ParallelFor(Size(), [&](size_t m) {
      if (points->area[m] == 0)
        return;
      if (!same)
        now->mean[m] = MeanGap<D>(now->surfaces, *points, m, now->hits);
      if (Slides(m))
        now->slip[m] = MeanSlip<D>(now->surfaces, SlipPoints(m), m);
    });
  }

  MacroPlace<D> Place(size_t m) const override {
    double area = points->area[m], rowarea = surfaces.jump->RowArea(m);
    if (area == 0)
      return PlaceAt(surfaces.jump->normal[m], 0, Vec<D>(0.0), 0, rowarea);
    auto & mean = now->mean[m];
    Vec<D> slip = Slides(m) ? Slip(m) : Vec<D>(0.0);
    return PlaceAt(mean.normal, mean.gap + law->Clearance(m), slip, area, rowarea);
  }

  void AddForces(size_t m, const Vec<D> & traction, Scatter & y, LocalHeap & lh) const override {
    if (points->area[m] > 0 && IsTraction(traction))
      AddTraction<D>(now->surfaces, *points, m, now->hits, Parts(m, traction), y, lh);
  }

  Vec<D> FacingNormal(size_t m) const override {
    return points->area[m] > 0 ? now->mean[m].master : Vec<D>(0.0);
  }

  void Lean(FlatArray<double> vectors) override {
    lean.SetSize(vectors.Size() / D);
    for (size_t i : Range(vectors))
      lean[i / D](i % D) = vectors[i];
  }

  pair<Vec<D>, Vec<3>> ResultantOf(size_t m, const Vec<D> & traction) const override {
    if (points->area[m] == 0 || !IsTraction(traction))
      return {Vec<D>(0.0), Vec<3>(0.0)};
    return Resultant<D>(now->surfaces.slave, *points, m, Parts(m, traction));
  }

  shared_ptr<SparseMatrix<double>> ZeroMatrix(FlatArray<Vec<D>> tractions, size_t n) override {
    return couplings.Matrix(Size(), *master_shapes, law->dofs, n, [&](size_t m, Coupling & own) {
      return UpdateCoupling<D>(*slave_shapes, *master_shapes, *points,
                               Slides(m) ? &SlipPoints(m) : nullptr, m, IsTraction(tractions[m]),
                               own);
    });
  }

  PlaceRows<D> RowsOf(size_t m, const Vec<D> & traction, Rim rim, BlockSum & sum,
                      LocalHeap & lh) const override {
    if (points->area[m] == 0)
      return {};
    MacroRows<D> rows(couplings[m].dofs, couplings[m].turning);
    AddMotion(m, traction, rim, rows, sum, lh);
    auto & mean = now->mean[m];
    Vec<D> slip = Slides(m) ? Slip(m) : Vec<D>(0.0);
    return rows.OfPlace(mean.normal, slip, mean.gap + law->Clearance(m));
  }

  void Commit(FlatVector<> x, FlatArray<MacroState>, FlatArray<MacroState> states) override {
    for (size_t m : Range(Size())) {
      auto & normal = Normal(m);
      double approach = last_gap[m] - states[m].gap;
      Vec<D> slip = 0.0; // of all the step, what came before a touch included
      if (Slides(m))
        slip = HasMet(m) ? Slip(m) : now->slip[m];
      slip -= InnerProduct(slip, normal) * normal;
      reference[m] = this->SlipBeforeTouch(states[m], approach, slip);
      reference[m] += law->ElasticSlip(m, normal, x);
      last_gap[m] = states[m].gap;
    }
    Accept();
  }

  void Restore() override {
    surfaces = accepted.surfaces;
    now = accepted.motion;
    searched = accepted.searched;
    closed = accepted.closed;
    points = start;
  }

private:
  /// To the master in all configurations, so that its faces have the same numbers.
  void AddImages(Surface<D> & master) {
    periods.Complete(master);
    periods.Complete(*master_reference, master_shapes.get());
    for (auto & motion : {now, accepted.motion})
      if (motion)
        periods.Complete(motion->surfaces.master);
    for (auto & paired : {surfaces.master, accepted.surfaces.master})
      if (paired)
        periods.Complete(*paired);
  }

  void Accept() {
    accepted = {surfaces, now, searched, closed};
    start = points;
  }

  bool Slides(size_t m) const { return points->area[m] > 0 && law->Slides(m); }

  /// Did the master come over it from the side?
  bool HasMet(size_t m) const { return start->area[m] == 0 && points->area[m] > 0; }
  /// That slip counts of: pairs that faced each other at the last Commit, or do so now.
  const MacroPoints<D> & SlipPoints(size_t m) const { return HasMet(m) ? *points : *start; }

  /// How far those that have met the master were from their partners at the last Commit.
  void LookBack() {
    auto & before = accepted.motion->surfaces;
    met.SetSize(Size());
    ParallelFor(Size(), [&](size_t m) {
      if (HasMet(m) && Slides(m))
        met[m] =
            Carried<D>(before.slave, *surfaces.slave, *points, m, MeanSlip<D>(before, *points, m));
    });
  }

  /// The contact direction; without a partner that of the slave.
  const Vec<D> & Normal(size_t m) const {
    return points->area[m] > 0 ? now->mean[m].normal : surfaces.jump->normal[m];
  }

  MacroTraction<D> Parts(size_t m, const Vec<D> & traction) const {
    MacroTraction<D> parts(traction, now->mean[m]);
    if (lean.Size())
      parts.even -= parts.pressure * lean[m];
    return parts;
  }

  const Vec<D> & Offset(size_t m) const { return HasMet(m) ? met[m] : reference[m]; }

  /// Of this step; what an approaching macro-element moves until it touches is no slip.
  Vec<D> Slip(size_t m) const {
    Vec<D> offset = Offset(m);
    if (L2Norm2(offset) > 0)
      offset = Carried<D>(now->surfaces.slave, SlipPoints(m), m, offset);
    return now->slip[m] - offset;
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

  /// Derivatives of what moves with a macro-element, and of its forces under a fixed traction.
  void AddMotion(size_t m, const Vec<D> & traction, Rim rim, MacroRows<D> & rows, BlockSum & sum,
                 LocalHeap & lh) const {
    auto add = [&](FlatArray<int> masters, FlatMatrix<> block) { AddBlock(masters, block, sum); };
    auto & mean = now->mean[m];
    auto parts = Parts(m, traction);
    AddDerivatives<D>(now->surfaces, *points, m, now->hits, mean, parts, rim == Rim::moves, rows,
                      add, lh);
    for (int j : Range(lean.Size() ? rows.dofs.Size() : 0))
      rows.squeeze(j) += InnerProduct(lean[m], rows.force.Col(j));
    if (!parts.IsZero())
      AddStiffness(mean.normal, traction, parts.pressure, rows, sum);
    if (!Slides(m))
      return;
    AddSlip<D>(now->surfaces, SlipPoints(m), m, rows, lh);
    if (L2Norm2(Offset(m)) > 0)
      SubtractCarried<D>(*slave_shapes, SlipPoints(m), m, Offset(m), rows, lh);
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
