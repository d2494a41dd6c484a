// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include "contact/kinematics.hpp"
#include "couplings.hpp"
#include "facepair.hpp"

namespace ngslac {
/// The split of the multiplier into pressure and tangential traction turns with the normal.
template <int D>
void AddStiffness(const Vec<D> & normal, const Vec<D> & traction, double pressure,
                  MacroRows<D> & rows) {
  for (int j : Range(rows.turning)) {
    int at = rows.Position(rows.turning[j]);
    Vec<D> turn = rows.normal.Col(at), tilt = rows.tilt.Col(at);
    double pressing = -InnerProduct(traction, turn);
    Vec<D> even = pressing * normal + pressure * (turn + tilt);
    for (int i : Range(rows.dofs))
      rows.stiffness(i, j) += pressing * rows.squeeze(i) - InnerProduct(even, rows.force.Col(i));
  }
}

/// A slave in the current configuration, and the slip along what it faces.
///
/// Areas, and with them the multipliers, count in the reference configuration. Between two calls of
/// Follow the points on the slave faces and their partners stay; the derivative is exact for that.
/// Moving the points, too, would change nothing but errors of quadrature, since what is integrated
/// is continuous across the edges of segments, except at the rim of the master. Tied surfaces keep
/// their partners, and what counts as their slip may have a part along the normal.
template <int D>
class MovingSliding : public Kinematics<D> {
  using Base = Kinematics<D>;

public:
  using Base::Base;

  void Start(shared_ptr<GridFunction>, FlatVector<> x, Meeting meeting) override {
    slave_reference = this->finder.Slave(nullptr);
    slave_shapes = make_unique<FaceShapes<D>>(u, *slave_reference, slave_reference->Degree());
    law->Reset();
    law->FindDofs(*slave_reference); // which determine what is closed
    Begin(x, meeting);
    Follow(x);
    reference.SetSize(Size()), last_gap.SetSize(Size());
    reference = Vec<D>(0.0);
    At(x);
    this->AdjustStart();
    for (size_t m : Range(last_gap))
      last_gap[m] = Place(m).gap;
    Accept();
  }

  void Follow(FlatVector<> x) override {
    static Timer timer("ngslac::MovingSliding::Follow");
    RegionTimer reg(timer);
    if (setup.tied && start)
      return;
    auto paired = PairAt(x);
    if (!paired)
      return;
    this->Take(std::move(*paired));
    surfaces.jump->fullarea = fullarea;
    points = MakePoints<D>(surfaces.pairing, *surfaces.slave, *space, surfaces.jump->area);
    if (start)
      LookBack(x);
  }

  /// Finds means, unless the configuration is still the same.
  void At(FlatVector<> x) override {
    auto scene = SceneAt(x);
    if (now && now->points == points && now->IsLike(*scene))
      return;
    now = scene;
    now->mean.SetSize(Size()), now->slip.SetSize(Size());
    ParallelFor(Size(), [&](size_t m) {
      if (points->area[m] > 0)
        now->mean[m] = now->MeanOf(m);
    });
    if (start)
      FindSlip();
  }

  MacroPlace<D> Place(size_t m) const override {
    double area = points->area[m], rowarea = surfaces.jump->RowArea(m);
    if (area == 0)
      return PlaceAt(surfaces.jump->normal[m], 0, Vec<D>(0.0), 0, rowarea);
    auto & mean = now->mean[m];
    Vec<D> slip = Slip(m);
    auto place = PlaceAt(mean.normal, mean.gap + law->Clearance(m), slip, area, rowarea);
    if (setup.tied)
      place.jump = slip;
    else if (surfaces.master)
      place.facing = mean.master;
    return place;
  }

  Array<GapRange<D>> GapRanges(FlatVector<>) const override {
    auto gap = [&](size_t m, const Segment & segment, const PairPoint<D> & p) {
      return law->Clearance(m) + now->GapAt(segment, p);
    };
    return GapRangesOf<D>(*space, surfaces, gap);
  }

  Vec<D - 1> Partner(size_t point) const override { return now->Partner(point); }
  PartnerMotion MovesOf(const Segment & segment, size_t point, LocalHeap & lh) const override {
    FacePair<D> faces(*slave_shapes, now->master_shapes, segment, lh);
    for (int j : Range(faces.at))
      faces.at[j] = faces.Dof(j);
    return {faces.at, now->PartnerMoves(faces, point, lh)};
  }

  void AddForces(size_t m, const Vec<D> & traction, Scatter & y, LocalHeap & lh) const override {
    if (points->area[m] > 0 && IsTraction(traction))
      now->AddForces(m, Parts(m, traction), y, lh);
  }
  pair<Vec<D>, Vec<3>> ResultantOf(size_t m, const Vec<D> & traction) const override {
    if (points->area[m] == 0 || !IsTraction(traction))
      return {Vec<D>(0.0), Vec<3>(0.0)};
    return now->Resultant(m, Parts(m, traction));
  }
  shared_ptr<SparseMatrix<double>> ZeroMatrix(FlatArray<Vec<D>> tractions, size_t n) override {
    Array<const MacroPoints<D> *> from(Size());
    for (size_t m : Range(from))
      from[m] = Slides(m) ? PairsOf(m).points.get() : nullptr;
    return couplings.Matrix<D>(*now, from, tractions, law->dofs, n);
  }

  PlaceRows<D> RowsOf(size_t m, const Vec<D> & traction, Rim rim, BlockSum & sum,
                      LocalHeap & lh) const override {
    if (points->area[m] == 0)
      return {};
    MacroRows<D> rows(couplings[m].dofs, couplings[m].turning);
    auto & mean = now->mean[m];
    auto parts = Parts(m, traction);
    now->AddDerivatives(m, parts, rim, rows, sum, lh);
    for (int j : Range(law->lean.Size() ? rows.dofs.Size() : 0))
      rows.squeeze(j) += InnerProduct(law->lean[m], rows.force.Col(j));
    if (!parts.IsZero()) {
      AddStiffness(mean.normal, traction, parts.pressure, rows);
      sum.Add(rows.dofs, rows.turning, std::move(rows.stiffness));
    }
    if (Slides(m)) {
      now->AddSlip(PairsOf(m), m, rows, lh);
      if (L2Norm2(Offset(m)) > 0)
        SubtractCarried<D>(*slave_shapes, *PairsOf(m).points, m, Offset(m), rows, lh);
    }
    if (!setup.tied)
      return rows.OfPlace(mean.normal, Slip(m), mean.gap + law->Clearance(m));
    PlaceRows<D> tied(rows.dofs);
    tied.jump = rows.slip;
    tied.force = points->area[m] * rows.slip;
    return tied;
  }

  /// In the present configuration, as forces act: of tied surfaces with the arms, so that rigid
  /// motions of both bodies do not change it. Tools count as they were paired, as their own rows
  /// do.
  MacroJump<D> & JumpWithRows() const override {
    if (!start || !now || now->points != points || !surfaces.master)
      return Base::JumpWithRows(); // nothing was evaluated yet, or a tool
    if (counted == now && surfaces.jump->HasRows())
      return *surfaces.jump;
    Array<Array<JumpEntry<D>>> rows(Size());
    LocalHeap heap(BlockHeap<D>(surfaces.slave->Degree()), "ngslac-jump", true);
    ParallelForRange(Size(), [&](IntRange range) {
      LocalHeap lh = heap.Split();
      for (auto m : range) {
        HeapReset hr(lh);
        std::map<int, Vec<D>> sums;
        for (int k : Range(D)) {
          Vec<D> unit = 0.0;
          unit(k) = 1;
          Scatter forces;
          AddForces(m, unit, forces, lh);
          for (auto [dof, work] : forces.Entries())
            sums.try_emplace(dof, 0.0).first->second(k) -= work;
        }
        for (auto & [dof, integral] : sums)
          rows[m].Append(JumpEntry<D>{dof, integral});
      }
    });
    surfaces.jump->TakeRows(rows);
    counted = now;
    return *surfaces.jump;
  }

  void Commit(FlatVector<> x, FlatArray<MacroState>, FlatArray<MacroState> states) override {
    for (size_t m : Range(setup.tied ? 0 : Size())) {
      auto & normal = Normal(m);
      Vec<D> slip = 0.0; // of the whole step, with the part before a touch
      if (Slides(m))
        slip = HasMet(m) ? Slip(m) : now->slip[m];
      slip -= InnerProduct(slip, normal) * normal;
      reference[m] = this->SlipBeforeTouch(states[m], last_gap[m] - states[m].gap, slip);
      reference[m] += law->ElasticSlip(m, normal, x);
      last_gap[m] = states[m].gap;
    }
    Accept();
  }

  void Restore() override {
    surfaces = accepted.surfaces;
    now = accepted.scene;
    points = start->points;
  }
  void Exchange(History & history) override {
    if (!setup.tied)
      history.Exchange("memory", last_gap);
    else if (history.reads)
      accepted.scene = now;
  }

protected:
  using Base::law, Base::reference, Base::setup, Base::Size, Base::space, Base::surfaces, Base::u;

  /// Makes what never changes; the slave's reference configuration exists already.
  virtual void Begin(FlatVector<> x, Meeting meeting) = 0;
  /// Pairs at x; nothing if that is as it was.
  virtual optional<Paired<D>> PairAt(FlatVector<> x) = 0;
  /// The configuration of x with the points of the last Follow.
  virtual shared_ptr<Scene<D>> SceneAt(FlatVector<> x) = 0;

  unique_ptr<Surface<D>> slave_reference;
  unique_ptr<FaceShapes<D>> slave_shapes;
  Array<double> fullarea;                  // in the reference configuration
  shared_ptr<const MacroPoints<D>> points; // of the last Follow
  shared_ptr<Scene<D>> now;                // of the last At
  struct {
    Paired<D> surfaces;
    shared_ptr<Scene<D>> scene;
  } accepted; // at the last Commit

private:
  void Accept() {
    start = now->Pairs();
    FindSlip();
    accepted = {surfaces, now};
  }
  void FindSlip() {
    ParallelFor(Size(), [&](size_t m) {
      if (Slides(m))
        now->slip[m] = now->SlipOf(PairsOf(m), m);
    });
  }

  /// How far those that have met the partner were from it at the last Commit.
  void LookBack(FlatVector<> x) {
    auto looks = [&](size_t m) { return HasMet(m) && Slides(m); };
    bool any = false;
    for (size_t m : Range(Size()))
      any = any || looks(m);
    if (!any)
      return;
    facing = SceneAt(x)->Pairs();
    auto & before = *accepted.scene;
    met.SetSize(Size());
    ParallelFor(Size(), [&](size_t m) {
      if (looks(m))
        met[m] = Carried<D>(before.slave, *surfaces.slave, *points, m, before.SlipOf(*facing, m));
    });
  }

  /// Nothing has slipped yet before the first Commit.
  bool Slides(size_t m) const {
    return start && points->area[m] > 0 && (setup.tied || law->Slides(m));
  }
  /// Did the partner come over it from the side?
  bool HasMet(size_t m) const { return start->points->area[m] == 0 && points->area[m] > 0; }
  /// The pairs by which slip counts: those that faced each other at the last Commit, or do so now.
  const SlipPairs<D> & PairsOf(size_t m) const { return HasMet(m) ? *facing : *start; }
  const Vec<D> & Offset(size_t m) const { return HasMet(m) ? met[m] : reference[m]; }
  /// Of this step; what an approaching macro-element moves until it touches is no slip.
  Vec<D> Slip(size_t m) const {
    if (!Slides(m))
      return Vec<D>(0.0);
    Vec<D> offset = Offset(m);
    if (L2Norm2(offset) > 0)
      offset = Carried<D>(now->slave, *PairsOf(m).points, m, offset);
    return now->slip[m] - offset;
  }

  /// The contact direction; without a partner that of the slave.
  const Vec<D> & Normal(size_t m) const {
    return points->area[m] > 0 ? now->mean[m].normal : surfaces.jump->normal[m];
  }
  MacroTraction<D> Parts(size_t m, const Vec<D> & traction) const {
    MacroTraction<D> parts(traction, now->mean[m]);
    if (law->lean.Size())
      parts.even -= parts.pressure * law->lean[m];
    return parts;
  }

  shared_ptr<const SlipPairs<D>> start;  // of the last Commit
  shared_ptr<const SlipPairs<D>> facing; // of the last Follow, if LookBack needs it
  Array<Vec<D>> met;                     // see LookBack
  Array<double> last_gap;                // at the last Commit
  Couplings couplings;                   // of the last ZeroMatrix
  mutable shared_ptr<Scene<D>> counted;  // the configuration of the rows of the jump
};
} // namespace ngslac
