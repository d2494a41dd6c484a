#include "formbase.hpp"
#include "macromotion.hpp"
#include "selfcontact.hpp"

namespace ngslac {
namespace {
/// Partners, gap, slip, normals and forces are those of the current configuration.
///
/// Areas, and with them the multipliers, count in the reference configuration. Between two calls of
/// Follow the points on the slave faces and their master faces stay; the derivative is exact for
/// that. Moving the points, too, would change nothing but errors of quadrature, since what is
/// integrated is continuous across the edges of segments, except at the rim of the master.
template <int D>
class FiniteSliding : public FormBase<D> {
  using Base = FormBase<D>;
  using Base::accepted, Base::c, Base::jump, Base::lamdof, Base::mat, Base::nscalars;
  using Base::pairing, Base::reference, Base::space, Base::states, Base::u;

  unique_ptr<Surface<D>> slave_reference, master_reference;
  unique_ptr<FaceShapes<D>> slave_shapes, master_shapes;
  Array<int> along;                        // macro-elements, for self-contact
  Array<double> fullarea;                  // in the reference configuration
  shared_ptr<const MacroPoints<D>> points; // of the last Follow
  shared_ptr<const MacroPoints<D>> start;  // of the last Commit: slip counts from there
  Array<double> last_gap;                  // at the last Commit
  unique_ptr<MovingSurfaces<D>> now;
  bool moving_rim = false; // does the matrix see that the overlap changes?

public:
  using Base::Base;

  void Update(shared_ptr<GridFunction> gf) override {
    static Timer timer("ngslac::FiniteSliding::Update");
    RegionTimer reg(timer);
    this->CheckSpace(gf);
    slave_reference = this->SurfaceOf(space->SlaveRegion(), nullptr);
    master_reference = this->SurfaceOf(*this->setup.master, nullptr);
    slave_shapes = make_unique<FaceShapes<D>>(u, *slave_reference);
    master_shapes = make_unique<FaceShapes<D>>(u, *master_reference);
    Pairing<D> none;
    none.segments.Append(Segment{-1, -1, 0, 0});
    fullarea = MacroJump<D>(u, *space, *slave_reference, nullptr, none).fullarea;

    along = AlongSurface(*space);
    Vector<> x(u.fes->GetNDof() * u.fes->GetDimension());
    x = 0.0;
    if (gf)
      x = gf->GetVector().FV<double>();
    lamdof.SetSize0(); // of another mesh
    PairAnew(x);
    this->Reset();
    start = points;
    reference = Vec<D>(0.0);
    last_gap.SetSize(jump->Size());
    Configure(x);
    for (size_t m : Range(jump->Size())) {
      last_gap[m] = Place(m, x).gap;
      states[m] = MacroState{0, last_gap[m], Vec<3>(0.0), Vec<3>(0.0), Status::open};
    }
    accepted = states;
    mat = make_shared<SparseMatrix<double>>(0, 0);
  }

  void Follow(const BaseVector & bx) override {
    static Timer timer("ngslac::FiniteSliding::Follow");
    RegionTimer reg(timer);
    this->CheckSize(bx.FV<double>().Size());
    PairAnew(bx.FV<double>());
  }

  void AssembleLinearization(const BaseVector & bx) override {
    moving_rim = false;
    Assemble(bx, [&](size_t m, const Vec<D> & normal, const Vec<D> & trial) {
      return Project(this->Data(m, normal), trial);
    });
  }

  void AssembleStep(const BaseVector & bx, BaseVector & residual) override {
    moving_rim = true;
    Array<Projection<D>> projections(jump->Size());
    Array<Vec<D>> normals(jump->Size());
    Assemble(bx, [&](size_t m, const Vec<D> & normal, const Vec<D> & trial) {
      normals[m] = normal;
      return projections[m] = this->ProjectWithMemory(m, normal, trial);
    });
    auto x = bx.FV<double>(), y = residual.FV<double>();
    this->ForMacros([&](size_t m, LocalHeap & lh) {
      AddForces(m, normals[m], this->AddMultiplierResidual(m, x, projections[m], y), y, lh);
    });
  }

  shared_ptr<SparseMatrix<double>> AssembleAugmented(const BaseVector & bx, BaseVector & residual,
                                                     double factor) override {
    typename Base::Augmentation augmentation(c, factor);
    this->Prepare(bx);
    auto x = bx.FV<double>(), y = residual.FV<double>();
    Configure(x);
    moving_rim = true;
    Array<Projection<D>> projections(jump->Size());
    Array<Vec<D>> tractions(jump->Size());
    this->ForMacros([&](size_t m, LocalHeap & lh) {
      auto place = Place(m, x);
      projections[m] = this->ProjectWithMemory(m, place.normal, this->Trial(m, place, x));
      tractions[m] = projections[m].traction;
      AddForces(m, place.normal, tractions[m], y, lh);
    });
    Assemble(
        bx, [&](size_t m, const Vec<D> &, const Vec<D> &) { return projections[m]; }, &tractions);
    return this->Penalized();
  }

  void Commit(const BaseVector & bx) override {
    Follow(bx);
    this->Evaluate(bx);
    accepted = states;
    for (size_t m : Range(jump->Size())) {
      double approach = last_gap[m] - states[m].gap;
      Vec<D> slip;
      for (int k : Range(D))
        slip(k) = states[m].slip(k);
      double motion = sqrt(sqr(approach) + L2Norm2(slip));
      reference[m] = this->TimeToTouch(states[m], approach, motion) * slip;
      last_gap[m] = states[m].gap;
    }
    start = points;
  }

protected:
  void Configure(FlatVector<> x) override {
    now = make_unique<MovingSurfaces<D>>(MovingSurfaces<D>{
        *slave_shapes, *master_shapes, slave_shapes->Displaced(*slave_reference, x),
        master_shapes->Displaced(*master_reference, x)});
  }

  FlatArray<double> Memory() const override { return last_gap; }

  void AddForces(size_t m, const Vec<D> & normal, const Vec<D> & traction, FlatVector<> y,
                 LocalHeap & lh) const override {
    if (points->area[m] > 0 && L2Norm2(traction) > 0)
      AddTraction<D>(*now, *points, m, MacroTraction<D>(traction, normal), y, lh);
  }

  pair<Vec<D>, Vec<3>> ResultantOf(size_t m, const Vec<D> & traction) const override {
    if (points->area[m] == 0 || L2Norm2(traction) == 0)
      return {Vec<D>(0.0), Vec<3>(0.0)};
    return Resultant<D>(*now, *points, m, MacroTraction<D>(traction, jump->normal[m]));
  }

  MacroPlace<D> Place(size_t m, FlatVector<>) const override {
    if (points->area[m] == 0)
      return {jump->normal[m], 0, Vec<D>(0.0), Vec<D>(0.0)};
    auto mean = MeanGap<D>(*now, *points, m);
    Vec<D> slip = 0.0;
    if (Slides(m))
      slip = MeanSlip<D>(*now, *start, m) - Offset(m);
    return PlaceOf(mean.gap, mean.normal, slip);
  }

  LawData<D> Data(size_t m, const Vec<D> & normal) const override {
    auto data = Base::Data(m, normal);
    if (!Slides(m)) // it has just met its partner: what it slid in this step is not known
      data.friction = data.threshold = -1;
    return data;
  }

private:
  bool Slides(size_t m) const {
    return start->area[m] > 0 && max(this->friction[m], this->threshold[m]) >= 0;
  }

  /// What an approaching macro-element moves until it touches is no slip.
  Vec<D> Offset(size_t m) const {
    return L2Norm2(reference[m]) > 0 ? Carried<D>(*now, *start, m, reference[m]) : reference[m];
  }

  static MacroPlace<D> PlaceOf(double gap, const Vec<D> & normal, const Vec<D> & slip) {
    Vec<D> along = slip - InnerProduct(slip, normal) * normal;
    return {normal, gap, along, along - gap * normal};
  }

  void PairAnew(FlatVector<> x) {
    auto slave = make_unique<Surface<D>>(slave_shapes->Displaced(*slave_reference, x));
    auto master = make_unique<Surface<D>>(master_shapes->Displaced(*master_reference, x));
    slave->CheckFinite(*u.fes->GetMeshAccess());
    master->CheckFinite(*u.fes->GetMeshAccess());
    auto paired = this->PairAt(std::move(slave), std::move(master));
    if (this->selfcontact)
      KeepOneSide<D>(paired.pairing, *paired.slave, *paired.master, *space, along, Closed(x));
    CountReferenceAreas(*paired.slave, paired.pairing);
    this->Take(std::move(paired));
    jump->fullarea = fullarea;
    points = MakePoints(pairing, *this->slave, *space, jump->area);
  }

  BitArray Closed(FlatVector<> x) const {
    BitArray closed(space->NMacros());
    closed.Clear();
    for (size_t m : Range(lamdof.Size() / D))
      if (L2Norm2(this->Multiplier(m, x)) > 0)
        closed.SetBit(m);
    return closed;
  }

  void CountReferenceAreas(const Surface<D> & current, Pairing<D> & pairs) const {
    ParallelFor(pairs.Size(), [&](size_t s) {
      int face = pairs.segments[s].slave;
      for (auto & p : pairs.points.Range(pairs.Points(s)))
        p.weight *= ReferenceMeasure(face, p) / MeasureAt(current, face, p);
    });
    for (auto & r : pairs.rim)
      r.point.weight = ReferenceMeasure(pairs.segments[r.segment].slave, r.point);
  }

  static double MeasureAt(const Surface<D> & surface, int face, const PairPoint<D> & p) {
    Vec<D> x;
    Mat<D, D - 1> dx;
    surface.Evaluate(face, p.slave, x, dx);
    return Measure(dx);
  }
  double ReferenceMeasure(int face, const PairPoint<D> & p) const {
    return MeasureAt(*slave_reference, face, p);
  }

  /// Dofs that a macro-element's gap and slip depend on, sorted.
  Array<int> Dofs(size_t m) const {
    Array<int> dofs;
    auto add = [&](const MacroPoints<D> & from) {
      for (int s : from.segments[m]) {
        auto & segment = from.pairing.segments[s];
        dofs += slave_shapes->Dofs(segment.slave);
        dofs += master_shapes->Dofs(segment.master);
      }
    };
    add(*points);
    if (Slides(m))
      add(*start);
    return Sorted(std::move(dofs));
  }

  static Array<int> Sorted(Array<int> && dofs) {
    QuickSort(dofs);
    dofs.SetSize(std::unique(dofs.begin(), dofs.end()) - dofs.begin());
    return std::move(dofs);
  }

  /// Dofs that a macro-element's normal depends on.
  Array<int> TurningDofs(size_t m) const {
    Array<int> dofs;
    for (int s : points->segments[m])
      dofs += slave_shapes->Dofs(points->pairing.segments[s].slave);
    if (moving_rim)
      for (int r : points->rim[m])
        dofs +=
            master_shapes->Dofs(points->pairing.segments[points->pairing.rim[r].segment].master);
    return Sorted(std::move(dofs));
  }

  void MakeGraph(FlatArray<Vec<D>> tractions) {
    static Timer timer("ngslac::FiniteSliding - graph");
    RegionTimer reg(timer);
    TableCreator<int> creator(nscalars);
    for (; !creator.Done(); creator++)
      ParallelFor(jump->Size(), [&](size_t m) {
        FlatArray<int> own = lamdof.Range(D * m, D * (m + 1));
        for (int row : own)
          for (int col : own)
            creator.Add(row, col);
        if (points->area[m] == 0)
          return;
        for (int dof : Dofs(m))
          for (int row : own) {
            creator.Add(row, dof);
            creator.Add(dof, row);
          }
        if (L2Norm2(tractions[m]) == 0)
          return;
        for (int s : points->segments[m]) {
          auto & segment = points->pairing.segments[s];
          for (int row : master_shapes->Dofs(segment.master))
            creator.Add(row, master_shapes->Dofs(segment.master));
        }
        auto turning = TurningDofs(m);
        for (int row : Dofs(m)) // of those the normal depends on
          creator.Add(row, turning);
      });
    mat = MatrixOf(creator.MoveTable());
  }

  template <typename PROJECT>
  void Assemble(const BaseVector & bx, PROJECT project, const Array<Vec<D>> * given = nullptr) {
    static Timer timer("ngslac::FiniteSliding::Assemble");
    RegionTimer reg(timer);
    this->Prepare(bx);
    auto x = bx.FV<double>();
    Configure(x);
    Array<Vec<D>> tractions(jump->Size()); // which the forces are made of
    for (size_t m : Range(tractions))
      tractions[m] = given ? (*given)[m] : this->Multiplier(m, x);
    MakeGraph(tractions);
    this->ForMacros(
        [&](size_t m, LocalHeap & lh) { AssembleMacro(m, x, tractions[m], project, lh); });
  }

  template <typename PROJECT>
  void AssembleMacro(size_t m, FlatVector<> x, Vec<D> traction, PROJECT project, LocalHeap & lh) {
    if (points->area[m] == 0) {
      auto p = project(m, jump->normal[m], jump->normal[m]);
      SetMultiplierBlock(m, p.derivative);
      return;
    }
    MacroRows<D> rows(Dofs(m));
    bool pushes = L2Norm2(traction) > 0;
    auto add = [&](FlatArray<int> slaves, FlatArray<int> masters, FlatMatrix<> block) {
      int n1 = slaves.Size();
      for (int i : Range(pushes ? block.Height() : 0)) {
        int row = i < n1 ? slaves[i] : masters[i - n1];
        for (int j : Range(n1))
          AtomicAdd((*mat)(row, slaves[j]), block(i, j));
        for (int j : Range(masters))
          if (block(i, n1 + j) != 0)
            AtomicAdd((*mat)(row, masters[j]), block(i, n1 + j));
      }
    };
    auto mean = MeanGap<D>(*now, *points, m);
    auto & normal = mean.normal;
    MacroTraction<D> parts(traction, normal);
    AddDerivatives<D>(*now, *points, m, mean, parts, moving_rim, rows, add, lh);
    if (pushes)
      AddTurningTraction(m, normal, traction, parts.pressure, rows);
    Vec<D> slip = 0.0;
    if (Slides(m)) {
      slip = MeanSlip<D>(*now, *start, m, rows, lh) - Offset(m);
      SubtractCarried<D>(*now, *start, m, reference[m], rows, lh);
    }
    auto place = PlaceOf(mean.gap, normal, slip);
    auto p = project(m, normal, this->Trial(m, place, x));
    SetMultiplierBlock(m, p.derivative);

    ngbla::Mat<D, D> across = Id<D>() - normal * Trans(normal);
    double area = points->area[m];
    for (int j : Range(rows.dofs)) {
      Vec<D> turn = rows.normal.Col(j);
      Vec<D> moved = across * Vec<D>(rows.slip.Col(j));
      moved -= InnerProduct(normal, slip) * turn + InnerProduct(turn, slip) * normal;
      moved -= rows.gap(j) * normal + mean.gap * turn;
      Vec<D> entry = area / c[m] * (p.by_normal * turn) - area * (p.derivative * moved);
      Vec<D> force = across * Vec<D>(rows.force.Col(j)) + rows.squeeze(j) * normal;
      for (int k : Range(D)) {
        (*mat)(lamdof[D * m + k], rows.dofs[j]) = entry(k);
        (*mat)(rows.dofs[j], lamdof[D * m + k]) = -force(k);
      }
    }
  }

  /// The split of the multiplier into pressure and tangential traction turns with the normal.
  void AddTurningTraction(size_t m, const Vec<D> & normal, const Vec<D> & traction, double pressure,
                          const MacroRows<D> & rows) {
    for (int col : TurningDofs(m)) {
      Vec<D> turn = rows.normal.Col(rows.Position(col));
      double pressing = -InnerProduct(traction, turn);
      Vec<D> tangential = pressing * normal + pressure * turn;
      for (int i : Range(rows.dofs))
        AtomicAdd((*mat)(rows.dofs[i], col),
                  pressing * rows.squeeze(i) - InnerProduct(tangential, rows.force.Col(i)));
    }
  }

  void SetMultiplierBlock(size_t m, const ngbla::Mat<D, D> & derivative) {
    ngbla::Mat<D, D> by_lam = (this->RowArea(m) / c[m]) * (derivative - Id<D>());
    for (int k : Range(D))
      for (int l : Range(D))
        (*mat)(lamdof[D * m + k], lamdof[D * m + l]) = by_lam(k, l);
  }
};
} // namespace

template <int D>
shared_ptr<ContactForm> MakeFiniteSliding(const ContactSetup & setup) {
  if (setup.obstacle || setup.tied)
    throw Exception("LACContact: finite=True needs a master surface that slides; for a rigid "
                    "obstacle mesh a body and fix it, and tied surfaces need no finite");
  return make_shared<FiniteSliding<D>>(setup);
}

template shared_ptr<ContactForm> MakeFiniteSliding<2>(const ContactSetup &);
template shared_ptr<ContactForm> MakeFiniteSliding<3>(const ContactSetup &);
} // namespace ngslac
