// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include "condense.hpp"

namespace ngslac {
/// What a macro-element adds to the rows of its dofs:  left right.
struct LocalTerm {
  FlatArray<int> dofs;
  Matrix<> left, right; // dofs x k, k x dofs

  /// Position of a dof that is among the dofs.
  int Position(int dof) const {
    return std::lower_bound(dofs.begin(), dofs.end(), dof) - dofs.begin();
  }
};

/// Orthogonal lifts, for preconditioned iterations:  B = E2^T (E2 E2^T)^-1, Bl = G2 (G2^T G2)^-1 on
/// the free displacements.
///
/// In the scaled system, whose diagonal is 1, these are the lifts of least energy in the diagonal
/// of K. They go to the softer side by themselves, so that the condition does not depend on the
/// ratio of the stiffnesses. No inner displacement is needed.
///
/// The sparse rows are  K - GL E1 + G2 S E2  with a penalty S as stiff as the diagonal of K. On the
/// kernel of E2 this is A, and since E2 is bounded from both sides in these norms, a preconditioner
/// for it is one for A: a Gauss-Seidel sweep does not notice the penalty, and it couples fewer dofs
/// than P. What macro-elements add is kept as local terms of at most d columns: summed up to rows
/// they would be most of the matrix where everything is near to a contact.
class OrthogonalCondensation : public Condensation {
public:
  /// Throws where the constraints depend on each other.
  OrthogonalCondensation(shared_ptr<SparseMatrix<double>> mat, FlatArray<int> multipliers, int d,
                         const BitArray & free);

  void MultAdd(double s, const BaseVector & x, BaseVector & y) const override;
  shared_ptr<ExplicitRows> Rows() const override;
  /// Of each macro-element; without columns where it adds nothing.
  FlatArray<LocalTerm> Terms() const { return terms; }
  /// The macro-elements of each dof.
  const Table<int> & Touching() const { return touching; }

private:
  Array<int> FreeDofs(int m) const;
  void FillTerm(int m);
  void FillLifts();
  void SumRow(int row, RowSum & sum) const;

  Array<LocalTerm> terms;
};
} // namespace ngslac
