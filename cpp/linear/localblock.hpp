// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <la.hpp>

namespace ngslac {
using namespace ngla;

/// What one macro-element contributes to a Newton system, split into multipliers that its rows
/// determine and constraints; see Condensation.
struct LocalBlock {
  Array<int> dofs;        // displacements, sorted
  Array<int> multipliers; // d
  Matrix<> E2, G2;        // constraints x dofs, dofs x constraints
  Matrix<> U1, U2;        // rows that determine multipliers, rows that are constraints
  Matrix<> V2;            // multipliers that the constraints leave free
  Matrix<> solved;        // V1 (U1^T F V1)^-1
  Matrix<> E1, GL;        // U1^T E and G solved: the local term of K is  - GL E1
  bool slides = false;    // E1 is not zero

  int NConstraints() const { return E2.Height(); }
};

/// Entries of a vector.
inline Vector<> Gather(FlatArray<int> dofs, FlatVector<> x) {
  Vector<> values(dofs.Size());
  for (int i : Range(dofs))
    values(i) = x(dofs[i]);
  return values;
}

/// Splits a block, whose dofs and multipliers are set; `lifts` are the positions that may carry the
/// constraints.
void SplitBlock(LocalBlock & block, const SparseMatrix<double> & mat, FlatArray<int> lifts);
} // namespace ngslac
