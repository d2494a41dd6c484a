// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <la.hpp>

namespace ngslac {
using namespace ngla;

/// What one macro-element contributes to a Newton system, split into multipliers that its rows tell
/// and constraints; see Condensation.
struct LocalBlock {
  Array<int> dofs;        // displacements, sorted
  Array<int> multipliers; // d
  Array<int> pivots;      // positions in dofs of the d pivots; empty without constraints
  Matrix<> E2, G2;        // constraints x dofs, dofs x constraints
  Matrix<> B, Bl;         // pivots x constraints:  E2 B = 1,  Bl^T G2 = 1
  Matrix<> complement;    // pivots x pivots: projection on what the constraints eliminate
  Matrix<> U1, U2;        // rows that tell multipliers, rows that are constraints
  Matrix<> V2;            // multipliers that the constraints leave free
  Matrix<> told;          // V1 (U1^T F V1)^-1
  Matrix<> E1, GL;        // U1^T E and G told: the local term of K is  - GL E1
  bool slides = false;    // E1 is not zero

  int NConstraints() const { return E2.Height(); }
  /// Position of a dof that is among the dofs.
  int Position(int dof) const {
    return std::lower_bound(dofs.begin(), dofs.end(), dof) - dofs.begin();
  }
};

/// Entries of a vector.
inline Vector<> Gather(FlatArray<int> dofs, FlatVector<> x) {
  Vector<> values(dofs.Size());
  for (int i : Range(dofs))
    values(i) = x(dofs[i]);
  return values;
}

/// Positions of inner dofs on which the tractions act in independent directions, the strongest
/// first.
///
/// `inner(dof)`: free, and touched by this macro-element alone.
Array<int> ChoosePivots(FlatArray<int> dofs, const Matrix<> & G, const function<bool(int)> & inner);

/// Splits a block, whose dofs and multipliers are set; `lifts` are the positions that may carry the
/// constraints.
void SplitBlock(LocalBlock & block, const SparseMatrix<double> & mat,
                const function<Array<int>(const Matrix<> & G)> & lifts);

/// Lifts on the pivots of a block that is split; throws where these cannot carry the constraints.
///
/// The symmetric variant takes slip for frictionless, and for sticking where that is stiffer.
void FillPivots(LocalBlock & block, bool symmetric);
} // namespace ngslac
