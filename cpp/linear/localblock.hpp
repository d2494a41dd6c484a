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
  /// What the constraints have to carry of forces on all dofs.
  Vector<> Reactions(FlatVector<> forces) const {
    Vector<> sum(NConstraints());
    sum = 0.0;
    for (int p : Range(pivots))
      sum += forces(dofs[pivots[p]]) * Bl.Row(p);
    return sum;
  }
};

/// Fills a block, whose dofs and multipliers are set.
///
/// `inner(dof)`: free, and touched by this macro-element alone. Throws where these cannot carry the
/// constraints.
void FillBlock(LocalBlock & block, const SparseMatrix<double> & mat, bool symmetric,
               const function<bool(int)> & inner);
} // namespace ngslac
