// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include "sparserow.hpp"
#include <la.hpp>

namespace ngslac {
using namespace ngla;

/// Sparse rows that are those of a given matrix but for some, which are stored, and for rows that
/// are left empty.
class ExplicitRows {
public:
  /// Takes the rows `changed` from  sum_row(row, sum).
  ExplicitRows(shared_ptr<SparseMatrix<double>> mat, FlatArray<bool> empty, FlatArray<int> changed,
               const function<void(int, RowSum &)> & sum_row);

  FlatArray<int> Columns(size_t row) const;
  FlatVector<> Values(size_t row) const;
  /// Rows and columns of some dofs, numbered anew; all of them with their own numbers without bits.
  shared_ptr<SparseMatrix<double>> Part(const BitArray * bits) const;
  Array<double> Diagonal() const;

private:
  shared_ptr<SparseMatrix<double>> mat;
  Array<bool> empty;
  Array<int> place; // of each row that is stored, or -1
  Array<SparseRow> rows;
};
} // namespace ngslac
