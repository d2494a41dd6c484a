// SPDX-License-Identifier: LGPL-2.1-or-later
#include "macrostate.hpp"

namespace ngslac {
namespace {
constexpr int state_size = 9; // numbers in a MacroState

Vec<3> VectorFrom(const double * flat) {
  return Vec<3>(flat[0], flat[1], flat[2]);
}
} // namespace

Status StatusFrom(double number) {
  for (auto status : {Status::open, Status::stick, Status::slip})
    if (number == double(status))
      return status;
  throw Exception("LACContact: " + ToString(number) +
                  " is no status of a macro-element, which is 0, 1 or 2");
}

void AppendState(Array<double> & flat, const MacroState & state) {
  flat += Array<double>{state.pressure, state.gap, double(state.status)};
  for (auto * v : {&state.traction, &state.slip})
    for (int k : Range(3))
      flat.Append((*v)(k));
}

Array<MacroState> StatesFrom(FlatArray<double> flat) {
  Array<MacroState> states;
  for (size_t i : Range(flat.Size() / state_size)) {
    const double * at = flat.Data() + state_size * i;
    states.Append(
        MacroState{at[0], at[1], VectorFrom(at + 3), VectorFrom(at + 6), StatusFrom(at[2])});
  }
  return states;
}
} // namespace ngslac
