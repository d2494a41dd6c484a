// SPDX-License-Identifier: LGPL-2.1-or-later
#include "movingsliding.hpp"

namespace ngslac {
template <int D>
void MovingSliding<D>::Start(shared_ptr<GridFunction>, FlatVector<> x, Meeting meeting) {
  slave_reference = this->finder.Slave(nullptr);
  slave_shapes = make_unique<FaceShapes<D>>(u, *slave_reference, slave_reference->Degree());
  law->Reset();
  law->FindDofs(*slave_reference); // which tell what is closed
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

template <int D>
void MovingSliding<D>::Follow(FlatVector<> x) {
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

template <int D>
void MovingSliding<D>::At(FlatVector<> x) {
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

template <int D>
void MovingSliding<D>::FindSlip() {
  ParallelFor(Size(), [&](size_t m) {
    if (Slides(m))
      now->slip[m] = now->SlipOf(PairsOf(m), m);
  });
}

template <int D>
void MovingSliding<D>::LookBack(FlatVector<> x) {
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

template <int D>
Vec<D> MovingSliding<D>::Slip(size_t m) const {
  if (!Slides(m))
    return Vec<D>(0.0);
  Vec<D> offset = Offset(m);
  if (L2Norm2(offset) > 0)
    offset = Carried<D>(now->slave, *PairsOf(m).points, m, offset);
  return now->slip[m] - offset;
}

template <int D>
MacroPlace<D> MovingSliding<D>::Place(size_t m) const {
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

template <int D>
Array<GapRange<D>> MovingSliding<D>::GapRanges(FlatVector<>) const {
  auto gap = [&](size_t m, const Segment & segment, const PairPoint<D> & p) {
    return law->Clearance(m) + now->GapAt(segment, p);
  };
  return GapRangesOf<D>(*space, surfaces, gap);
}

template <int D>
MacroTraction<D> MovingSliding<D>::Parts(size_t m, const Vec<D> & traction) const {
  MacroTraction<D> parts(traction, now->mean[m]);
  if (law->lean.Size())
    parts.even -= parts.pressure * law->lean[m];
  return parts;
}

template <int D>
void MovingSliding<D>::AddForces(size_t m, const Vec<D> & traction, Scatter & y,
                                 LocalHeap & lh) const {
  if (points->area[m] > 0 && IsTraction(traction))
    now->AddForces(m, Parts(m, traction), y, lh);
}

template <int D>
pair<Vec<D>, Vec<3>> MovingSliding<D>::ResultantOf(size_t m, const Vec<D> & traction) const {
  if (points->area[m] == 0 || !IsTraction(traction))
    return {Vec<D>(0.0), Vec<3>(0.0)};
  return now->Resultant(m, Parts(m, traction));
}

template <int D>
shared_ptr<SparseMatrix<double>> MovingSliding<D>::ZeroMatrix(FlatArray<Vec<D>> tractions,
                                                              size_t n) {
  Array<const MacroPoints<D> *> from(Size());
  for (size_t m : Range(from))
    from[m] = Slides(m) ? PairsOf(m).points.get() : nullptr;
  return couplings.Matrix<D>(*now, from, tractions, law->dofs, n);
}

namespace {
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
} // namespace

template <int D>
PlaceRows<D> MovingSliding<D>::RowsOf(size_t m, const Vec<D> & traction, Rim rim, BlockSum & sum,
                                      LocalHeap & lh) const {
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
/// motions of both bodies do not change it. Tools count as they were paired, as their own rows do.
template <int D>
MacroJump<D> & MovingSliding<D>::JumpWithRows() const {
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

template <int D>
void MovingSliding<D>::Commit(FlatVector<> x, FlatArray<MacroState>, FlatArray<MacroState> states) {
  for (size_t m : Range(setup.tied ? 0 : Size())) {
    auto & normal = Normal(m);
    Vec<D> slip = 0.0; // of all the step, what came before a touch included
    if (Slides(m))
      slip = HasMet(m) ? Slip(m) : now->slip[m];
    slip -= InnerProduct(slip, normal) * normal;
    reference[m] = this->SlipBeforeTouch(states[m], last_gap[m] - states[m].gap, slip);
    reference[m] += law->ElasticSlip(m, normal, x);
    last_gap[m] = states[m].gap;
  }
  Accept();
}

template <int D>
void MovingSliding<D>::Accept() {
  start = now->Pairs();
  FindSlip();
  accepted = {surfaces, now};
}

template <int D>
void MovingSliding<D>::Restore() {
  surfaces = accepted.surfaces;
  now = accepted.scene;
  points = start->points;
}

template <int D>
void MovingSliding<D>::Save(NamedNumbers & history) const {
  if (!setup.tied)
    history["memory"] = last_gap;
}

template <int D>
void MovingSliding<D>::Load(const NamedNumbers & history) {
  if (setup.tied)
    accepted.scene = now;
  else
    last_gap = history.at("memory");
}

template class MovingSliding<2>;
template class MovingSliding<3>;
} // namespace ngslac
