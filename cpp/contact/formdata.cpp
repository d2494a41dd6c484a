// SPDX-License-Identifier: LGPL-2.1-or-later
#include "form.hpp"

namespace ngslac {
template <int D>
void Form<D>::Evaluate(const BaseVector & bx) {
  CheckSize(bx.FV<double>().Size());
  law->Reevaluate();
  auto x = bx.FV<double>();
  kinematics->At(x);
  auto answers = Answers(x, false);
  ParallelFor(states.Size(), [&](size_t m) {
    auto place = Place(m);
    auto & state = states[m];
    state.status = answers[m].status;
    // What is left of the multiplier of an open one is rounding, or part of an iteration.
    bool acts = setup.active && state.status != Status::open;
    Vec<D> traction = acts ? law->Multiplier(m, x) : Vec<D>(0.0);
    state.pressure = 0.0 - InnerProduct(traction, place.normal); // no -0
    state.gap = place.gap;
    state.traction = 0.0, state.slip = 0.0;
    for (int k : Range(D))
      state.traction(k) = traction(k), state.slip(k) = place.slip(k);
    normal[m] = place.normal;
  });
}

template <int D>
void Form<D>::Commit(const BaseVector & bx) {
  Follow(bx);
  Evaluate(bx);
  if (setup.active)
    kinematics->Commit(bx.FV<double>(), accepted.states, states);
  Accept();
}

template <int D>
void Form<D>::Accept() {
  accepted.normal = normal;
  accepted.states = states;
}

template <int D>
void Form<D>::Restore() {
  CheckPaired();
  kinematics->Restore();
  normal = accepted.normal;
  states = accepted.states;
}

template <int D>
NamedNumbers Form<D>::History() const {
  CheckPaired();
  NamedNumbers history;
  kinematics->Save(history);
  SaveVectors<D>(history["reference"], kinematics->Reference());
  history["c"] = law->c;
  if (setup.adjust > 0)
    history["adjusted"] = law->adjusted;
  SaveVectors<D>(history["normal"], normal);
  SaveVectors<D>(history["accepted_normal"], accepted.normal);
  for (auto & s : states)
    AppendState(history["states"], s);
  for (auto & s : accepted.states)
    AppendState(history["accepted"], s);
  return history;
}

template <int D>
void Form<D>::SetHistory(const NamedNumbers & history) {
  for (auto & [name, values] : History())
    if (!history.count(name) || history.at(name).Size() != values.Size())
      throw Exception("LACContact: the saved history does not fit: '" + name + "' needs " +
                      ToString(values.Size()) + " numbers");
  auto saved = StatesFrom(history.at("states")), committed = StatesFrom(history.at("accepted"));
  law->c = history.at("c");
  if (setup.adjust > 0)
    law->adjusted = history.at("adjusted");
  kinematics->Load(history);
  LoadVectors<D>(history.at("reference"), kinematics->Reference());
  LoadVectors<D>(history.at("normal"), normal);
  LoadVectors<D>(history.at("accepted_normal"), accepted.normal);
  states = std::move(saved);
  accepted.states = std::move(committed);
}

// --- what Python asks for ------------------------------------------------------------------------

template <int D>
shared_ptr<SparseMatrix<double>> Form<D>::JumpMatrix(Side side) {
  CheckPaired();
  auto & surfaces = kinematics->Surfaces();
  MacroJump<D> one(*space, *surfaces.slave, *surfaces.pairing);
  if (side != Side::both) // of both sides there is one already
    one.SetRows(u, *surfaces.slave, surfaces.master.get(), *surfaces.pairing, side);
  auto & op = side == Side::both ? kinematics->JumpWithRows() : one;
  int block = u.fes->GetDimension();
  return op.AsMatrix(u.offset * block, u.component->GetNDof() * block,
                     side == Side::master ? -1 : 1); // D and M are both positive
}

template <int D>
Array<double> Form<D>::ToolRows() const {
  CheckPaired();
  Array<double> rows;
  for (size_t m : Range(states))
    for (int k : Range(D))
      for (int i : Range(ToolDofs()))
        rows.Append(-ToolIntegral(m, i)(k));
  return rows;
}

template <int D>
NamedNumbers Form<D>::Table() const {
  CheckPaired();
  auto & jump = kinematics->Jump();
  NamedNumbers table;
  for (auto & [name, values] : std::map<string, const Array<double> *>{{"area", &jump.area},
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
  for (size_t m : Range(states)) {
    auto & state = states[m];
    auto place = kinematics->Place(m);
    AppendVector<D>(table["facing"], place.facing);
    table["ends"].Append(place.end);
    table["prescribed"].Append(D - Trace(space->ReachOf(m)));
    table["pressure"].Append(state.pressure);
    table["gap"].Append(state.gap);
    table["status"].Append(double(state.status));
    for (int k : Range(D)) {
      table["traction"].Append(state.traction(k));
      table["slip"].Append(state.slip(k));
    }
  }
  return table;
}

template <int D>
NamedNumbers Form<D>::Resultants() const {
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

template <int D>
size_t Form<D>::NSegments() const {
  CheckPaired();
  return kinematics->Surfaces().pairing->Size();
}

template <int D>
SegmentTable Form<D>::Segments() const {
  CheckPaired();
  auto & surfaces = kinematics->Surfaces();
  return MakeSegmentTable(*surfaces.pairing, *surfaces.slave, surfaces.master.get());
}

template <int D>
Array<double> Form<D>::Points() const {
  CheckPaired();
  auto & surfaces = kinematics->Surfaces();
  return MakePointTable(*surfaces.pairing, *surfaces.slave, surfaces.master.get());
}

template <int D>
Array<double> Form<D>::Depths() const {
  CheckPaired();
  auto & surfaces = kinematics->Surfaces();
  return kinematics->Finder().Depths(*surfaces.slave, *surfaces.master);
}

template <int D>
Array<double> Form<D>::Overlaps() const {
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

template <int D>
Array<double> Form<D>::GapRanges(FlatVector<> x) {
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

template class Form<2>;
template class Form<3>;
} // namespace ngslac
