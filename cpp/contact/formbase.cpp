#include "formbase.hpp"
#include "macrostate.hpp"

namespace ngslac {
template <int D>
FormBase<D>::FormBase(const ContactSetup & asetup)
    : ContactForm(asetup), watch_friction(asetup.friction), watch_threshold(asetup.threshold),
      finder(setup, space, u) {}

template <int D>
Array<double> FormBase<D>::Overlaps() const {
  CheckPaired();
  return finder.Overlaps(*slave, master.get());
}

template <int D>
void FormBase<D>::Take(Paired<D> paired) {
  if (!paired.jump)
    paired.jump = make_shared<MacroJump<D>>(*space, *paired.slave, *paired.pairing);
  slave = paired.slave, master = paired.master, pairing = paired.pairing, jump = paired.jump;
  normal = jump->normal;
}

template <int D>
void FormBase<D>::Accept() {
  accepted.surfaces = {slave, master, pairing, jump};
  accepted.normal = normal;
  accepted.states = states;
}

template <int D>
void FormBase<D>::Restore() {
  CheckPaired();
  Take(accepted.surfaces);
  normal = accepted.normal;
  states = accepted.states;
}

template <int D>
void FormBase<D>::NeedRows() {
  if (!jump->HasRows())
    jump->SetRows(u, *slave, master.get(), *pairing);
}

template <int D>
std::array<size_t, 2> FormBase<D>::MeshSize() const {
  auto & ma = *u.fes->GetMeshAccess();
  return {ma.GetNE(BND), ma.GetNV()};
}

template <int D>
void FormBase<D>::Reset() {
  nscalars = NScalars();
  meshsize = MeshSize();
  Reevaluate();
  size_t n = jump->Size();
  c.SetSize(n), states.SetSize(n), reference.SetSize(n), direction.SetSize(n);
  c = 0.0;
  BeginSolve();
}

template <int D>
void FormBase<D>::SetStiffness(FlatVector<> diagonal, double factor) {
  CheckSize(diagonal.Size());
  NeedRows();
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

template <int D>
void FormBase<D>::Evaluate(const BaseVector & bx) {
  CheckSize(bx.FV<double>().Size());
  Reevaluate();
  auto x = bx.FV<double>();
  Configure(x);
  ParallelFor(jump->Size(), [&](size_t m) {
    auto place = Place(m, x);
    Vec<D> traction = Multiplier(m, x);
    auto & state = states[m];
    state.pressure = -InnerProduct(traction, place.normal);
    state.gap = place.gap;
    state.traction = 0.0, state.slip = 0.0;
    for (int k : Range(D))
      state.traction(k) = traction(k), state.slip(k) = place.slip(k);
    normal[m] = place.normal;
    state.status = Project(Data(m, place.normal), Trial(m, place, x)).status;
  });
}

template <int D>
void FormBase<D>::AddApply(const BaseVector & bx, BaseVector & by) {
  static Timer timer("ngslac::ContactForm::Apply");
  RegionTimer reg(timer);
  Prepare(bx);
  CheckSize(by.FV<double>().Size());
  auto x = bx.FV<double>(), y = by.FV<double>();
  Configure(x);
  ScatterInOrder(jump->Size(), y, [&](size_t m, LocalHeap & lh, Scatter & forces) {
    auto place = Place(m, x);
    Vec<D> traction = AddMultiplierResidual(m, x, ProjectAt(m, place, x), y);
    AddForces(m, place.normal, traction, forces, lh);
  });
}

template <int D>
void FormBase<D>::UpdateMultipliers(BaseVector & bx, double factor) {
  Prepare(bx);
  Augmentation augmentation(c, factor);
  auto x = bx.FV<double>();
  Configure(x);
  ParallelFor(jump->Size(), [&](size_t m) {
    Vec<D> traction = ProjectAt(m, Place(m, x), x).traction;
    for (int k : Range(D))
      x(lamdof[D * m + k]) = traction(k);
  });
}

namespace {
template <int D>
Array<double> Flat(const Array<Vec<D>> & vectors) {
  Array<double> values;
  for (auto & v : vectors)
    for (int k : Range(D))
      values.Append(v(k));
  return values;
}
} // namespace

template <int D>
FormHistory FormBase<D>::History() const {
  CheckPaired();
  FormHistory history;
  history["c"] = c;
  history["memory"] = Memory();
  history["reference"] = Vectors("reference");
  history["normal"] = Vectors("normal");
  history["accepted_normal"] = Flat(accepted.normal);
  for (auto & s : states)
    AppendState(history["states"], s);
  for (auto & s : accepted.states)
    AppendState(history["accepted"], s);
  return history;
}

template <int D>
void FormBase<D>::SetHistory(const FormHistory & history) {
  CheckPaired();
  auto expected = History();
  for (auto & [name, values] : expected)
    if (!history.count(name) || history.at(name).Size() != values.Size())
      throw Exception("LACContact: the saved history does not fit: '" + name + "' needs " +
                      ToString(values.Size()) + " numbers");
  auto saved = StatesFrom(history.at("states")), committed = StatesFrom(history.at("accepted"));
  c = history.at("c");
  Memory() = history.at("memory");
  for (size_t m : Range(jump->Size())) {
    for (int k : Range(D)) {
      reference[m](k) = history.at("reference")[D * m + k];
      normal[m](k) = history.at("normal")[D * m + k];
      accepted.normal[m](k) = history.at("accepted_normal")[D * m + k];
    }
  }
  states = std::move(saved);
  accepted.states = std::move(committed);
}

template <int D>
void FormBase<D>::Close(const BitArray & macros, BaseVector & bx) {
  CheckSize(bx.FV<double>().Size());
  if (macros.Size() != jump->Size())
    throw Exception("LACContact: " + ToString(macros.Size()) + " bits for " +
                    ToString(jump->Size()) + " macro-elements");
  auto x = bx.FV<double>();
  Configure(x);
  for (size_t m : Range(jump->Size()))
    if (macros.Test(m) && jump->area[m] > 0) {
      // just enough for a positive trial pressure
      auto place = Place(m, x);
      double pressure = c[m] * (fabs(place.gap) + 1e-6 * pow(jump->fullarea[m], 1.0 / (D - 1)));
      Vec<D> given = ComplianceOf(m).At(place.normal) * place.normal;
      pressure /= 1 - InnerProduct(given, place.normal);
      for (int k : Range(D))
        x(lamdof[D * m + k]) = -pressure * place.normal(k);
    }
}

template <int D>
void FormBase<D>::AddScale(FlatVector<> scale) {
  CheckSize(scale.Size());
  for (size_t m : Range(jump->Size()))
    for (int k : Range(D))
      scale(lamdof[D * m + k]) = sqrt(c[m] / RowArea(m));
}

template <int D>
shared_ptr<SparseMatrix<double>> FormBase<D>::JumpMatrix(Side side) {
  CheckPaired();
  NeedRows();
  MacroJump<D> one(*space, *slave, *pairing);
  if (side != Side::both) // of both sides there is one already
    one.SetRows(u, *slave, master.get(), *pairing, side);
  auto & op = side == Side::both ? *jump : one;
  int block = u.fes->GetDimension();
  return op.AsMatrix(u.offset * block, u.component->GetNDof() * block,
                     side == Side::master ? -1 : 1); // D and M are both positive
}

template <int D>
Array<double> FormBase<D>::Vectors(const string & name) const {
  CheckPaired();
  if (name == "normal")
    return Flat(normal);
  if (name == "center")
    return Flat(jump->center);
  if (name == "force" || name == "moment") {
    Array<double> values;
    for (size_t m : Range(jump->Size())) {
      Vec<D> traction;
      for (int k : Range(D))
        traction(k) = states[m].traction(k);
      auto [force, moment] = ResultantOf(m, traction);
      for (int k : Range(name == "force" ? D : 3))
        values.Append(name == "force" ? force(k) : moment(k));
    }
    return values;
  }
  if (name == "reference")
    return Flat(reference);
  throw Exception("ContactForm: no vectors named " + name);
}

template <int D>
Array<double> FormBase<D>::Scalars(const string & name) const {
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
  if (name == "flatness")
    return copy(jump->flatness);
  if (name == "prescribed") {
    Array<double> directions(jump->Size());
    for (size_t m : Range(directions))
      directions[m] = D - Trace(space->ReachOf(m));
    return directions;
  }
  if (name == "threshold")
    return copy(threshold);
  throw Exception("ContactForm: no scalars named " + name);
}

template <int D>
size_t FormBase<D>::NSegments() const {
  CheckPaired();
  return pairing->Size();
}

template <int D>
SegmentTable FormBase<D>::Segments() const {
  CheckPaired();
  return MakeSegmentTable(*pairing, *slave, master.get());
}

template <int D>
Vec<D> FormBase<D>::Multiplier(size_t m, FlatVector<> x) const {
  Vec<D> traction;
  for (int k : Range(D))
    traction(k) = x(lamdof[D * m + k]);
  return traction;
}

template <int D>
Vec<D> FormBase<D>::AddMultiplierResidual(size_t m, FlatVector<> x, const Projection<D> & p,
                                          FlatVector<> y) const {
  Vec<D> traction = Multiplier(m, x);
  Vec<D> residual = (RowArea(m) / c[m]) * (p.traction - traction);
  for (int k : Range(D))
    y(lamdof[D * m + k]) += residual(k);
  return traction;
}

template <int D>
Projection<D> FormBase<D>::ProjectWithMemory(size_t m, const Vec<D> & normal,
                                             const Vec<D> & trial) {
  Vec<D> now = 0.0;
  auto data = Data(m, normal);
  auto p = Project(data, trial);
  if (p.status == Status::slip && max(data.friction, data.threshold) > 0)
    now = trial - InnerProduct(trial, normal) * normal;
  if (InnerProduct(now, direction[m]) < 0) {
    p = Sticking(trial);
    now = 0.0;
  }
  direction[m] = now;
  return p;
}

template <int D>
void FormBase<D>::CheckSize(size_t entries) const {
  CheckPaired();
  if (entries != nscalars)
    throw Exception("LACContact: got " + ToString(entries) +
                    " entries, but the pairing was made "
                    "for a product space with " +
                    ToString(nscalars) +
                    "; after a refinement call Update() and make a new solver");
}

template <int D>
bool FormBase<D>::IsCurrent() const {
  return jump && meshsize == MeshSize() && nscalars == NScalars() &&
         space->NMacros() == jump->Size();
}

template <int D>
void FormBase<D>::CheckUpdated(const shared_ptr<GridFunction> & gf) const {
  if (gf && gf->GetFESpace() != u.fes)
    throw Exception("LACContact.Update: gf lives on another space than u and lam; give the one on "
                    "the product space");
  if (space->MacroOfFace().Size() != u.fes->GetMeshAccess()->GetNE(BND))
    throw Exception("LACContact.Update: the mesh was refined, but not its spaces; call Update() of "
                    "the product space first");
  if (gf && gf->GetVector().FV<double>().Size() != NScalars())
    throw Exception("LACContact.Update: gf has " + ToString(gf->GetVector().FV<double>().Size()) +
                    " entries, its space " + ToString(NScalars()) + "; call gf.Update() first");
}

template <int D>
void FormBase<D>::Prepare(const BaseVector & x) {
  CheckSize(x.FV<double>().Size());
  Reevaluate();
  for (double value : c)
    if (!(value > 0))
      throw Exception("LACContact: the scale c is not set; call SetStiffness(bulk matrix), or let "
                      "ContactSolver or FormSum do it");
}

template <int D>
void FormBase<D>::CollectMultiplierDofs(const Surface<D> & surface) {
  lamdof.SetSize(D * space->NMacros());
  LocalHeap lh(1000 * 1000, "ngslac-multipliers");
  int block = lam.fes->GetDimension();
  Array<DofId> dofs;
  for (size_t f : Range(surface.Size())) {
    HeapReset hr(lh);
    ElementId ei(BND, surface.Element(f));
    lam.fes->GetDofNrs(ei, dofs);
    IntRange used = lam.evaluator->UsedDofs(lam.fes->GetFE(ei, lh));
    for (int k : Range(D))
      lamdof[D * space->MacroOfFace()[ei.Nr()] + k] =
          block * dofs[(used.First() + k) / block] + (used.First() + k) % block;
  }
}

template <int D>
void FormBase<D>::Reevaluate() {
  auto means = [&](Watch & watch, const char * name, Array<double> & values) {
    watch.WhereChanged([&] {
      if (watch)
        values = MacroMeans(*watch, *space, name);
      else {
        values.SetSize(space->NMacros());
        values = -1.0;
      }
    });
  };
  means(watch_friction, "friction", friction);
  means(watch_threshold, "tresca", threshold);
}

template class FormBase<2>;
template class FormBase<3>;
} // namespace ngslac
