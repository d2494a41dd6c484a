// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include "endlaw.hpp"

namespace ngslac {
/// Does the matrix see that the overlap changes where the master ends?
enum class Rim { stays, moves };

/// Where a macro-element is: means over its paired part.
template <int D>
struct MacroPlace {
  Vec<D> normal;
  double gap;           // along it
  Vec<D> slip;          // of this step, perpendicular to the normal
  Vec<D> jump;          // what has to vanish: slip minus gap n, or all of u1 - u2 of tied surfaces
  double area, rowarea; // paired; factor of the multiplier's rows, see MacroJump::RowArea
  const EndPoints * ends = nullptr; // where contact ends inside of it
  Vec<D> facing = Vec<D>(0.0);      // mean normal of the master where it sees that
  double end = 0;                   // how far contact ends inside of it, see EndShares
};

/// Of surfaces that slide; the slip may have a part along the normal.
template <int D>
MacroPlace<D> PlaceAt(const Vec<D> & normal, double gap, Vec<D> slip, double area, double rowarea) {
  slip -= InnerProduct(slip, normal) * normal;
  return {normal, gap, slip, slip - gap * normal, area, rowarea};
}

/// How a place and the forces of a traction move with the dofs, a column for each of them.
template <int D>
struct PlaceRows {
  FlatArray<int> dofs; // sorted; none without a partner
  Matrix<> jump;       // derivative of the mean jump
  Matrix<> normal;     // derivative of the normal; empty where that stays
  Matrix<> force;      // work of a unit traction in each direction; empty if the matrix has it

  PlaceRows() = default;
  explicit PlaceRows(FlatArray<int> adofs, bool forces = true)
      : dofs(adofs), jump(D, dofs.Size()), force(D, forces ? dofs.Size() : 0) {}
};
} // namespace ngslac
