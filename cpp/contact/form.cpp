// SPDX-License-Identifier: LGPL-2.1-or-later
#include "interfaceflow.hpp"
#include "linear/formdiagonal.hpp"
#include "ownlaw.hpp"

namespace ngslac {
namespace {
template <int D>
unique_ptr<Kinematics<D>> MakeKinematics(const KinematicsParts<D> & parts) {
  if (parts.setup.finite && parts.setup.obstacle)
    throw Exception("LACContact: finite=True needs a master surface, or a tool in space");
  if (parts.path)
    return MakeToolSliding<D>(parts);
  return parts.setup.finite ? MakeFiniteSliding<D>(parts) : MakeSmallSliding<D>(parts);
}

/// A contact form: a law, and the kinematics that locate the macro-elements.
template <int D>
class Form final : public ContactForm {
public:
  explicit Form(const ContactSetup & asetup)
      : ContactForm(asetup), law(make_shared<MacroLaw<D>>(setup, space, lam)),
        tool(setup.tool ? make_shared<ToolPath<D>>(*setup.tool, u) : nullptr),
        kinematics(MakeKinematics<D>({setup, space, u, law, tool})), flow(setup, law, u) {
    law->has_ends = setup.active;
  }

  void Update(shared_ptr<GridFunction> gf, const NamedNumbers * history) override {
    static Timer timer("ngslac::ContactForm::Update");
    RegionTimer reg(timer);
    CheckUpdated(gf);
    Form fresh(setup); // a failure leaves everything as it was
    fresh.Start(gf, history ? Meeting::later : Meeting::now); // of a history they have met
    if (history)
      fresh.SetHistory(*history);
    *this = std::move(fresh);
  }

  void Follow(const BaseVector & bx) override {
    if (!setup.finite || !setup.active)
      return;
    CheckSize(bx.FV<double>().Size());
    law->Reevaluate();  // the limits of the search
    if (law->Gives()) { // how deep partners may be, at these pressures
      kinematics->At(bx.FV<double>());
      Look(bx.FV<double>(), law->Multipliers(bx.FV<double>()), Want::values);
    }
    kinematics->Follow(bx.FV<double>());
    normal = kinematics->Jump().normal; // before any Evaluate
  }

  void SetStiffness(FlatVector<> diagonal, double factor) override {
    CheckSize(diagonal.Size());
    SetScales(kinematics->JumpWithRows(), diagonal, factor);
    auto & c = law->c;
    if (std::none_of(c.begin(), c.end(), [](double value) { return value > 0; })) {
      // nothing has a partner yet: the size is that of the slave alone
      auto & slave = *kinematics->Surfaces().slave;
      auto all = PairWithObstacle<D>(slave, 2 * u.Order(slave));
      MacroJump<D> whole(*space, slave, all);
      whole.SetRows(u, slave, nullptr, all);
      SetScales(whole, diagonal, factor);
    }
    FillScales(factor);
    law->end_c = law->c; // until more is learnt
  }

  void LearnStiffness(FlatVector<> diagonal) override {
    CheckSize(diagonal.Size());
    kinematics->LearnStiffness(diagonal);
  }
  void LearnStiffness(const BilinearForm & bulk) override {
    CheckSize(u.fes->GetDimension() * bulk.GetFESpace()->GetNDof());
    auto & surfaces = kinematics->Surfaces();
    if (!surfaces.master) // what is rigid is stiffer
      return;
    BitArray wanted(bulk.GetFESpace()->GetNDof());
    wanted.Clear();
    Array<DofId> dofs;
    for (auto & surface : {surfaces.slave, surfaces.master})
      for (size_t face : Range(surface->Size())) {
        u.fes->GetDofNrs(ElementId(BND, surface->Element(face)), dofs);
        for (DofId dof : dofs)
          if (IsRegularDof(dof))
            wanted.SetBit(dof);
      }
    kinematics->LearnStiffness(FormDiagonal(bulk, wanted));
  }

  void SetConstant(double value) override { law->c = law->end_c = value; }
  void AddApply(const BaseVector & bx, BaseVector & by) override {
    static Timer timer("ngslac::ContactForm::Apply");
    RegionTimer reg(timer);
    Prepare(bx);
    CheckSize(by.FV<double>().Size());
    auto x = bx.FV<double>();
    AddResidual(x, Answers(x, Want::values), by.FV<double>());
  }

  void AssembleLinearization(const BaseVector & bx) override {
    Prepare(bx);
    auto x = bx.FV<double>();
    Linearize(x, Answers(x, Want::derivatives), law->Multipliers(x), Rim::stays);
  }
  void AssembleStep(const BaseVector & bx, BaseVector & residual, bool convex) override {
    Prepare(bx);
    CheckSize(residual.FV<double>().Size());
    auto x = bx.FV<double>();
    auto answers = Answers(x, Want::step);
    growth.SetSize(IsScalar() ? answers.Size() : 0);
    for (size_t m : Range(growth))
      growth[m] = answers[m].by_jump(0, 0);
    for (size_t m : Range(convex ? answers.Size() : 0))
      answers[m].by_jump = WithoutSoftening(m, answers[m]);
    Linearize(x, answers, law->Multipliers(x), Rim::moves);
    AddResidual(x, answers, residual.FV<double>());
  }

  bool Softens(const BaseVector & bx) override {
    Prepare(bx);
    const double small = 1e-12;
    auto answers = Answers(bx.FV<double>(), Want::derivatives);
    for (size_t m : Range(answers)) {
      auto & by_jump = answers[m].by_jump;
      ngbla::Mat<D, D> softening = WithoutSoftening(m, answers[m]) - by_jump;
      if (L2Norm(softening) > small * L2Norm(by_jump))
        return true;
    }
    return false;
  }

  void BeginSolve() override { law->BeginSolve(); }
  void Evaluate(const BaseVector & bx) override {
    CheckSize(bx.FV<double>().Size());
    law->Reevaluate();
    auto x = bx.FV<double>();
    kinematics->At(x);
    auto answers = Answers(x, Want::values);
    ParallelFor(states.Size(), [&](size_t m) {
      auto place = Place(m);
      auto & state = states[m];
      state.status = answers[m].status;
      // The multiplier of an open macro-element holds only rounding, or part of an iteration.
      bool acts = setup.active && state.status != Status::open;
      Vec<D> traction = acts ? law->Multiplier(m, x) : Vec<D>(0.0);
      // A scalar field has no direction: no pressure, no gap.
      state.pressure = IsScalar() ? 0.0 : 0.0 - InnerProduct(traction, place.normal); // no -0
      state.gap = IsScalar() ? 0 : place.gap;
      state.traction = 0.0, state.slip = 0.0;
      for (int k : Range(D))
        state.traction(k) = traction(k), state.slip(k) = IsScalar() ? 0 : place.slip(k);
      normal[m] = place.normal;
    });
    for (auto & [name, values] : flowing)
      for (size_t m : Range(values))
        values[m] = Place(m).area > 0 ? law->Flowing().at(name)[m] : 0;
    Forget();
    if (setup.active && kept.size()) {
      present = setup.law ? NamedNumbers() : law->Remembered();
      looked = setup.law ? WithKept(Places(x)) : NamedNumbers();
    }
  }

  void Lean(FlatArray<double> vectors) override {
    CheckPaired();
    if (vectors.Size() && vectors.Size() != D * states.Size())
      throw Exception("LACContact: " + ToString(vectors.Size()) + " numbers of vectors for " +
                      ToString(states.Size()) + " macro-elements");
    if (!kinematics->Surfaces().master || setup.tied)
      return; // pressures of tools and tied surfaces keep their directions
    law->lean.SetSize(vectors.Size() / D);
    LoadVectors<D>(vectors, law->lean);
  }

  void SetFlowShare(double share) override { setup.flowshare = flow.share = share; }
  void SetEven(bool even) override { law->has_ends = setup.active && !even; }
  void Commit(const BaseVector & bx) override {
    Follow(bx);
    Evaluate(bx);
    kept = Kept();
    Forget();
    if (setup.active)
      kinematics->Commit(bx.FV<double>(), accepted.states, states);
    Accept();
  }

  void Restore() override {
    CheckPaired();
    kinematics->Restore();
    normal = accepted.normal;
    states = accepted.states;
    flowing = accepted.flowing;
    Forget();
  }

  NamedNumbers GetHistory() override {
    CheckPaired();
    NamedNumbers numbers;
    Exchange({numbers, false});
    for (auto & s : states)
      AppendState(numbers["states"], s);
    for (auto & s : accepted.states)
      AppendState(numbers["accepted"], s);
    return numbers;
  }

  void SetHistory(NamedNumbers numbers) override {
    for (auto & [name, values] : GetHistory())
      if (!numbers.count(name) || numbers.at(name).Size() != values.Size())
        throw Exception("LACContact: the saved history does not fit: '" + name + "' needs " +
                        ToString(values.Size()) + " numbers");
    auto saved = StatesFrom(numbers.at("states")), committed = StatesFrom(numbers.at("accepted"));
    Exchange({numbers, true});
    states = std::move(saved);
    accepted.states = std::move(committed);
    Forget();
  }

  void AddForces(const BaseVector & bx, FlatArray<double> tractions, BaseVector & by) override {
    Prepare(bx);
    CheckSize(by.FV<double>().Size());
    EvenPressures even(*law);
    Look(bx.FV<double>(), Tractions(tractions), Want::values);
    AddForces(Tractions(tractions), by.FV<double>());
  }

  shared_ptr<SparseMatrix<double>> Matrix(const BaseVector & bx, FlatArray<double> flat,
                                          FlatArray<double> stiffness) override {
    Prepare(bx);
    if (stiffness.Size() != D * D * states.Size())
      throw Exception("LACContact: " + ToString(stiffness.Size()) + " stiffnesses of springs for " +
                      ToString(states.Size()) + " macro-elements");
    EvenPressures even(*law);
    auto tractions = Tractions(flat);
    Array<Answer<D>> answers(states.Size());
    ParallelFor(states.Size(), [&](size_t m) {
      auto & answer = answers[m];
      answer.traction = tractions[m];
      answer.by_normal = InnerProduct(tractions[m], Place(m).normal) * Id<D>();
      for (int k : Range(D))
        for (int l : Range(D))
          answer.by_jump(k, l) = -stiffness[(m * D + k) * D + l];
    });
    auto x = bx.FV<double>();
    Look(x, tractions, Want::derivatives);
    auto flows = LinesOfBoth(x, answers, tractions, Rim::moves, true);
    auto alone = WithoutMultipliers();
    return flows ? Sum(*alone, *flows) : alone;
  }

  void Close(const BitArray & macros, BaseVector & bx) override {
    CheckSize(bx.FV<double>().Size());
    if (macros.Size() != states.Size())
      throw Exception("LACContact: " + ToString(macros.Size()) + " bits for " +
                      ToString(states.Size()) + " macro-elements");
    auto x = bx.FV<double>();
    kinematics->At(x);
    for (size_t m : Range(states)) {
      auto place = Place(m);
      if (!macros.Test(m) || place.area == 0)
        continue;
      // just enough for a positive trial pressure
      double size = kinematics->Jump().Size(m);
      double c = max(law->c[m], law->end_c[m]);
      double pressure = c * (fabs(place.gap) + 1e-6 * size);
      Vec<D> compliance = law->ComplianceOf(m).At(place.normal) * place.normal;
      pressure /= 1 - InnerProduct(compliance, place.normal);
      for (int k : Range(D))
        x(law->Dofs(m)[k]) = -pressure * place.normal(k);
    }
  }

  void AddScale(FlatVector<> scale) override {
    CheckSize(scale.Size());
    for (size_t m : Range(states))
      for (int dof : law->Dofs(m))
        scale(dof) = sqrt(law->c[m] / kinematics->Jump().RowArea(m));
    for (int i : Range(ToolDofs())) { // as if all of the slave were in contact, and elastic
      double stiffness = 0;
      for (size_t m : Range(states))
        stiffness += law->c[m] / kinematics->Jump().RowArea(m) * L2Norm2(ToolIntegral(m, i));
      scale(ToolDofs()[i]) = stiffness > 0 ? 1 / sqrt(stiffness) : 1;
    }
  }

  shared_ptr<SparseMatrix<double>> JumpMatrix(Side side) override {
    CheckPaired();
    auto & surfaces = kinematics->Surfaces();
    MacroJump<D> one(*space, *surfaces.slave, *surfaces.pairing);
    if (side != Side::both) // of both sides there is one already
      one.SetRows(u, *surfaces.slave, surfaces.master.get(), *surfaces.pairing, side);
    auto & op = side == Side::both ? kinematics->JumpWithRows() : one;
    int block = u.fes->GetDimension();
    return op.AsMatrix(u.offset * block, u.component->GetNDof() * block, law->Components(),
                       side == Side::master ? -1 : 1); // D and M are both positive
  }

  size_t JumpNumber() const override {
    CheckPaired();
    return kinematics->JumpWithRows().Number();
  }

  NamedNumbers Table() const override {
    CheckPaired();
    auto & jump = kinematics->Jump();
    NamedNumbers table;
    for (auto & [name, values] :
         std::map<string, const Array<double> *>{{"area", &jump.area},
                                                 {"fullarea", &jump.fullarea},
                                                 {"flatness", &jump.flatness},
                                                 {"c", &law->c},
                                                 {"friction", &law->friction},
                                                 {"tresca", &law->threshold},
                                                 {"offset", &law->offset}})
      table[name] = *values;
    if (!setup.active)
      table["area"] = 0.0;
    SaveVectors<D>(table["normal"], normal);
    SaveVectors<D>(table["slave_normal"], jump.normal);
    SaveVectors<D>(table["center"], jump.center);
    SaveVectors<D>(table["reference"], kinematics->Reference());
    table.insert(flowing.begin(), flowing.end());
    for (auto & each : law->Flows())
      for (size_t m : Range(states)) {
        for (string end : {"out", "in"})
          table[each.name + "growth_" + end].Append(law->GrowthOf(each, end.c_str(), m));
        table[each.name + "jump"].Append(flow.JumpOf(m, each.field));
      }
    for (size_t m : Range(states)) {
      auto & state = states[m];
      auto place = kinematics->Place(m);
      AppendVector<D>(table["facing"], place.facing);
      table["ends"].Append(place.end);
      table["size"].Append(jump.Size(m));
      table["prescribed"].Append(D - Trace(space->ReachOf(m)));
      table["pressure"].Append(state.pressure);
      if (IsScalar()) {
        table["jump"].Append(place.jump(0));
        table["growth"].Append(growth.Size() ? growth[m] : 0);
      }
      table["gap"].Append(state.gap);
      table["status"].Append(double(state.status));
      for (int k : Range(D)) {
        table["traction"].Append(state.traction(k));
        table["slip"].Append(state.slip(k));
      }
    }
    return table;
  }

  NamedNumbers Resultants() const override {
    CheckPaired();
    NamedNumbers table;
    for (size_t m : Range(states)) {
      Vec<D> traction;
      for (int k : Range(D))
        traction(k) = states[m].traction(k);
      auto [force, moment] = kinematics->ResultantOf(m, traction);
      AppendVector<D>(table["force"], force);
      AppendVector<3>(table["moment"], moment);
    }
    return table;
  }

  NamedNumbers Kept() const override {
    if (present.empty() && looked.empty())
      return kept;
    auto found = looked.empty() ? present : AnswerTo<D>(setup.law, looked, kept, Asked());
    return KeptAfter(kinematics->Jump().area, kept, found);
  }
  void KeepFrom(const ContactForm & other) override {
    kept = static_cast<const Form &>(other).kept;
    Forget();
  }
  void Reevaluate() override { law->Reevaluate(); }
  SegmentTable Segments() const override {
    CheckPaired();
    auto & surfaces = kinematics->Surfaces();
    return MakeSegmentTable(*surfaces.pairing, *surfaces.slave, surfaces.master.get());
  }

  Array<double> Points() const override {
    CheckPaired();
    auto & surfaces = kinematics->Surfaces();
    return MakePointTable(*surfaces.pairing, *surfaces.slave, surfaces.master.get());
  }
  size_t NSegments() const override {
    CheckPaired();
    return kinematics->Surfaces().pairing->Size();
  }
  Array<double> Depths() const override {
    CheckPaired();
    auto & surfaces = kinematics->Surfaces();
    return kinematics->Finder().Depths(*surfaces.slave, *surfaces.master);
  }
  Array<double> Overlaps() const override {
    CheckPaired();
    auto & slave = *kinematics->Surfaces().slave;
    auto & jump = kinematics->Jump();
    BitArray faces(slave.Size()); // whose macro-elements are not paired, or in part only
    faces.Clear();
    for (size_t f : Range(slave.Size()))
      if (int m = space->MacroOfFace()[slave.Element(f)];
          setup.active && jump.area[m] < (1 - 1e-6) * jump.fullarea[m])
        faces.SetBit(f);
    auto * master = kinematics->Surfaces().master.get();
    return kinematics->Finder().Overlaps(slave, master, law->Margin(), faces);
  }

  Array<double> GapRanges(FlatVector<> x) override {
    CheckSize(x.Size());
    law->Reevaluate();
    kinematics->At(x);
    Array<double> table;
    auto ranges = kinematics->GapRanges(x);
    for (size_t m : Range(ranges)) {
      bool paired = setup.active && kinematics->Jump().area[m] > 0;
      auto range = paired ? ranges[m] : GapRange<D>();
      table += Array<double>{range.least, range.greatest};
      for (auto & place : {range.near, range.far})
        for (int k : Range(D))
          table.Append(place(k));
    }
    return table;
  }

  std::vector<pair<shared_ptr<FESpace>, size_t>> Scalars() const override { return flow.Spaces(); }
  FlatArray<int> MultiplierDofs() const override { return law->dofs; }
  void SetActive(bool active) override {
    setup.active = law->has_ends = active;
    for (auto * table : {&states, &accepted.states})
      for (auto & state : *table)
        if (!active)
          state = {0, 0, Vec<3>(0.0), Vec<3>(0.0), Status::open};
    for (auto * table : {&flowing, &accepted.flowing})
      for (auto & [name, values] : *table)
        if (!active)
          values = 0.0;
  }

  FlatArray<int> ToolDofs() const override { return tool ? tool->Dofs() : FlatArray<int>(); }
  Array<double> ToolRows() const override {
    CheckPaired();
    Array<double> rows;
    for (size_t m : Range(states))
      for (int k : Range(D))
        for (int i : Range(ToolDofs()))
          rows.Append(-ToolIntegral(m, i)(k));
    return rows;
  }

  bool IsCurrent() const override {
    return IsPaired() && meshsize == MeshSize() && nscalars == NScalars() &&
           space->NMacros() == states.Size();
  }

private:
  void Start(shared_ptr<GridFunction> gf, Meeting meeting) {
    nscalars = NScalars();
    meshsize = MeshSize();
    Vector<> x(nscalars);
    x = 0.0;
    if (gf)
      x = gf->GetVector().FV<double>();
    kinematics->Start(gf, x, meeting);
    mat = make_shared<SparseMatrix<double>>(0, 0);
    normal.SetSize(kinematics->Size()), states.SetSize(kinematics->Size());
    for (size_t m : Range(states)) {
      auto place = Place(m);
      normal[m] = place.normal;
      states[m] = {0, place.gap, Vec<3>(0.0), Vec<3>(0.0), Status::open};
      for (auto & [name, start] : setup.kept)
        kept[name] += start;
    }
    for (auto & each : law->Flows())
      for (const char * end : {"out", "in"}) {
        auto & values = flowing[each.name + end];
        values.SetSize(states.Size());
        values = 0.0;
      }
    Accept();
  }

  /// Switched off, there is no partner.
  MacroPlace<D> Place(size_t m) const {
    auto place = kinematics->Place(m);
    if (!setup.active) {
      place.gap = place.area = 0;
      place.slip = place.jump = 0.0;
      place.ends = nullptr;
    }
    return place;
  }

  /// Stores the present state as that of a committed step.
  void Accept() {
    accepted.normal = normal;
    accepted.states = states;
    accepted.flowing = flowing;
  }
  void Exchange(History history) {
    history.Exchange("c", law->c);
    if (setup.adjust > 0)
      history.Exchange("adjusted", law->adjusted);
    kinematics->Exchange(history);
    history.Exchange("reference", kinematics->Reference());
    history.Exchange("normal", normal);
    history.Exchange("accepted_normal", accepted.normal);
    for (auto & [name, values] : flowing) {
      history.Exchange(name, values);
      history.Exchange("accepted_" + name, accepted.flowing[name]);
    }
    for (auto & [name, values] : kept)
      history.Exchange("law: " + name, values);
  }

  /// Throws unless these are the entries of a vector on the space that was paired.
  void CheckSize(size_t entries) const {
    CheckPaired();
    if (entries != nscalars)
      throw Exception("LACContact: got " + ToString(entries) +
                      " entries, but the pairing was made "
                      "for a product space with " +
                      ToString(nscalars) +
                      "; after a refinement call Update() and make a new solver");
  }

  /// Throws where a pairing could not be made: of mesh, space and gf.
  void CheckUpdated(const shared_ptr<GridFunction> & gf) const {
    if (gf && gf->GetFESpace() != u.fes)
      throw Exception(
          "LACContact.Update: gf lives on another space than u and lam; give the one on "
          "the product space");
    if (space->MacroOfFace().Size() != u.fes->GetMeshAccess()->GetNE(BND))
      throw Exception(
          "LACContact.Update: the mesh was refined, but not its spaces; call Update() of "
          "the product space first");
    if (gf && gf->GetVector().FV<double>().Size() != NScalars())
      throw Exception("LACContact.Update: gf has " + ToString(gf->GetVector().FV<double>().Size()) +
                      " entries, its space " + ToString(NScalars()) + "; call gf.Update() first");
  }

  /// The scale c of macro-elements with a partner, 0 for the others.
  void SetScales(const MacroJump<D> & jump, FlatVector<> diagonal, double factor) {
    for (size_t m : Range(jump.Size())) {
      double compliance = jump.Compliance(m, diagonal);
      law->c[m] = compliance > 0 ? factor * jump.area[m] / compliance : 0;
    }
  }

  /// A macro-element without a partner still needs a regular row of the right size.
  void FillScales(double otherwise) {
    double sum = 0;
    int known = 0;
    for (double value : law->c)
      sum += value, known += value > 0;
    for (double & value : law->c)
      if (value == 0)
        value = known ? sum / known : otherwise;
  }

  /// Evaluates the kinematics at x, and sets scales for the law.
  void Prepare(const BaseVector & x) {
    CheckSize(x.FV<double>().Size());
    law->Reevaluate();
    for (double value : law->c)
      if (!(value > 0))
        throw Exception(
            "LACContact: the scale c is not set; call SetStiffness(bulk matrix), or let "
            "ContactSolver or FormSum do it");
    kinematics->At(x.FV<double>());
  }

  /// Which parts of an answer are needed; a step uses the slip directions of the one before.
  enum class Want { values, derivatives, step };
  /// The answers of the law at x.
  Array<Answer<D>> Answers(FlatVector<> x, Want want) {
    Look(x, law->Multipliers(x), want);
    if (setup.law)
      return AnswersOf<D>(setup.law, WithKept(Places(x)), kept, Asked());
    Array<Answer<D>> answers(states.Size());
    ParallelFor(answers.Size(), [&](size_t m) {
      auto place = Place(m);
      answers[m] = want == Want::step ? law->AtStep(m, place, x) : law->At(m, place, x);
      if (law->Depends() && want != Want::values)
        law->AddSlopes(m, place, x, answers[m]);
    });
    return answers;
  }

  /// The derivative of an answer by the jump, as a descent has it.
  ngbla::Mat<D, D> WithoutSoftening(size_t m, const Answer<D> & answer) const {
    return Resisting<D>(answer.by_jump, InnerProduct(answer.traction, Place(m).normal) > 0);
  }

  /// Evaluates what depends on the fields of the contact, under these tractions.
  void Look(FlatVector<> x, FlatArray<Vec<D>> tractions, Want want) {
    if (!law->Depends())
      return;
    flow.Look(*kinematics, *space, x);
    auto values = [&](size_t m) {
      auto place = Place(m);
      Vector<> numbers(2 * D + 2 + flow.NMeans());
      numbers.Range(0, D) = place.slip;
      numbers(D) = place.area > 0 ? place.gap : 0;
      // not 0, where a power of it has no derivative
      numbers(D + 1) = max(1e-150, -InnerProduct(place.normal, tractions[m]));
      numbers.Range(D + 2, 2 * D + 2) = tractions[m];
      numbers.Range(2 * D + 2, numbers.Size()) = flow.Means(m);
      return numbers;
    };
    law->DependOn(values, kept, want != Want::values);
  }

  bool IsScalar() const { return law->Components() == 1; }
  AskedLaw Asked() const { return {setup.tied, law->Components()}; }
  /// The arguments of a law in place of the compiled one, without what it keeps.
  NamedNumbers Places(FlatVector<> x) const {
    NamedNumbers places;
    places["c"] = law->c;
    SaveVectors<D>(places["x"], kinematics->Jump().center);
    for (size_t m : Range(states)) {
      auto place = Place(m);
      if (!setup.tied) { // else the whole jump counts
        places["gap"].Append(place.gap);
        AppendVector<D>(places["slip"], place.slip);
      }
      if ((!setup.tied || !setup.finite) && !IsScalar()) // else it has no derivative
        AppendVector<D>(places["normal"], place.normal);
      places["area"].Append(place.area);
      Vec<D> trial = law->Multiplier(m, x) - law->c[m] * place.jump;
      for (int k : Range(law->Components()))
        places["jump"].Append(place.jump(k)), places["trial"].Append(trial(k));
    }
    return places;
  }

  /// The memory is that of the last committed step again.
  void Forget() { present.clear(), looked.clear(); }

  NamedNumbers WithKept(NamedNumbers places) const {
    places.insert(kept.begin(), kept.end());
    return places;
  }

  Array<Vec<D>> Tractions(FlatArray<double> flat) const {
    if (flat.Size() != D * states.Size())
      throw Exception("LACContact: " + ToString(flat.Size()) + " numbers of tractions for " +
                      ToString(states.Size()) + " macro-elements");
    Array<Vec<D>> tractions(states.Size());
    LoadVectors<D>(flat, tractions);
    return tractions;
  }

  /// The multipliers are the tractions, and their rows determine them.
  void AddResidual(FlatVector<> x, FlatArray<Answer<D>> answers, FlatVector<> y) {
    auto tractions = law->Multipliers(x);
    ParallelFor(states.Size(), [&](size_t m) {
      Vec<D> left = law->RowFactor(m, Place(m)) * Vec<D>(answers[m].traction - tractions[m]);
      auto own = law->Dofs(m);
      for (int k : Range(own))
        y(own[k]) += left(k);
    });
    AddForces(tractions, y);
  }

  void AddForces(FlatArray<Vec<D>> tractions, FlatVector<> y) {
    ScatterInOrder(states.Size(), y, [&](size_t m, LocalHeap & lh, Scatter & forces) {
      kinematics->AddForces(m, tractions[m], forces, lh);
    });
    for (size_t m : Range(law->Flows().Size() ? states.Size() : 0))
      if (Place(m).area > 0)
        flow.AddFlows(m, y);
    if (tool)
      tool->AddLoads(y);
  }

  /// The matrix for these answers of the law, with the forces of these tractions.
  void Linearize(FlatVector<> x, FlatArray<Answer<D>> answers, FlatArray<Vec<D>> tractions,
                 Rim rim) {
    if (auto flows = LinesOfBoth(x, answers, tractions, rim, false))
      mat = Sum(*mat, *flows);
  }

  /// Makes the matrix of tractions and multipliers, and returns that of scalar fields, null without
  /// any; alone: where multipliers follow the places.
  shared_ptr<SparseMatrix<double>> LinesOfBoth(FlatVector<> x, FlatArray<Answer<D>> answers,
                                               FlatArray<Vec<D>> tractions, Rim rim, bool alone) {
    static Timer timer("ngslac::ContactForm::Linearize");
    RegionTimer reg(timer);
    auto fresh = kinematics->ZeroMatrix(tractions, nscalars);
    size_t heap = BlockHeap<D>(kinematics->Surfaces().slave->Degree());
    Array<BlockSum> flows(flow.NMeans() ? states.Size() : 0);
    AddBlocksInOrder(states.Size(), *fresh, heap, [&](size_t m, LocalHeap & lh, BlockSum & sum) {
      auto rows = kinematics->RowsOf(m, tractions[m], rim, sum, lh);
      AddLines(m, answers[m], rows, sum);
      if (flows.Size())
        flows[m] =
            flow.LinesOf(*kinematics, {m, Place(m), tractions[m], answers[m], rows}, alone, x, lh);
    });
    mat = fresh;
    return flows.Size() ? MatrixOf(nscalars, flows) : nullptr;
  }

  /// The matrix of the displacements alone: the rows of the multipliers determine the tractions,
  /// and their product with the columns is added. These rows stay empty.
  shared_ptr<SparseMatrix<double>> WithoutMultipliers() const {
    const SparseMatrix<double> & from = *mat; // reads 0 where there is no entry
    BitArray ismultiplier(nscalars);
    ismultiplier.Clear();
    for (int lam : law->dofs)
      ismultiplier.SetBit(lam);
    Array<GraphBlock> blocks(states.Size());
    for (size_t m : Range(blocks)) {
      auto & dofs = blocks[m].rows;
      for (int dof : from.GetRowIndices(law->Dofs(m)[0]))
        if (!ismultiplier.Test(dof))
          dofs.Append(dof);
      blocks[m].columns = dofs;
    }
    auto result = ZeroMatrix(nscalars, blocks);
    ParallelFor(nscalars, [&](size_t i) {
      auto columns = from.GetRowIndices(i);
      for (size_t j : Range(ismultiplier.Test(i) ? 0 : columns.Size()))
        if (!ismultiplier.Test(columns[j]))
          (*result)(i, columns[j]) = from.GetRowValues(i)(j);
    });
    size_t heap = BlockHeap<D>(kinematics->Surfaces().slave->Degree());
    AddBlocksInOrder(blocks.Size(), *result, heap, [&](size_t m, LocalHeap &, BlockSum & sum) {
      FlatArray<int> dofs = blocks[m].rows;
      ngbla::Matrix<> forces(dofs.Size(), D), rows(D, dofs.Size());
      forces = 0.0, rows = 0.0;
      auto own = law->Dofs(m);
      for (int k : Range(own))
        for (int j : Range(dofs)) {
          forces(j, k) = from(dofs[j], own[k]);
          rows(k, j) = from(own[k], dofs[j]);
        }
      rows = ngbla::Matrix<>(Inv(law->RowFactor(m, kinematics->Place(m))) * rows);
      sum.Add(dofs, dofs, ngbla::Matrix<>(forces * rows));
    });
    return result;
  }

  /// Adds the rows and columns of the multipliers of one macro-element.
  void AddLines(size_t m, const Answer<D> & answer, const PlaceRows<D> & rows,
                BlockSum & sum) const {
    auto own = law->Dofs(m);
    auto used = Range(own);
    ngbla::Mat<D, D> factor = law->RowFactor(m, kinematics->Place(m));
    ngbla::Mat<D, D> by_jump = factor * answer.by_jump, by_normal = factor * answer.by_normal;
    ngbla::Mat<D, D> by_multiplier = factor * (answer.by_multiplier - Id<D>());
    ngbla::Matrix<> entries = by_jump.Rows(used) * rows.jump;
    if (rows.normal.Height())
      entries += by_normal.Rows(used) * rows.normal;
    sum.Add(own, own, ngbla::Matrix<>(by_multiplier.Rows(used).Cols(used)));
    sum.Add(own, rows.dofs, std::move(entries));
    if (rows.force.Width())
      sum.Add(rows.dofs, own, ngbla::Matrix<>(-1 * Trans(rows.force.Rows(used))));
  }

  /// Integral over a macro-element of how an unknown of the tool moves it.
  Vec<D> ToolIntegral(size_t m, int unknown) const {
    auto & own = kinematics->Surfaces().unknowns[unknown];
    auto & jump = kinematics->Jump();
    return jump.area[m] > 0 ? Vec<D>(jump.area[m] * own.linear + own.spin * jump.moment[m]) : 0.0;
  }
  /// Numbers of boundary elements and of vertices.
  std::array<size_t, 2> MeshSize() const {
    auto & ma = *u.fes->GetMeshAccess();
    return {ma.GetNE(BND), ma.GetNV()};
  }
  /// Entries of a vector on the product space.
  size_t NScalars() const { return u.fes->GetNDof() * u.fes->GetDimension(); }

  shared_ptr<MacroLaw<D>> law;
  shared_ptr<ToolPath<D>> tool; // null: there is none
  unique_ptr<Kinematics<D>> kinematics;
  InterfaceFlow<D> flow;
  Array<Vec<D>> normal; // of the macro-elements at the last evaluation
  NamedNumbers flowing; // what flows through them then, by the names in the table
  Array<double> growth; // of what flows into the slave with the jump of a scalar, at the last step
  NamedNumbers kept;    // the memory after the last committed step
  NamedNumbers present; // the same at the last evaluation, empty: not known
  NamedNumbers looked;  // or the places there, from which a user's law computes it
  size_t nscalars = 0;  // entries of a vector on the product space that was paired
  std::array<size_t, 2> meshsize; // faces and vertices of the mesh that was paired
  struct {
    Array<Vec<D>> normal;
    Array<MacroState> states;
    NamedNumbers flowing;
  } accepted; // at the last committed step
};
} // namespace

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
  int dim = u.fes->GetMeshAccess()->GetDimension(), components = u.evaluator->Dim();
  if (components != dim && components != 1)
    throw Exception("LACContact: u needs " + ToString(dim) + " components, or 1 of what is tied");
  if (lam.evaluator->Dim() != components)
    throw Exception("LACContact: lam needs as many components as u, " + ToString(components) +
                    " (LACSpace without components=...)");
}

void ContactForm::CheckPaired() const {
  if (!IsPaired())
    throw Exception("LACContact: no pairing yet; call Update() first, or solve: forces, pressures "
                    "and tables are those of a solution");
  if (!IsCurrent())
    throw Exception("LACContact: the pairing is that of another mesh or space; after a refinement "
                    "call Update() of the space and of the contact, and make a new solver");
}

shared_ptr<ContactForm> ContactForm::Create(const ContactSetup & setup) {
  int dim = ProxyInfo(*setup.u, "u").fes->GetMeshAccess()->GetDimension();
  if (dim == 2)
    return make_shared<Form<2>>(setup);
  return make_shared<Form<3>>(setup);
}
} // namespace ngslac
