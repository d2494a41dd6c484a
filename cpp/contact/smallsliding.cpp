// SPDX-License-Identifier: LGPL-2.1-or-later
#include "bodycompliance.hpp"
#include "direction.hpp"
#include "macroends.hpp"
#include "periods.hpp"

namespace ngslac {
namespace {
/// Partners, weights and directions stay those of the last Start; gap and slip are linear.
template <int D>
class SmallSliding : public Kinematics<D> {
  using Base = Kinematics<D>;
  using Base::law, Base::reference, Base::setup, Base::surfaces, Base::u;

  Watch watch_obstacle{setup.obstacle};
  shared_ptr<SparseMatrix<double>> mat;
  bool has_forces = false, keeps_forces = false; // their columns in the matrix, which do not change
  Array<Vec<D>> mean;                            // of u1 - u2 at the last At
  Array<Vec<D>> gapvector;                       // mean of x1 - x2 at u = 0
  Array<Vec<D>> slave_normal, master_normal;     // means over the paired part
  double share = 0.5;                            // of the master in the stiffness of both bodies
  Array<Vec<D>> direction;                       // in which macro-elements and their partners push
  Array<Vec<D>> committed;                       // mean of u1 - u2 at the last committed step
  Array<Vec<D>> tied; // mean of x1 - x2 at the last Start, which tied surfaces keep
  Vector<> paired_at; // displacements that gaps are counted from
  MacroEnds<D> ends;  // macro-elements that contact ends in
  struct {
    shared_ptr<Pairing<D>> pairing;
    Array<Vec<D>> gapvector;
    Array<double> ends;
  } accepted; // at the last committed step

public:
  using Base::Base;

  void Start(shared_ptr<GridFunction> gf, FlatVector<> x, Meeting) override {
    shared_ptr<CoefficientFunction> displacement;
    if (gf && !setup.obstacle) // an obstacle is given by its gap in the reference configuration
      displacement = make_shared<GridFunctionCoefficientFunction>(gf, nullptr, u.evaluator);
    auto & finder = this->finder;
    law->Reset();
    auto slave = finder.Slave(displacement), master = finder.Master(displacement);
    if (master)
      AddImages(*slave, *master);
    this->Take(finder.Pair(std::move(slave), std::move(master), law->Margin()));
    law->FindDofs(*surfaces.slave);
    auto & jump = this->JumpWithRows();
    if (!setup.obstacle) {
      slave_normal = jump.SlaveNormals(*surfaces.pairing);
      master_normal = jump.MasterNormals(*surfaces.master, *surfaces.pairing);
      gapvector = jump.GapVectors(*surfaces.pairing);
    }
    paired_at.SetSize(x.Size());
    paired_at = displacement ? 1.0 : 0.0;
    for (size_t i : Range(x))
      paired_at(i) *= x(i);
    SetDirections();
    LookAtObstacle();
    committed.SetSize(jump.Size()), mean.SetSize(jump.Size());
    for (size_t m : Range(committed)) {
      committed[m] = jump.Mean(m, x);
      if (displacement) // the gap is linear in u, counted from the paired configuration
        gapvector[m] -= committed[m];
    }
    reference = tied = committed;
    for (size_t m : Range(tied))
      tied[m] += gapvector[m];
    At(x);
    this->AdjustStart();
    At(x);
    Accept();
    mat = ngslac::ZeroMatrix(x.Size(), Graph());
  }

  void Follow(FlatVector<>) override {}

  void At(FlatVector<> x) override {
    LookAtObstacle();
    ParallelFor(this->Size(), [&](size_t m) { mean[m] = surfaces.jump->Mean(m, x); });
    ends.Look(*law, direction, x);
  }

  MacroPlace<D> Place(size_t m) const override {
    auto & jump = *surfaces.jump;
    auto & n = direction[m];
    Vec<D> slip = mean[m] - reference[m], apart = mean[m] + gapvector[m];
    slip -= InnerProduct(slip, n) * n;
    double gap = law->Clearance(m) - InnerProduct(n, apart);
    Vec<D> vanishing = setup.tied ? Vec<D>(apart - tied[m]) : Vec<D>(slip - gap * n);
    Vec<D> facing = setup.obstacle ? Vec<D>(0.0) : master_normal[m];
    return {n,         gap,    slip,           vanishing, jump.area[m], jump.RowArea(m),
            EndsOf(m), facing, ends.ShareOf(m)};
  }

  /// Of which `Place` takes the means.
  Array<GapRange<D>> GapRanges(FlatVector<> x) const override {
    Vector<> moved(x.Size());
    moved = x - paired_at;
    auto slave = Displacement(*surfaces.slave, &Segment::slave, moved);
    unique_ptr<FaceDisplacement<D>> master;
    if (surfaces.master)
      master =
          make_unique<FaceDisplacement<D>>(Displacement(*surfaces.master, &Segment::master, moved));
    auto gap = [&](size_t m, const Segment & s, const PairPoint<D> & p) {
      Vec<D> apart = slave.At(s.slave, p.slave) - p.gap * p.normal;
      if (master)
        apart -= master->At(s.master, p.master);
      return law->Clearance(m) - InnerProduct(direction[m], apart);
    };
    return GapRangesOf<D>(*this->space, surfaces, gap);
  }

  void AddForces(size_t m, const Vec<D> & traction, Scatter & y, LocalHeap &) const override {
    bool spread = EndsOf(m);
    for (auto & e : surfaces.jump->Row(m))
      y.Add(e.dof, -InnerProduct(spread ? Across(m, traction) : traction, e.integral));
    if (spread)
      ends.AddForces(m, *law, y);
  }

  pair<Vec<D>, Vec<3>> ResultantOf(size_t m, const Vec<D> & traction) const override {
    auto & jump = *surfaces.jump;
    if (!EndsOf(m))
      return {jump.area[m] * traction, Moment(jump.moment[m], traction)};
    Vec<D> along = Across(m, traction), press = -1 * direction[m];
    return {jump.area[m] * traction,
            Moment(jump.moment[m], along) + Moment(ends.MomentOf(m, *law), press)};
  }

  shared_ptr<SparseMatrix<double>> ZeroMatrix(FlatArray<Vec<D>>, size_t) override {
    keeps_forces = has_forces && ends.Empty();
    has_forces = true;
    if (keeps_forces)
      ParallelFor(law->dofs.Size(), [&](size_t i) { mat->GetRowValues(law->dofs[i]) = 0.0; });
    else
      mat->SetZero();
    return mat;
  }

  PlaceRows<D> RowsOf(size_t m, const Vec<D> &, Rim, BlockSum & stiffness,
                      LocalHeap & lh) const override {
    if (EndsOf(m))
      return ends.RowsOf(m, *law, *surfaces.jump, direction[m], stiffness);
    auto row = surfaces.jump->Row(m);
    FlatArray<int> dofs(row.Size(), lh);
    for (int j : Range(row))
      dofs[j] = row[j].dof;
    PlaceRows<D> rows(dofs, !keeps_forces);
    for (int j : Range(row))
      rows.jump.Col(j) = 1 / surfaces.jump->area[m] * row[j].integral;
    for (int j : Range(rows.force.Width()))
      rows.force.Col(j) = row[j].integral;
    return rows;
  }

  void Commit(FlatVector<> x, FlatArray<MacroState> before, FlatArray<MacroState> now) override {
    auto & jump = *surfaces.jump;
    for (size_t m : Range(jump.Size())) {
      auto & n = direction[m];
      Vec<D> velocity = mean[m] - committed[m];
      committed[m] = mean[m];
      if (setup.obstacle || setup.offset) // may have come nearer, too
        velocity += (before[m].gap - now[m].gap - InnerProduct(velocity, n)) * n;
      double approach = InnerProduct(velocity, n);
      reference[m] = mean[m] + this->TimeToTouch(now[m], approach, L2Norm(velocity)) * velocity;
      reference[m] += law->ElasticSlip(m, n, x);
    }
    Accept();
  }

  void Restore() override {
    surfaces.pairing = accepted.pairing;
    gapvector = accepted.gapvector;
    ends.Load(accepted.ends);
    watch_obstacle.Forget();
  }

  void LearnStiffness(FlatVector<> diagonal) override {
    if (setup.obstacle)
      return;
    auto shapes = [&](const Surface<D> & side) {
      return FaceShapes<D>(u, side, max(1, u.Order(side)));
    };
    auto &slave = surfaces.slave, &master = surfaces.master;
    auto on_slave = shapes(*slave), on_master = shapes(*master);
    share = MasterShare<D>(u, {on_slave, *slave}, {on_master, *master}, diagonal);
    if (setup.edges) {
      auto of_slave = DiagonalOfNodes<D>(on_slave, *slave, diagonal);
      SetEndStiffness(DiagonalOfNodes<D>(on_master, *master, of_slave));
    }
    SetDirections();
  }

  void Exchange(History & history) override {
    history.Exchange("memory", committed);
    history.Exchange("share", share);
    if (setup.tied && setup.obstacle) // which has moved since
      history.Exchange("tied", tied);
    if (history.reads)
      SetDirections();
    if (setup.edges) {
      auto points = ends.Save();
      history.Exchange("end_c", law->end_c);
      history.Exchange("ends", points);
      history.Exchange("accepted_ends", accepted.ends);
      ends.Load(points);
    }
  }

private:
  /// The gaps of a pairing with an obstacle, which may move: of the present pairing another one is
  /// made, since the last committed one is kept.
  void LookAtObstacle() {
    if (watch_obstacle)
      watch_obstacle.WhereChanged([&] {
        auto moved = make_shared<Pairing<D>>(*surfaces.pairing);
        SetObstacleGaps(*watch_obstacle, *u.fes->GetMeshAccess(), *surfaces.slave, *moved);
        gapvector = surfaces.jump->GapVectors(*moved);
        surfaces.pairing = moved;
      });
  }

  /// On the faces that the pairing uses.
  FaceDisplacement<D> Displacement(const Surface<D> & surface, int Segment::* face,
                                   FlatVector<> x) const {
    return {u, surface, surfaces.pairing->UsedFaces(surface.Size(), face), x};
  }

  /// Of a periodic master, which the slave may meet beyond its seam.
  void AddImages(const Surface<D> & slave, Surface<D> & master) const {
    Periods<D> periods(u, slave, master, false);
    periods.Find(slave, master);
    periods.Complete(master);
  }

  /// Between both normals; without a partner, and against an obstacle, that of the slave.
  void SetDirections() {
    auto & jump = *surfaces.jump;
    direction = jump.normal;
    for (size_t m : Range(setup.obstacle ? 0 : jump.Size()))
      if (jump.area[m] > 0)
        direction[m] = ContactDirection<D>(slave_normal[m], master_normal[m], share).normal;
    if (setup.edges)
      ends = MacroEnds<D>(*this->space, u, surfaces, FinerPoints(), direction, paired_at);
  }

  std::function<Pairing<D>(const BitArray &)> FinerPoints() const {
    return [this](const BitArray & faces) {
      return this->finder.PairFiner(*surfaces.slave, *surfaces.master, law->Margin(), faces);
    };
  }

  /// Of the points where contact ends: stiff enough for the surfaces to meet nearly at points, and
  /// soft enough for Newton's method. As the scale of a macro-element, but the same in any frame,
  /// and it does not grow as the part shrinks that is paired.
  void SetEndStiffness(FlatVector<> diagonal) {
    auto & jump = *surfaces.jump;
    for (size_t m : Range(jump.Size()))
      if (double compliance = jump.Compliance(m, diagonal); compliance > 0)
        law->end_c[m] = 3 * sqr(jump.area[m]) / (jump.fullarea[m] * compliance);
  }

  /// The multipliers of a macro-element couple with each other and with the displacements of both
  /// sides; where contact ends inside of it these couple with each other, too.
  Array<GraphBlock> Graph() const {
    auto coupled = ends.Dofs(this->Size());
    Array<GraphBlock> blocks((1 + D) * this->Size());
    ParallelFor(this->Size(), [&](size_t m) {
      auto own = law->Dofs(m);
      auto & lines = blocks[(1 + D) * m];
      lines.rows = lines.columns = own;
      lines.columns += coupled[m];
      if (coupled[m].Size()) {
        blocks[(1 + D) * m + 1] = {Array<int>(coupled[m]), Array<int>(lines.columns)};
        return;
      }
      for (auto & e : surfaces.jump->Row(m)) {
        lines.columns.Append(e.dof);
        for (int k : Range(own))
          if (e.integral(k) != 0)
            blocks[(1 + D) * m + 1 + k].rows.Append(e.dof);
      }
      for (int k : Range(own))
        blocks[(1 + D) * m + 1 + k].columns.Append(own[k]);
    });
    return blocks;
  }

  const EndPoints * EndsOf(size_t m) const { return law->HasEnds() ? ends.PointsOf(m) : nullptr; }

  Vec<D> Across(size_t m, const Vec<D> & traction) const {
    return traction - InnerProduct(traction, direction[m]) * direction[m];
  }

  void Accept() {
    accepted.pairing = surfaces.pairing;
    accepted.gapvector = gapvector;
    accepted.ends = ends.Save();
  }
};
} // namespace

template <int D>
unique_ptr<Kinematics<D>> MakeSmallSliding(const KinematicsParts<D> & parts) {
  return make_unique<SmallSliding<D>>(parts);
}

template unique_ptr<Kinematics<2>> MakeSmallSliding(const KinematicsParts<2> &);
template unique_ptr<Kinematics<3>> MakeSmallSliding(const KinematicsParts<3> &);
} // namespace ngslac
