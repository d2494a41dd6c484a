// SPDX-License-Identifier: LGPL-2.1-or-later
#include "contact/kinematics.hpp"
#include "contact/periods.hpp"
#include "couplings.hpp"
#include "forceblocks.hpp"
#include "referenceareas.hpp"
#include "tiemotion.hpp"

namespace ngslac {
namespace {
/// What is known of one configuration; macro-elements without a partner are left out.
template <int D>
struct TieMotion {
  MovingSurfaces<D> surfaces;
  Array<MacroTie<D>> mean;
};

/// Tied surfaces that move and deform by any amount; partners stay those of the last Start.
///
/// What vanishes is the mean of  x + g n - y : arms g n from the slave to the partners turn with
/// the slave's normals n. Rigid motions of both bodies only turn it, and the tractions do the work
/// of its change: the matrix is symmetric, and where it vanishes moments balance as forces do.
template <int D>
class FiniteTie : public Kinematics<D> {
  using Base = Kinematics<D>;
  using Base::finder, Base::law, Base::reference, Base::Size, Base::space, Base::surfaces, Base::u;

  unique_ptr<Surface<D>> slave_reference, master_reference;
  unique_ptr<FaceShapes<D>> slave_shapes, master_shapes;
  shared_ptr<const MacroPoints<D>> points;
  Couplings<D> couplings;            // of the last Linearize
  shared_ptr<TieMotion<D>> now;      // of the last At
  shared_ptr<TieMotion<D>> accepted; // at the last Commit

public:
  using Base::Base;

  void Start(shared_ptr<GridFunction>, FlatVector<> x, Meeting) override {
    slave_reference = finder.Slave(nullptr);
    master_reference = finder.Master(nullptr);
    slave_shapes = make_unique<FaceShapes<D>>(u, *slave_reference, slave_reference->Degree());
    master_shapes = make_unique<FaceShapes<D>>(u, *master_reference, master_reference->Degree());
    law->Reset();
    law->FindDofs(*slave_reference);
    auto slave = make_unique<Surface<D>>(slave_shapes->Displaced(*slave_reference, x));
    auto master = make_unique<Surface<D>>(master_shapes->Displaced(*master_reference, x));
    Periods<D> periods(u, *slave_reference, *master_reference, false);
    periods.Find(*slave, *master);
    periods.Complete(*master);
    periods.Complete(*master_reference, master_shapes.get());
    slave->CheckFinite();
    master->CheckFinite();
    auto paired = finder.Pair(std::move(slave), std::move(master), law->Margin());
    CountReferenceAreas(*slave_reference, *paired.slave, *paired.pairing);
    this->Take(paired);
    points = MakePoints<D>(surfaces.pairing, *surfaces.slave, *space, surfaces.jump->area);
    reference.SetSize(Size());
    reference = Vec<D>(0.0);
    At(x);
    accepted = now;
  }

  void At(FlatVector<> x) override {
    auto slave = slave_shapes->Displaced(*slave_reference, x);
    auto master = master_shapes->Displaced(*master_reference, x);
    if (now && now->surfaces.slave.HasShapeOf(slave) && now->surfaces.master.HasShapeOf(master))
      return;
    now = make_shared<TieMotion<D>>(
        TieMotion<D>{{*slave_shapes, *master_shapes, std::move(slave), std::move(master), 0.0},
                     Array<MacroTie<D>>(Size())});
    ParallelFor(Size(), [&](size_t m) {
      if (points->area[m] > 0)
        now->mean[m] = MeanTie<D>(now->surfaces, *points, m);
    });
  }

  MacroPlace<D> Place(size_t m) const override {
    auto & jump = *surfaces.jump;
    Vec<D> none = 0.0;
    if (points->area[m] == 0)
      return {jump.normal[m], 0, none, none, 0, jump.RowArea(m)};
    auto & [apart, normal, gap] = now->mean[m];
    Vec<D> slip = apart - InnerProduct(apart, normal) * normal;
    return {normal, gap, slip, apart, points->area[m], jump.RowArea(m)};
  }

  void AddForces(size_t m, const Vec<D> & traction, Scatter & y, LocalHeap & lh) const override {
    if (points->area[m] == 0 || !IsTraction(traction))
      return;
    auto coupling = CouplingAt(m);
    auto rows = TieRows(m, coupling, Vec<D>(0.0), lh);
    for (int j : Range(rows.dofs))
      y.Add(rows.dofs[j], -points->area[m] * InnerProduct(traction, Vec<D>(rows.slip.Col(j))));
  }

  pair<Vec<D>, Vec<3>> ResultantOf(size_t m, const Vec<D> & traction) const override {
    if (points->area[m] == 0)
      return {Vec<D>(0.0), Vec<3>(0.0)};
    return TieResultant<D>(now->surfaces, *points, m, traction);
  }

  shared_ptr<SparseMatrix<double>> ZeroMatrix(FlatArray<Vec<D>> tractions, size_t n) override {
    return couplings.Matrix(Size(), *master_shapes, law->dofs, n, [&](size_t m, Coupling & own) {
      return UpdateCoupling<D>(*slave_shapes, *master_shapes, *points, nullptr, m,
                               IsTraction(tractions[m]), own);
    });
  }

  PlaceRows<D> RowsOf(size_t m, const Vec<D> & traction, Rim, BlockSum & stiffness,
                      LocalHeap & lh) const override {
    if (points->area[m] == 0)
      return {};
    auto rows = TieRows(m, couplings[m], traction, lh);
    if (IsTraction(traction))
      stiffness.Add(rows.dofs, rows.turning, std::move(rows.stiffness));
    PlaceRows<D> result(rows.dofs);
    result.jump = rows.slip;
    result.force = points->area[m] * rows.slip;
    return result;
  }

  /// In the present configuration, and with the arms: rigid motions of both bodies do not change
  /// it.
  MacroJump<D> & JumpWithRows() const override {
    Array<Array<JumpEntry<D>>> entries(Size());
    LocalHeap heap(BlockHeap<D>(surfaces.slave->Degree()), "ngslac-tie", true);
    ParallelForRange(Size(), [&](IntRange range) {
      LocalHeap lh = heap.Split();
      for (auto m : range) {
        auto coupling = CouplingAt(m);
        if (points->area[m] == 0)
          continue;
        auto rows = TieRows(m, coupling, Vec<D>(0.0), lh);
        for (int j : Range(rows.dofs))
          entries[m].Append(JumpEntry<D>{rows.dofs[j], points->area[m] * Vec<D>(rows.slip.Col(j))});
      }
    });
    surfaces.jump->TakeRows(entries);
    return *surfaces.jump;
  }

  void Commit(FlatVector<>, FlatArray<MacroState>, FlatArray<MacroState>) override {
    accepted = now;
  }
  void Restore() override { now = accepted; }
  void Save(NamedNumbers &) const override {}
  void Load(const NamedNumbers &) override { accepted = now; }

private:
  Coupling CouplingAt(size_t m) const {
    Coupling coupling;
    UpdateCoupling<D>(*slave_shapes, *master_shapes, *points, nullptr, m, false, coupling);
    return coupling;
  }

  MacroRows<D> TieRows(size_t m, const Coupling & coupling, const Vec<D> & traction,
                       LocalHeap & lh) const {
    MacroRows<D> rows(coupling.dofs, coupling.turning);
    AddTie<D>(now->surfaces, *points, m, traction, rows, lh);
    return rows;
  }
};
} // namespace

template <int D>
unique_ptr<Kinematics<D>> MakeFiniteTie(const ContactSetup & setup, shared_ptr<LACSpace> space,
                                        const ProxyInfo & u, shared_ptr<MacroLaw<D>> law) {
  return make_unique<FiniteTie<D>>(setup, space, u, law);
}

#define INSTANTIATE(D)                                                                             \
  template unique_ptr<Kinematics<D>> MakeFiniteTie(const ContactSetup &, shared_ptr<LACSpace>,     \
                                                   const ProxyInfo &, shared_ptr<MacroLaw<D>>);
INSTANTIATE(2)
INSTANTIATE(3)
} // namespace ngslac
