#include "bodycompliance.hpp"
#include "contact/formbase.hpp"
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

/// Does the matrix see that the overlap changes where the master ends?
enum class Rim { stays, moves };

/// Partners, gap, slip, normals and forces are those of the current configuration.
///
/// Areas, and with them the multipliers, count in the reference configuration. Between two calls of
/// Follow the points on the slave faces and their master faces stay; the derivative is exact for
/// that. Moving the points, too, would change nothing but errors of quadrature, since what is
/// integrated is continuous across the edges of segments, except at the rim of the master.
template <int D>
class FiniteSliding : public FormBase<D> {
  using Base = FormBase<D>;
  using Base::c, Base::finder, Base::jump, Base::lamdof, Base::mat, Base::normal, Base::nscalars;
  using Base::pairing, Base::reference, Base::space, Base::states, Base::u;

  unique_ptr<Surface<D>> slave_reference, master_reference;
  unique_ptr<FaceShapes<D>> slave_shapes, master_shapes;
  Array<int> along;                        // macro-elements, for self-contact
  Array<double> fullarea;                  // in the reference configuration
  shared_ptr<const MacroPoints<D>> points; // of the last Follow
  shared_ptr<const MacroPoints<D>> start;  // of the last Commit: slip counts from there
  Array<double> last_gap;                  // at the last Commit
  shared_ptr<Motion<D>> now;               // of the last Configure
  shared_ptr<Motion<D>> accepted_motion;   // of the last Commit
  double share = 0.5;                      // of the master in the stiffness of both bodies

public:
  using Base::Base;

  void Update(shared_ptr<GridFunction> gf, const FormHistory * history) override {
    static Timer timer("ngslac::FiniteSliding::Update");
    RegionTimer reg(timer);
    this->CheckUpdated(gf);
    FiniteSliding fresh(this->setup); // a failure leaves everything as it was
    fresh.Start(gf);
    if (history)
      fresh.SetHistory(*history);
    *this = std::move(fresh);
  }

  void SetStiffness(FlatVector<> diagonal, double factor) override {
    Base::SetStiffness(diagonal, factor);
    double of_slave = BodyCompliance<D>(u, *slave_shapes, *slave_reference, diagonal);
    double of_master = BodyCompliance<D>(u, *master_shapes, *master_reference, diagonal);
    bool known = of_slave + of_master > 0 && !finder.IsSelfContact();
    share = known ? of_slave / (of_slave + of_master) : 0.5;
  }

  FormHistory History() const override {
    auto history = Base::History();
    history["share"].Append(share);
    return history;
  }
  void SetHistory(const FormHistory & history) override {
    Base::SetHistory(history);
    share = history.at("share")[0];
  }

  void Follow(const BaseVector & bx) override {
    static Timer timer("ngslac::FiniteSliding::Follow");
    RegionTimer reg(timer);
    this->CheckSize(bx.FV<double>().Size());
    PairAnew(bx.FV<double>());
  }

  void AssembleLinearization(const BaseVector & bx) override {
    Assemble(bx, Rim::stays, [&](size_t m, const Vec<D> & normal, const Vec<D> & trial) {
      return Project(this->Data(m, normal), trial);
    });
  }

  void AssembleStep(const BaseVector & bx, BaseVector & residual) override {
    this->CheckPaired();
    Array<Projection<D>> projections(jump->Size());
    Array<Vec<D>> normals(jump->Size());
    Assemble(bx, Rim::moves, [&](size_t m, const Vec<D> & normal, const Vec<D> & trial) {
      normals[m] = normal;
      return projections[m] = this->ProjectWithMemory(m, normal, trial);
    });
    auto x = bx.FV<double>(), y = residual.FV<double>();
    ScatterInOrder(jump->Size(), y, [&](size_t m, LocalHeap & lh, Scatter & forces) {
      AddForces(m, normals[m], this->AddMultiplierResidual(m, x, projections[m], y), forces, lh);
    });
  }

  shared_ptr<SparseMatrix<double>> AssembleAugmented(const BaseVector & bx, BaseVector & residual,
                                                     double factor) override {
    this->Prepare(bx);
    typename Base::Augmentation augmentation(c, factor);
    auto x = bx.FV<double>(), y = residual.FV<double>();
    Configure(x);
    Array<Projection<D>> projections(jump->Size());
    Array<Vec<D>> tractions(jump->Size());
    ScatterInOrder(jump->Size(), y, [&](size_t m, LocalHeap & lh, Scatter & forces) {
      auto place = Place(m, x);
      projections[m] = this->ProjectWithMemory(m, place.normal, this->Trial(m, place, x));
      tractions[m] = projections[m].traction;
      AddForces(m, place.normal, tractions[m], forces, lh);
    });
    Assemble(
        bx, Rim::moves, [&](size_t m, const Vec<D> &, const Vec<D> &) { return projections[m]; },
        &tractions);
    return this->Penalized();
  }

  shared_ptr<SparseMatrix<double>> AssembleSprings(const BaseVector & bx,
                                                   FlatArray<double> stiffness) override {
    this->Prepare(bx);
    this->CheckSprings(stiffness);
    auto x = bx.FV<double>();
    Assemble(bx, Rim::moves, [&](size_t m, const Vec<D> & normal, const Vec<D> &) {
      Vec<D> traction = this->Multiplier(m, x);
      ngbla::Mat<D, D> turning = InnerProduct(traction, normal) * Id<D>();
      return Projection<D>{traction, this->Spring(m, stiffness), turning, Status::stick};
    });
    return this->Penalized();
  }

  void Commit(const BaseVector & bx) override {
    Follow(bx);
    this->Evaluate(bx);
    for (size_t m : Range(jump->Size())) {
      double approach = last_gap[m] - states[m].gap;
      Vec<D> slip = 0.0; // of all the step, what came before a touch included
      if (points->area[m] > 0 && Slides(m))
        slip = now->slip[m] - InnerProduct(now->slip[m], normal[m]) * normal[m];
      double motion = sqrt(sqr(approach) + L2Norm2(slip));
      double time = this->TimeToTouch(states[m], approach, motion);
      reference[m] =
          (time > 1 ? 1 / time : time) * slip; // if it touches earlier, slip must not turn round
      reference[m] += this->ElasticSlip(m, normal[m], bx.FV<double>());
      last_gap[m] = states[m].gap;
    }
    Accept();
  }

  void Restore() override {
    Base::Restore();
    points = start;
    now = accepted_motion;
  }

protected:
  /// Finds rays and means, unless the configuration is still the same.
  void Configure(FlatVector<> x) override {
    auto slave = slave_shapes->Displaced(*slave_reference, x);
    auto master = master_shapes->Displaced(*master_reference, x);
    bool same = now && now->points == points && now->surfaces.share == share &&
                now->surfaces.slave.HasShapeOf(slave) && now->surfaces.master.HasShapeOf(master);
    if (same && now->start == start)
      return;
    if (!same) {
      bool reuse = now && now != accepted_motion; // the memory
      auto hits = reuse ? std::move(now->hits) : Array<RayHit<D>>();
      hits.SetSize(points->pairing->points.Size());
      now = make_shared<Motion<D>>(
          Motion<D>{{*slave_shapes, *master_shapes, std::move(slave), std::move(master), share},
                    points,
                    start,
                    std::move(hits),
                    Array<MacroGap<D>>(jump->Size()),
                    Array<Vec<D>>(jump->Size())});
    }
    now->start = start;
    ParallelFor(jump->Size(), [&](size_t m) {
      if (points->area[m] == 0)
        return;
      if (!same)
        now->mean[m] = MeanGap<D>(now->surfaces, *points, m, now->hits);
      if (Slides(m))
        now->slip[m] = MeanSlip<D>(now->surfaces, *start, m);
    });
  }

  FlatArray<double> Memory() const override { return last_gap; }

  MacroTraction<D> Parts(size_t m, const Vec<D> & traction) const {
    return {traction, now->mean[m]};
  }

  void AddForces(size_t m, const Vec<D> &, const Vec<D> & traction, Scatter & y,
                 LocalHeap & lh) const override {
    if (points->area[m] > 0 && IsTraction(traction))
      AddTraction<D>(now->surfaces, *points, m, now->hits, Parts(m, traction), y, lh);
  }

  pair<Vec<D>, Vec<3>> ResultantOf(size_t m, const Vec<D> & traction) const override {
    if (points->area[m] == 0 || !IsTraction(traction))
      return {Vec<D>(0.0), Vec<3>(0.0)};
    return Resultant<D>(now->surfaces, *points, m, Parts(m, traction));
  }

  MacroPlace<D> Place(size_t m, FlatVector<>) const override {
    if (points->area[m] == 0)
      return {jump->normal[m], 0, Vec<D>(0.0), Vec<D>(0.0)};
    auto & mean = now->mean[m];
    Vec<D> slip = 0.0;
    if (Slides(m))
      slip = now->slip[m] - Offset(m);
    return PlaceOf(mean.gap, mean.normal, slip);
  }

  LawData<D> Data(size_t m, const Vec<D> & normal) const override {
    auto data = Base::Data(m, normal);
    if (!Slides(m)) // it has just met its partner: what it slid in this step is not known
      data.friction = data.threshold = -1;
    return data;
  }

private:
  void Start(shared_ptr<GridFunction> gf) {
    slave_reference = finder.Slave(nullptr);
    master_reference = finder.Master(nullptr);
    slave_shapes = make_unique<FaceShapes<D>>(u, *slave_reference, slave_reference->Degree());
    master_shapes = make_unique<FaceShapes<D>>(u, *master_reference, master_reference->Degree());
    Pairing<D> none;
    none.segments.Append(Segment{-1, -1, 0, 0});
    fullarea = MacroJump<D>(*space, *slave_reference, none).fullarea;
    if (finder.IsSelfContact())
      along = AlongSurface(*space);

    Vector<> x(u.fes->GetNDof() * u.fes->GetDimension());
    x = 0.0;
    if (gf)
      x = gf->GetVector().FV<double>();
    this->CollectMultiplierDofs(*slave_reference); // which tell what is closed
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
    Accept();
    mat = make_shared<SparseMatrix<double>>(0, 0);
  }

  void Accept() {
    Base::Accept();
    start = points;
    accepted_motion = now;
  }

  bool Slides(size_t m) const {
    return start->area[m] > 0 && max(this->friction[m], this->threshold[m]) >= 0;
  }

  /// What an approaching macro-element moves until it touches is no slip.
  Vec<D> Offset(size_t m) const {
    return L2Norm2(reference[m]) > 0 ? Carried<D>(now->surfaces, *start, m, reference[m])
                                     : reference[m];
  }

  static MacroPlace<D> PlaceOf(double gap, const Vec<D> & normal, const Vec<D> & slip) {
    Vec<D> along = slip - InnerProduct(slip, normal) * normal;
    return {normal, gap, along, along - gap * normal};
  }

  /// The same configuration has the same pairing; of self-contact it depends on more.
  bool IsPairedIn(const Surface<D> & slave, const Surface<D> & master) const {
    return jump && !finder.IsSelfContact() && this->slave->HasShapeOf(slave) &&
           this->master->HasShapeOf(master);
  }

  void PairAnew(FlatVector<> x) {
    auto slave = make_unique<Surface<D>>(slave_shapes->Displaced(*slave_reference, x));
    auto master = make_unique<Surface<D>>(master_shapes->Displaced(*master_reference, x));
    if (IsPairedIn(*slave, *master)) {
      normal = jump->normal; // before any Evaluate
      return;
    }
    slave->CheckFinite();
    master->CheckFinite();
    auto paired = finder.Pair(std::move(slave), std::move(master));
    if (finder.IsSelfContact())
      KeepOneSide<D>(*paired.pairing, *paired.slave, *paired.master, *space, along, Closed(x));
    CountReferenceAreas(*slave_reference, *paired.slave, *paired.pairing);
    this->Take(paired);
    jump->fullarea = fullarea;
    points = MakePoints<D>(pairing, *this->slave, *space, jump->area);
  }

  BitArray Closed(FlatVector<> x) const {
    BitArray closed(space->NMacros());
    closed.Clear();
    for (size_t m : Range(lamdof.Size() / D))
      if (L2Norm2(this->Multiplier(m, x)) > 0)
        closed.SetBit(m);
    return closed;
  }

  template <typename PROJECT>
  void Assemble(const BaseVector & bx, Rim rim, PROJECT project,
                const Array<Vec<D>> * given = nullptr) {
    static Timer timer("ngslac::FiniteSliding::Assemble");
    RegionTimer reg(timer);
    this->Prepare(bx);
    auto x = bx.FV<double>();
    Configure(x);
    Array<Vec<D>> tractions(jump->Size()); // which the forces are made of
    for (size_t m : Range(tractions))
      tractions[m] = given ? (*given)[m] : this->Multiplier(m, x);
    Array<Coupling> couplings(jump->Size());
    ParallelFor(jump->Size(), [&](size_t m) {
      couplings[m] = CouplingOf<D>(*slave_shapes, *master_shapes, *points,
                                   Slides(m) ? start.get() : nullptr, m, IsTraction(tractions[m]));
    });
    mat = MatrixOf<D>(couplings, *master_shapes, lamdof, nscalars);
    AddBlocksInOrder(jump->Size(), *mat, this->BlockHeap(),
                     [&](size_t m, LocalHeap & lh, BlockSum & forces) {
                       AssembleMacro(m, x, tractions[m], rim, project, couplings[m], forces, lh);
                     });
  }

  template <typename PROJECT>
  void AssembleMacro(size_t m, FlatVector<> x, Vec<D> traction, Rim rim, PROJECT project,
                     const Coupling & coupling, BlockSum & forces, LocalHeap & lh) {
    if (points->area[m] == 0) {
      auto p = project(m, jump->normal[m], jump->normal[m]);
      SetMultiplierBlock(m, jump->normal[m], p.derivative);
      return;
    }
    MacroRows<D> rows(coupling.dofs, coupling.turning);
    auto add = [&](FlatArray<int> masters, FlatMatrix<> block) {
      AddBlock(masters, block, forces);
    };
    auto & mean = now->mean[m];
    auto & normal = mean.normal;
    auto parts = Parts(m, traction);
    AddDerivatives<D>(now->surfaces, *points, m, now->hits, mean, parts, rim == Rim::moves, rows,
                      add, lh);
    if (!parts.IsZero())
      AddStiffness(normal, traction, parts.pressure, rows, forces);
    Vec<D> slip = 0.0;
    if (Slides(m)) {
      slip = MeanSlip<D>(now->surfaces, *start, m, rows, lh) - Offset(m);
      if (L2Norm2(reference[m]) > 0)
        SubtractCarried<D>(now->surfaces, *start, m, reference[m], rows, lh);
    }
    auto place = PlaceOf(mean.gap, normal, slip);
    auto p = project(m, normal, this->Trial(m, place, x));
    SetMultiplierBlock(m, normal, p.derivative);

    ngbla::Mat<D, D> across = Id<D>() - normal * Trans(normal);
    auto compliance = this->ComplianceOf(m);
    Vec<D> multiplier = this->Multiplier(m, x);
    double area = points->area[m];
    Matrix<> entries(D, rows.dofs.Size());
    for (int j : Range(rows.dofs)) {
      Vec<D> turn = rows.normal.Col(j);
      Vec<D> moved = across * Vec<D>(rows.slip.Col(j));
      moved -= InnerProduct(normal, slip) * turn + InnerProduct(turn, slip) * normal;
      moved -= rows.gap(j) * normal + mean.gap * turn;
      moved += 1 / c[m] * compliance.Turned(normal, turn, multiplier);
      entries.Col(j) = area / c[m] * (p.by_normal * turn) - area * (p.derivative * moved);
      Vec<D> force = across * Vec<D>(rows.force.Col(j)) + rows.squeeze(j) * normal;
      for (int k : Range(D))
        (*mat)(rows.dofs[j], lamdof[D * m + k]) = -force(k);
    }
    forces.Add(lamdof.Range(D * m, D * (m + 1)), rows.dofs, std::move(entries));
  }

  void SetMultiplierBlock(size_t m, const Vec<D> & normal, const ngbla::Mat<D, D> & derivative) {
    auto by_lam = this->MultiplierBlock(m, normal, derivative);
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
