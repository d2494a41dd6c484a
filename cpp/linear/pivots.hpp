// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include "condense.hpp"

namespace ngslac {
/// Lifts on d displacements of one node inside each macro-element, its pivots, that no other
/// macro-element touches.
///
/// The sparse rows are  A + (projection on the pivots' eliminated directions),  symmetric and
/// positive definite where K is and G2 = E2^T: a factorisation of them solves the system.
class PivotCondensation : public Condensation {
public:
  /// The symmetric variant takes slip for frictionless, and for sticking where that is stiffer: for
  /// preconditioners. Throws where a macro-element has no suitable pivots.
  PivotCondensation(shared_ptr<SparseMatrix<double>> mat, FlatArray<int> multipliers, int d,
                    const BitArray & free, bool symmetric);

  void MultAdd(double s, const BaseVector & x, BaseVector & y) const override;
  shared_ptr<ExplicitRows> Rows() const override { return rows; }

private:
  void FillLifts();
  Array<Array<SparseRow>> Carried() const;
  Array<int> ChangedRows() const;
  void AddRow(int row, double factor, RowSum & sum) const;
  void SumRow(int row, FlatArray<Array<SparseRow>> carried, RowSum & sum) const;
  void Project(RowSum & sum) const;

  Array<int> pivotblock; // of each dof, or -1
  shared_ptr<ExplicitRows> rows;
};
} // namespace ngslac
