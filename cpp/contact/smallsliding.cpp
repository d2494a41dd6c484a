#include "formbase.hpp"

namespace ngslac {
namespace {
/// Partners, weights and normals stay those of the last Update; gap and slip are linear.
template <int D>
class SmallSliding : public FormBase<D> {
  using Base = FormBase<D>;
  using Base::c, Base::finder, Base::jump, Base::lamdof, Base::mat, Base::pairing, Base::reference;
  using Base::setup, Base::states, Base::u;

  Watch watch_obstacle{setup.obstacle};
  Array<Vec<D>> gapvector, accepted_gapvector; // mean of x1 - x2 at u = 0, at the last commit
  Array<Vec<D>> committed;                     // mean of u1 - u2 at the last committed step
  Array<int> loaded;                           // rows of the displacements that have forces

public:
  using Base::Base;

  void Update(shared_ptr<GridFunction> gf, const FormHistory * history) override {
    static Timer timer("ngslac::SmallSliding::Update");
    RegionTimer reg(timer);
    this->CheckUpdated(gf);
    SmallSliding fresh(setup); // a failure leaves everything as it was
    fresh.Start(gf);
    if (history)
      fresh.SetHistory(*history);
    *this = std::move(fresh);
  }

  void AddApply(const BaseVector & bx, BaseVector & by) override {
    static Timer timer("ngslac::SmallSliding::Apply");
    RegionTimer reg(timer);
    this->Prepare(bx);
    this->CheckSize(by.FV<double>().Size());
    auto x = bx.FV<double>(), y = by.FV<double>();
    ParallelFor(jump->Size(), [&](size_t m) {
      this->AddMultiplierResidual(m, x, this->ProjectAt(m, Place(m, x), x), y);
    });
    AddAllForces(x, y);
  }

  void AssembleLinearization(const BaseVector & bx) override {
    static Timer timer("ngslac::SmallSliding::AssembleLinearization");
    RegionTimer reg(timer);
    this->Prepare(bx);
    auto x = bx.FV<double>();
    ParallelFor(jump->Size(),
                [&](size_t m) { SetRows(m, this->ProjectAt(m, Place(m, x), x).derivative); });
  }

  void AssembleStep(const BaseVector & bx, BaseVector & residual) override {
    static Timer timer("ngslac::SmallSliding::AssembleStep");
    RegionTimer reg(timer);
    this->Prepare(bx);
    auto x = bx.FV<double>(), y = residual.FV<double>();
    ParallelFor(jump->Size(), [&](size_t m) {
      auto p = this->ProjectWithMemory(m, jump->normal[m], this->Trial(m, Place(m, x), x));
      this->AddMultiplierResidual(m, x, p, y);
      SetRows(m, p.derivative);
    });
    AddAllForces(x, y);
  }

  shared_ptr<SparseMatrix<double>> AssembleAugmented(const BaseVector & bx, BaseVector & residual,
                                                     double factor) override {
    this->Prepare(bx);
    typename Base::Augmentation augmentation(c, factor);
    auto x = bx.FV<double>(), y = residual.FV<double>();
    ScatterInOrder(jump->Size(), y, [&](size_t m, LocalHeap & lh, Scatter & forces) {
      auto p = this->ProjectWithMemory(m, jump->normal[m], this->Trial(m, Place(m, x), x));
      AddForces(m, jump->normal[m], p.traction, forces, lh);
      SetRows(m, p.derivative);
    });
    return this->Penalized();
  }

  shared_ptr<SparseMatrix<double>> AssembleSprings(const BaseVector & bx,
                                                   FlatArray<double> stiffness) override {
    this->Prepare(bx);
    this->CheckSprings(stiffness);
    ParallelFor(jump->Size(), [&](size_t m) { SetRows(m, this->Spring(m, stiffness)); });
    return this->Penalized();
  }

  void Commit(const BaseVector & bx) override {
    this->Evaluate(bx);
    auto x = bx.FV<double>();
    for (size_t m : Range(jump->Size())) {
      auto & n = jump->normal[m];
      Vec<D> mean = jump->Mean(m, x), velocity = mean - committed[m];
      committed[m] = mean;
      if (setup.obstacle) // may have come nearer, too
        velocity += (this->accepted.states[m].gap - states[m].gap - InnerProduct(velocity, n)) * n;
      double approach = InnerProduct(velocity, n);
      reference[m] = mean + this->TimeToTouch(states[m], approach, L2Norm(velocity)) * velocity;
      reference[m] += this->ElasticSlip(m, jump->normal[m], x);
    }
    Accept();
  }

  void Restore() override {
    Base::Restore();
    gapvector = accepted_gapvector;
    watch_obstacle.Forget();
  }

protected:
  FlatArray<double> Memory() const override {
    return FlatArray<double>(D * committed.Size(), committed.Size() ? &committed[0](0) : nullptr);
  }

  pair<Vec<D>, Vec<3>> ResultantOf(size_t m, const Vec<D> & traction) const override {
    return {jump->area[m] * traction, Moment(jump->moment[m], traction)};
  }

  void AddForces(size_t m, const Vec<D> &, const Vec<D> & traction, Scatter & y,
                 LocalHeap &) const override {
    for (auto & e : jump->Row(m))
      y.Add(e.dof, -InnerProduct(traction, e.integral));
  }

  MacroPlace<D> Place(size_t m, FlatVector<> x) const override {
    auto & n = jump->normal[m];
    Vec<D> mean = jump->Mean(m, x), slip = mean - reference[m];
    slip -= InnerProduct(slip, n) * n;
    double gap = Gap(m, mean);
    return {n, gap, slip, setup.tied ? mean : Vec<D>(slip - gap * n)};
  }

private:
  void Start(shared_ptr<GridFunction> gf) {
    shared_ptr<CoefficientFunction> displacement;
    if (gf && !setup.obstacle) // an obstacle is given by its gap in the reference configuration
      displacement = make_shared<GridFunctionCoefficientFunction>(gf, nullptr, u.evaluator);
    this->Take(finder.Pair(finder.Slave(displacement), finder.Master(displacement)));
    this->CollectMultiplierDofs(*this->slave);
    this->NeedRows();
    this->Reset();
    if (!setup.obstacle)
      gapvector = jump->GapVectors(*pairing);
    size_t n = jump->Size();
    committed.SetSize(n);
    for (size_t m : Range(n)) {
      committed[m] = gf ? jump->Mean(m, gf->GetVector().FV<double>()) : Vec<D>(0.0);
      if (displacement) // the gap is linear in u, counted from the paired configuration
        gapvector[m] -= committed[m];
      reference[m] = committed[m];
      states[m] = MacroState{0, Gap(m, committed[m]), Vec<3>(0.0), Vec<3>(0.0), Status::open};
    }
    Accept();
    mat = ContactGraph(*jump, lamdof, this->nscalars);
    SetForces();
  }

  /// The gaps of a pairing with an obstacle, which may move: of the present pairing another one is
  /// made, since the last committed one is kept.
  void Reevaluate() override {
    Base::Reevaluate();
    if (watch_obstacle)
      watch_obstacle.WhereChanged([&] {
        auto moved = make_shared<Pairing<D>>(*pairing);
        SetObstacleGaps(*watch_obstacle, *u.fes->GetMeshAccess(), *this->slave, *moved);
        gapvector = jump->GapVectors(*moved);
        pairing = moved;
      });
  }

  void Accept() {
    Base::Accept();
    accepted_gapvector = gapvector;
  }

  double Gap(size_t m, Vec<D> mean) const {
    return -InnerProduct(jump->normal[m], mean + gapvector[m]);
  }

  /// The columns of the multipliers, which hold the forces of unit multipliers, do not change until
  /// the next Update.
  void SetForces() {
    BitArray has_forces(mat->Height());
    has_forces.Clear();
    ParallelFor(jump->Size(), [&](size_t m) {
      for (auto & e : jump->Row(m)) {
        has_forces.SetBitAtomic(e.dof);
        for (int k : Range(D))
          if (e.integral(k) != 0)
            (*mat)(e.dof, lamdof[D * m + k]) = -e.integral(k);
      }
    });
    loaded.SetSize0();
    for (size_t i : Range(mat->Height()))
      if (has_forces.Test(i))
        loaded.Append(i);
  }

  /// Of the multipliers of x, row by row, so that threads do not meet.
  void AddAllForces(FlatVector<> x, FlatVector<> y) const {
    ParallelFor(loaded.Size(), [&](size_t i) {
      int row = loaded[i];
      auto columns = mat->GetRowIndices(row);
      auto values = mat->GetRowValues(row);
      double sum = 0;
      for (size_t j : Range(columns))
        sum += values(j) * x(columns[j]);
      y(row) += sum;
    });
  }

  void SetRows(size_t m, const ngbla::Mat<D, D> & derivative) {
    auto by_lam = this->MultiplierBlock(m, jump->normal[m], derivative);
    for (int k : Range(D)) {
      int row = lamdof[D * m + k];
      for (int l : Range(D))
        (*mat)(row, lamdof[D * m + l]) = by_lam(k, l);
      auto columns = mat->GetRowIndices(row); // sorted, as the entries are
      auto values = mat->GetRowValues(row);
      size_t at = 0;
      for (auto & e : jump->Row(m)) {
        while (at < columns.Size() && columns[at] < e.dof)
          at++;
        if (at == columns.Size() || columns[at] != e.dof)
          throw Exception("ngslac: a contact force has no place in the matrix");
        values(at) = -InnerProduct(Vec<D>(derivative.Row(k)), e.integral);
      }
    }
  }
};
} // namespace

template <int D>
shared_ptr<ContactForm> MakeSmallSliding(const ContactSetup & setup) {
  return make_shared<SmallSliding<D>>(setup);
}

template shared_ptr<ContactForm> MakeSmallSliding<2>(const ContactSetup &);
template shared_ptr<ContactForm> MakeSmallSliding<3>(const ContactSetup &);
} // namespace ngslac
