#include "contactform.hpp"
#include "coefficients.hpp"

namespace ngslac {
ContactForm::ContactForm(const ContactSetup & asetup)
    : setup(asetup), u(*asetup.u, "u"), lam(*asetup.lam, "lam") {
  space = dynamic_pointer_cast<LACSpace>(lam.component);
  if (!space)
    throw Exception("LACContact: lam must belong to a LACSpace, not to " +
                    lam.component->GetClassName());
  if (u.fes != lam.fes)
    throw Exception("LACContact: u and lam belong to different product spaces");
  if (space->Displacement()->GetNDof() != u.component->GetNDof() ||
      space->Displacement()->GetClassName() != u.component->GetClassName())
    throw Exception("LACContact: lam was made for another displacement space (" +
                    space->Displacement()->GetClassName() + ") than that of u (" +
                    u.component->GetClassName() + "); its macro-elements may be unstable");
  if (setup.master && setup.master->Mesh() != u.fes->GetMeshAccess())
    throw Exception("LACContact: master is a region of another mesh than that of u");
  int dim = u.fes->GetMeshAccess()->GetDimension();
  if (u.evaluator->Dim() != dim || lam.evaluator->Dim() != dim)
    throw Exception("LACContact: u and lam need " + ToString(dim) +
                    " components each (LACSpace without components=...)");
}

namespace {
template <int D>
class T_ContactForm : public ContactForm {
  unique_ptr<Surface<D>> slave, master;
  Pairing<D> pairing;
  unique_ptr<MacroJump<D>> jump;
  Array<double> c;
  Array<double> friction, threshold;
  Array<Vec<D>> direction; // of slip in the last Newton step
  // history
  Array<Vec<D>> committed;    // mean of u1 - u2 at the last committed step
  Array<Vec<D>> reference;    // the same at first touch: slip counts from there
  Array<MacroState> accepted; // at the last committed step

public:
  explicit T_ContactForm(const ContactSetup & asetup) : ContactForm(asetup) {}

  void Update(shared_ptr<GridFunction> gf) override {
    if (gf && gf->GetFESpace() != u.fes)
      throw Exception(
          "LACContact.Update: gf lives on another space than u and lam; give the one on "
          "the product space");
    static Timer timer("ngslac::ContactForm::Update");
    RegionTimer reg(timer);
    shared_ptr<CoefficientFunction> displacement;
    if (gf && !setup.obstacle) // an obstacle is given by its gap in the reference configuration
      displacement = make_shared<GridFunctionCoefficientFunction>(gf, nullptr, u.evaluator);
    int order = u.component->GetOrder();
    double maxdist = 0;
    // A failure leaves the old pairing as it was.
    auto new_slave = make_unique<Surface<D>>(space->SlaveRegion(), displacement, order);
    unique_ptr<Surface<D>> new_master;
    Pairing<D> new_pairing;
    auto degree = [&](int highest) { return highest + 2 * (new_slave->Degree() - 1); };
    if (setup.obstacle) {
      new_pairing = PairWithObstacle<D>(*new_slave, 2 * degree(u.Order(*new_slave)));
      SetObstacleGaps(*setup.obstacle, *u.fes->GetMeshAccess(), *new_slave, new_pairing);
    } else {
      new_master = make_unique<Surface<D>>(*setup.master, displacement, order);
      auto options =
          SearchOptions(*new_slave, *new_master, setup.maxdist, setup.penetration,
                        (D == 2 ? 2 : 1) * degree(max(u.Order(*new_slave), u.Order(*new_master))));
      new_pairing = Pair<D>(*new_slave, *new_master, options);
      maxdist = options.maxdist;
    }
    if (new_pairing.Size() == 0)
      throw Exception("LACContact: slave and master never meet: no slave normal reaches the master "
                      "surface within maxdist = " +
                      ToString(maxdist) +
                      "; check the regions, the placement of the bodies and maxdist");
    auto new_jump = make_unique<MacroJump<D>>(u, *space, *new_slave, new_master.get(), new_pairing);
    slave = std::move(new_slave), master = std::move(new_master), jump = std::move(new_jump);
    pairing = std::move(new_pairing);
    CollectMultiplierDofs();
    FindFriction();
    size_t n = jump->Size();
    c.SetSize(n);
    c = 0.0;
    committed.SetSize(n), reference.SetSize(n), states.SetSize(n), direction.SetSize(n);
    BeginSolve();
    for (size_t m : Range(n)) {
      committed[m] = gf ? jump->Mean(m, gf->GetVector().FV<double>()) : Vec<D>(0.0);
      if (displacement) // the gap is linear in u, counted from the paired configuration
        jump->gapvector[m] -= committed[m];
      reference[m] = committed[m];
      states[m] = MacroState{0, Gap(m, committed[m]), Vec<3>(0.0), Vec<3>(0.0), Status::open};
    }
    accepted = states;
    mat = ContactGraph(*jump, lamdof, u.fes->GetNDof() * u.fes->GetDimension());
  }

  void SetStiffness(FlatVector<> diagonal, double factor) override {
    CheckSize(diagonal.Size());
    double sum = 0;
    int paired = 0;
    for (size_t m : Range(jump->Size())) {
      double compliance = 0;
      for (auto & e : jump->Row(m))
        if (diagonal(e.dof) > 0)
          compliance += L2Norm2(e.integral) / (D * diagonal(e.dof));
      c[m] = compliance > 0 ? factor * jump->area[m] / compliance : 0;
      sum += c[m];
      paired += c[m] > 0;
    }
    // A macro-element without a partner still needs a regular row of the right size.
    for (double & value : c)
      if (value == 0)
        value = paired ? sum / paired : factor;
  }

  void SetConstant(double value) override { c = value; }

  void AddApply(const BaseVector & bx, BaseVector & by) override {
    static Timer timer("ngslac::ContactForm::Apply");
    RegionTimer reg(timer);
    Prepare(bx);
    CheckSize(by.FV<double>().Size());
    auto x = bx.FV<double>();
    ParallelFor(jump->Size(),
                [&](size_t m) { AddResidual(m, x, Project(Data(m), Trial(m, x)), by); });
  }

  void AssembleLinearization(const BaseVector & bx) override {
    static Timer timer("ngslac::ContactForm::AssembleLinearization");
    RegionTimer reg(timer);
    Prepare(bx);
    auto x = bx.FV<double>();
    ParallelFor(jump->Size(),
                [&](size_t m) { SetRows(m, Project(Data(m), Trial(m, x)).derivative); });
  }

  void BeginSolve() override { direction = Vec<D>(0.0); }

  void AssembleStep(const BaseVector & bx, BaseVector & residual) override {
    static Timer timer("ngslac::ContactForm::AssembleStep");
    RegionTimer reg(timer);
    Prepare(bx);
    auto x = bx.FV<double>();
    ParallelFor(jump->Size(), [&](size_t m) {
      Vec<D> trial = Trial(m, x), now = 0.0;
      auto p = Project(Data(m), trial);
      if (p.status == Status::slip && max(friction[m], threshold[m]) > 0)
        now = trial - InnerProduct(trial, jump->normal[m]) * jump->normal[m];
      if (InnerProduct(now, direction[m]) < 0) {
        p = {trial, Id<D>(), Status::stick};
        now = 0.0;
      }
      direction[m] = now;
      AddResidual(m, x, p, residual);
      SetRows(m, p.derivative);
    });
  }

  void Evaluate(const BaseVector & bx) override {
    CheckSize(bx.FV<double>().Size());
    auto x = bx.FV<double>();
    ParallelFor(jump->Size(), [&](size_t m) {
      Vec<D> traction = Multiplier(m, x), mean = jump->Mean(m, x);
      auto & n = jump->normal[m];
      Vec<D> slip = mean - reference[m];
      slip -= InnerProduct(slip, n) * n;
      auto & state = states[m];
      state.pressure = -InnerProduct(traction, n);
      state.gap = Gap(m, mean);
      state.traction = 0.0, state.slip = 0.0;
      for (int k : Range(D))
        state.traction(k) = traction(k), state.slip(k) = slip(k);
      state.status = Project(Data(m), Trial(m, x)).status;
    });
  }

  void Commit(const BaseVector & bx) override {
    Evaluate(bx);
    accepted = states;
    auto x = bx.FV<double>();
    for (size_t m : Range(jump->Size())) {
      Vec<D> mean = jump->Mean(m, x), velocity = mean - committed[m];
      auto & n = jump->normal[m];
      committed[m] = reference[m] = mean;
      bool open = states[m].status == Status::open;
      // An open macro-element that goes on as in this step will touch where its path meets the
      // master: what it moves until then is no slip.
      double approach = InnerProduct(velocity, n), gap = states[m].gap;
      if (open && gap > 0 && approach > 0.1 * L2Norm(velocity) && gap < 10 * approach)
        reference[m] += (gap / approach) * velocity;
    }
  }

  void Restore() override { states = accepted; }

  void Close(const BitArray & macros, BaseVector & bx) override {
    CheckSize(bx.FV<double>().Size());
    auto x = bx.FV<double>();
    for (size_t m : Range(jump->Size()))
      if (macros.Test(m) && jump->area[m] > 0) {
        // just enough for a positive trial pressure
        double gap = Gap(m, jump->Mean(m, x));
        double pressure = c[m] * (fabs(gap) + 1e-6 * pow(jump->fullarea[m], 1.0 / (D - 1)));
        for (int k : Range(D))
          x(lamdof[D * m + k]) = -pressure * jump->normal[m](k);
      }
  }

  void AddScale(FlatVector<> scale) override {
    CheckSize(scale.Size());
    for (size_t m : Range(jump->Size()))
      for (int k : Range(D))
        scale(lamdof[D * m + k]) = sqrt(c[m] / RowArea(m));
  }

  shared_ptr<SparseMatrix<double>> JumpMatrix(Side side) override {
    CheckPaired();
    unique_ptr<MacroJump<D>> one; // of both sides there is one already
    if (side != Side::both)
      one = make_unique<MacroJump<D>>(u, *space, *slave, master.get(), pairing, side);
    auto & op = one ? *one : *jump;
    Array<int> rows, cols;
    Array<double> values;
    size_t offset = u.offset * u.fes->GetDimension();
    for (size_t m : Range(op.Size()))
      if (op.area[m] > 0)
        for (auto & e : op.Row(m))
          for (int k : Range(D))
            if (e.integral(k) != 0) { // D and M are both positive
              rows.Append(D * m + k);
              cols.Append(e.dof - offset);
              values.Append(side == Side::master ? -e.integral(k) : e.integral(k));
            }
    return make_shared<SparseMatrix<double>>(std::move(*SparseMatrixTM<double>::CreateFromCOO(
        rows, cols, values, D * op.Size(), u.component->GetNDof() * u.fes->GetDimension())));
  }

  Array<double> Vectors(const string & name) const override {
    CheckPaired();
    auto flat = [](FlatArray<Vec<D>> vectors) {
      Array<double> values;
      for (auto & v : vectors)
        for (int k : Range(D))
          values.Append(v(k));
      return values;
    };
    if (name == "normal")
      return flat(jump->normal);
    if (name == "center")
      return flat(jump->center);
    if (name == "moment")
      return flat(jump->moment);
    if (name == "reference")
      return flat(reference);
    throw Exception("ContactForm: no vectors named " + name);
  }

  Array<double> Scalars(const string & name) const override {
    CheckPaired();
    auto copy = [](FlatArray<double> a) { return Array<double>(a); };
    if (name == "area")
      return copy(jump->area);
    if (name == "fullarea")
      return copy(jump->fullarea);
    if (name == "c")
      return copy(c);
    if (name == "friction")
      return copy(friction);
    throw Exception("ContactForm: no scalars named " + name);
  }

  size_t NSegments() const override {
    CheckPaired();
    return pairing.Size();
  }

  SegmentTable Segments() const override {
    CheckPaired();
    return MakeSegmentTable(pairing, *slave, master.get());
  }

private:
  double RowArea(size_t m) const { return jump->area[m] > 0 ? jump->area[m] : jump->fullarea[m]; }

  double Gap(size_t m, Vec<D> mean) const {
    return -InnerProduct(jump->normal[m], mean + jump->gapvector[m]);
  }

  Vec<D> Multiplier(size_t m, FlatVector<> x) const {
    Vec<D> traction;
    for (int k : Range(D))
      traction(k) = x(lamdof[D * m + k]);
    return traction;
  }

  LawData<D> Data(size_t m) const {
    return {jump->normal[m], c[m], friction[m], threshold[m], setup.tied && jump->area[m] > 0};
  }

  /// The traction before the projection. Macro-elements without a partner stay open.
  Vec<D> Trial(size_t m, FlatVector<> x) const {
    auto & n = jump->normal[m];
    if (jump->area[m] == 0)
      return n;
    Vec<D> mean = jump->Mean(m, x);
    if (setup.tied)
      return Multiplier(m, x) - c[m] * mean;
    Vec<D> slip = mean - reference[m];
    slip -= InnerProduct(slip, n) * n;
    return Multiplier(m, x) - c[m] * (slip - Gap(m, mean) * n);
  }

  void CheckSize(size_t entries) const {
    CheckPaired();
    if (entries != mat->Height())
      throw Exception("LACContact: got " + ToString(entries) +
                      " entries, but the pairing was made "
                      "for a product space with " +
                      ToString(mat->Height()) +
                      "; after a refinement call Update() and make a new solver");
  }

  void CheckPaired() const {
    if (!jump)
      throw Exception("LACContact: no pairing yet; call Update() first");
  }

  void AddResidual(size_t m, FlatVector<> x, const Projection<D> & p, BaseVector & by) const {
    auto y = by.FV<double>();
    Vec<D> traction = Multiplier(m, x);
    Vec<D> residual = (RowArea(m) / c[m]) * (p.traction - traction);
    for (int k : Range(D))
      y(lamdof[D * m + k]) += residual(k);
    for (auto & e : jump->Row(m))
      AtomicAdd(y(e.dof), -InnerProduct(traction, e.integral));
  }

  void SetRows(size_t m, const ngbla::Mat<D, D> & derivative) {
    ngbla::Mat<D, D> by_lam = (RowArea(m) / c[m]) * (derivative - Id<D>());
    for (int k : Range(D)) {
      int row = lamdof[D * m + k];
      for (int l : Range(D))
        (*mat)(row, lamdof[D * m + l]) = by_lam(k, l);
      for (auto & e : jump->Row(m)) {
        (*mat)(row, e.dof) = -InnerProduct(Vec<D>(derivative.Row(k)), e.integral);
        if (e.integral(k) != 0)
          (*mat)(e.dof, row) = -e.integral(k);
      }
    }
  }

  void Prepare(const BaseVector & x) {
    CheckSize(x.FV<double>().Size());
    for (auto & cf : {setup.friction, setup.threshold})
      if (cf && !dynamic_pointer_cast<ConstantCoefficientFunction>(cf)) {
        FindFriction(); // a Parameter may have changed
        break;
      }
    for (double value : c)
      if (!(value > 0))
        throw Exception(
            "LACContact: the scale c is not set; call SetStiffness(bulk matrix), or let "
            "ContactSolver or FormSum do it");
  }

  void CollectMultiplierDofs() {
    lamdof.SetSize(D * space->NMacros());
    LocalHeap lh(1000 * 1000, "ngslac-multipliers");
    int block = lam.fes->GetDimension();
    Array<DofId> dofs;
    for (size_t f : Range(slave->Size())) {
      HeapReset hr(lh);
      ElementId ei(BND, slave->Element(f));
      lam.fes->GetDofNrs(ei, dofs);
      IntRange used = lam.evaluator->UsedDofs(lam.fes->GetFE(ei, lh));
      for (int k : Range(D))
        lamdof[D * space->MacroOfFace()[ei.Nr()] + k] =
            block * dofs[(used.First() + k) / block] + (used.First() + k) % block;
    }
  }

  void FindFriction() {
    auto means = [&](shared_ptr<CoefficientFunction> function, const char * name) {
      if (function)
        return MacroMeans(*function, *space, name);
      Array<double> none(space->NMacros());
      none = -1.0;
      return none;
    };
    friction = means(setup.friction, "friction");
    threshold = means(setup.threshold, "tresca");
  }
};
} // namespace

shared_ptr<ContactForm> ContactForm::Create(const ContactSetup & setup) {
  if (ProxyInfo(*setup.u, "u").fes->GetMeshAccess()->GetDimension() == 2)
    return make_shared<T_ContactForm<2>>(setup);
  return make_shared<T_ContactForm<3>>(setup);
}
} // namespace ngslac
