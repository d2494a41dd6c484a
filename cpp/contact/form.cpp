// SPDX-License-Identifier: LGPL-2.1-or-later
#include "form.hpp"
#include "linear/eliminate.hpp"
#include "linear/formdiagonal.hpp"

namespace ngslac {
namespace {
template <int D>
unique_ptr<Kinematics<D>> MakeKinematics(const ContactSetup & setup, shared_ptr<LACSpace> space,
                                         const ProxyInfo & u, shared_ptr<MacroLaw<D>> law) {
  if (setup.finite && setup.obstacle)
    throw Exception("LACContact: finite=True needs a master surface, or a tool in space");
  auto make = setup.tool      ? MakeToolSliding<D>
              : !setup.finite ? MakeSmallSliding<D>
              : setup.tied    ? MakeFiniteTie<D>
                              : MakeFiniteSliding<D>;
  return make(setup, space, u, law);
}
} // namespace

template <int D>
Form<D>::Form(const ContactSetup & asetup)
    : ContactForm(asetup), law(make_shared<MacroLaw<D>>(setup, space, lam)),
      kinematics(MakeKinematics<D>(setup, space, u, law)) {
  law->has_ends = setup.active;
}

template <int D>
void Form<D>::Update(shared_ptr<GridFunction> gf, const FormHistory * history) {
  static Timer timer("ngslac::ContactForm::Update");
  RegionTimer reg(timer);
  CheckUpdated(gf);
  Form fresh(setup);                                        // a failure leaves everything as it was
  fresh.Start(gf, history ? Meeting::later : Meeting::now); // of a history they have met
  if (history)
    fresh.SetHistory(*history);
  *this = std::move(fresh);
}

template <int D>
void Form<D>::Start(shared_ptr<GridFunction> gf, Meeting meeting) {
  nscalars = NScalars();
  meshsize = MeshSize();
  Vector<> x(nscalars);
  x = 0.0;
  if (gf)
    x = gf->GetVector().FV<double>();
  mat = kinematics->Start(gf, x, meeting);
  normal.SetSize(kinematics->Size()), states.SetSize(kinematics->Size());
  for (size_t m : Range(states)) {
    auto place = Place(m, x);
    normal[m] = place.normal;
    states[m] = {0, place.gap, Vec<3>(0.0), Vec<3>(0.0), Status::open};
  }
  Accept();
}

template <int D>
void Form<D>::Follow(const BaseVector & bx) {
  if (!setup.finite || !setup.active)
    return;
  CheckSize(bx.FV<double>().Size());
  Reevaluate(); // the limits of the search
  kinematics->Follow(bx.FV<double>());
  normal = kinematics->Jump().normal; // before any Evaluate
}

template <int D>
MacroPlace<D> Form<D>::Place(size_t m, FlatVector<> x) const {
  auto place = kinematics->Place(m, x);
  if (!setup.active) {
    place.gap = place.area = 0;
    place.slip = place.jump = 0.0;
    place.ends = nullptr;
  }
  return place;
}

template <int D>
void Form<D>::SetActive(bool active) {
  setup.active = law->has_ends = active;
  for (auto * table : {&states, &accepted.states})
    for (auto & state : *table)
      if (!active)
        state = {0, 0, Vec<3>(0.0), Vec<3>(0.0), Status::open};
}

// --- residual and matrices -----------------------------------------------------------------------

template <int D>
void Form<D>::AddApply(const BaseVector & bx, BaseVector & by) {
  static Timer timer("ngslac::ContactForm::Apply");
  RegionTimer reg(timer);
  Prepare(bx);
  CheckSize(by.FV<double>().Size());
  auto x = bx.FV<double>(), y = by.FV<double>();
  ParallelFor(states.Size(), [&](size_t m) {
    auto place = Place(m, x);
    law->AddResidual(m, place, law->ProjectAt(m, place, x), x, y);
  });
  kinematics->AddAllForces(x, y);
  kinematics->AddLoads(y);
}

template <int D>
void Form<D>::AssembleLinearization(const BaseVector & bx) {
  Prepare(bx);
  auto x = bx.FV<double>();
  Array<Projection<D>> projections(states.Size());
  ParallelFor(states.Size(), [&](size_t m) { projections[m] = law->ProjectAt(m, Place(m, x), x); });
  Linearize(x, projections, Rim::stays);
}

template <int D>
void Form<D>::AssembleStep(const BaseVector & bx, BaseVector & residual) {
  Prepare(bx);
  CheckSize(residual.FV<double>().Size());
  auto x = bx.FV<double>(), y = residual.FV<double>();
  Array<Projection<D>> projections(states.Size());
  ParallelFor(states.Size(), [&](size_t m) {
    auto place = Place(m, x);
    projections[m] = law->ProjectWithMemory(m, place, x);
    law->AddResidual(m, place, projections[m], x, y);
  });
  Linearize(x, projections, Rim::moves);
  kinematics->AddAllForces(x, y);
  kinematics->AddLoads(y);
}

template <int D>
shared_ptr<SparseMatrix<double>> Form<D>::AssembleSprings(const BaseVector & bx,
                                                          FlatArray<double> stiffness) {
  Prepare(bx);
  if (stiffness.Size() != D * D * states.Size())
    throw Exception("LACContact: " + ToString(stiffness.Size()) + " stiffnesses of springs for " +
                    ToString(states.Size()) + " macro-elements");
  auto x = bx.FV<double>();
  EvenPressures even(*law);
  Array<Projection<D>> projections(states.Size());
  ParallelFor(states.Size(), [&](size_t m) {
    auto & p = projections[m] = Sticking(law->Multiplier(m, x));
    p.by_normal = InnerProduct(p.traction, Place(m, x).normal) * Id<D>();
    for (int k : Range(D))
      for (int l : Range(D))
        p.derivative(k, l) = stiffness[(m * D + k) * D + l] / law->c[m];
  });
  Linearize(x, projections, Rim::moves);
  Array<double> penalties(states.Size());
  for (size_t m : Range(penalties))
    penalties[m] = law->c[m] / kinematics->Jump().RowArea(m);
  return EliminateMultipliers(*mat, law->dofs, D, penalties);
}

template <int D>
void Form<D>::Linearize(FlatVector<> x, FlatArray<Projection<D>> projections, Rim rim) {
  static Timer timer("ngslac::ContactForm::Linearize");
  RegionTimer reg(timer);
  Array<Vec<D>> tractions(states.Size());
  for (size_t m : Range(tractions))
    tractions[m] = law->Multiplier(m, x);
  mat = kinematics->Linearize(x, projections, tractions, rim);
}

template <int D>
void Form<D>::Close(const BitArray & macros, BaseVector & bx) {
  CheckSize(bx.FV<double>().Size());
  if (macros.Size() != states.Size())
    throw Exception("LACContact: " + ToString(macros.Size()) + " bits for " +
                    ToString(states.Size()) + " macro-elements");
  auto x = bx.FV<double>();
  kinematics->At(x);
  for (size_t m : Range(states)) {
    auto place = Place(m, x);
    if (!macros.Test(m) || place.area == 0)
      continue;
    // just enough for a positive trial pressure
    double size = pow(kinematics->Jump().fullarea[m], 1.0 / (D - 1));
    double c = max(law->c[m], law->end_c[m]);
    double pressure = c * (fabs(place.gap) + 1e-6 * size);
    Vec<D> given = law->ComplianceOf(m).At(place.normal) * place.normal;
    pressure /= 1 - InnerProduct(given, place.normal);
    for (int k : Range(D))
      x(law->dofs[D * m + k]) = -pressure * place.normal(k);
  }
}

// --- lean ----------------------------------------------------------------------------------------

template <int D>
void Form<D>::Lean(FlatArray<double> vectors) {
  CheckPaired();
  if (vectors.Size() && vectors.Size() != D * states.Size())
    throw Exception("LACContact: " + ToString(vectors.Size()) + " numbers of vectors for " +
                    ToString(states.Size()) + " macro-elements");
  kinematics->Lean(vectors);
}

// --- scales --------------------------------------------------------------------------------------

template <int D>
void Form<D>::SetStiffness(FlatVector<> diagonal, double factor) {
  CheckSize(diagonal.Size());
  SetScales(kinematics->JumpWithRows(), diagonal, factor);
  auto & c = law->c;
  if (std::none_of(c.begin(), c.end(), [](double value) { return value > 0; })) {
    // nothing has a partner yet: the slave alone tells the size
    auto & slave = *kinematics->Surfaces().slave;
    auto all = PairWithObstacle<D>(slave, 2 * u.Order(slave));
    MacroJump<D> whole(*space, slave, all);
    whole.SetRows(u, slave, nullptr, all);
    SetScales(whole, diagonal, factor);
  }
  FillScales(factor);
  law->end_c = law->c; // until more is learnt
}

template <int D>
void Form<D>::SetScales(const MacroJump<D> & jump, FlatVector<> diagonal, double factor) {
  for (size_t m : Range(jump.Size())) {
    double compliance = 0;
    for (auto & e : jump.Row(m))
      if (diagonal(e.dof) > 0)
        compliance += L2Norm2(e.integral) / (D * diagonal(e.dof));
    law->c[m] = compliance > 0 ? factor * jump.area[m] / compliance : 0;
  }
}

/// A macro-element without a partner still needs a regular row of the right size.
template <int D>
void Form<D>::FillScales(double otherwise) {
  double sum = 0;
  int known = 0;
  for (double value : law->c)
    sum += value, known += value > 0;
  for (double & value : law->c)
    if (value == 0)
      value = known ? sum / known : otherwise;
}

template <int D>
void Form<D>::LearnStiffness(FlatVector<> diagonal) {
  CheckSize(diagonal.Size());
  kinematics->LearnStiffness(diagonal);
}

template <int D>
void Form<D>::LearnStiffness(const BilinearForm & bulk) {
  CheckSize(u.fes->GetDimension() * bulk.GetFESpace()->GetNDof());
  auto & [slave, master, pairing, jump] = kinematics->Surfaces();
  if (!master) // what is rigid is stiffer
    return;
  BitArray wanted(bulk.GetFESpace()->GetNDof());
  wanted.Clear();
  Array<DofId> dofs;
  for (auto & surface : {slave, master})
    for (size_t face : Range(surface->Size())) {
      u.fes->GetDofNrs(ElementId(BND, surface->Element(face)), dofs);
      for (DofId dof : dofs)
        if (IsRegularDof(dof))
          wanted.SetBit(dof);
    }
  kinematics->LearnStiffness(FormDiagonal(bulk, wanted));
}

template <int D>
void Form<D>::AddScale(FlatVector<> scale) {
  CheckSize(scale.Size());
  for (size_t m : Range(states))
    for (int k : Range(D))
      scale(law->dofs[D * m + k]) = sqrt(law->c[m] / kinematics->Jump().RowArea(m));
  for (int i : Range(ToolDofs())) { // as if all of the slave were in contact, and elastic
    double stiffness = 0;
    for (size_t m : Range(states))
      stiffness +=
          law->c[m] / kinematics->Jump().RowArea(m) * L2Norm2(kinematics->ToolIntegral(m, i));
    scale(ToolDofs()[i]) = stiffness > 0 ? 1 / sqrt(stiffness) : 1;
  }
}

// --- checks --------------------------------------------------------------------------------------

template <int D>
std::array<size_t, 2> Form<D>::MeshSize() const {
  auto & ma = *u.fes->GetMeshAccess();
  return {ma.GetNE(BND), ma.GetNV()};
}

template <int D>
bool Form<D>::IsCurrent() const {
  return IsPaired() && meshsize == MeshSize() && nscalars == NScalars() &&
         space->NMacros() == states.Size();
}

template <int D>
void Form<D>::CheckSize(size_t entries) const {
  CheckPaired();
  if (entries != nscalars)
    throw Exception("LACContact: got " + ToString(entries) +
                    " entries, but the pairing was made "
                    "for a product space with " +
                    ToString(nscalars) +
                    "; after a refinement call Update() and make a new solver");
}

template <int D>
void Form<D>::CheckUpdated(const shared_ptr<GridFunction> & gf) const {
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
void Form<D>::Reevaluate() {
  law->Reevaluate();
  kinematics->Reevaluate();
}

template <int D>
void Form<D>::Prepare(const BaseVector & x) {
  CheckSize(x.FV<double>().Size());
  Reevaluate();
  for (double value : law->c)
    if (!(value > 0))
      throw Exception("LACContact: the scale c is not set; call SetStiffness(bulk matrix), or let "
                      "ContactSolver or FormSum do it");
  kinematics->At(x.FV<double>());
}

template class Form<2>;
template class Form<3>;
} // namespace ngslac
