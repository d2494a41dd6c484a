// SPDX-License-Identifier: LGPL-2.1-or-later
#include "explicitrows.hpp"

namespace ngslac {
ExplicitRows::ExplicitRows(shared_ptr<SparseMatrix<double>> amat, FlatArray<bool> aempty,
                           FlatArray<int> changed, const function<void(int, RowSum &)> & sum_row)
    : mat(amat), empty(aempty), place(amat->Height()), rows(changed.Size()) {
  place = -1;
  ForEachSum(changed.Size(), [&](size_t c, RowSum & sum) {
    place[changed[c]] = c;
    sum_row(changed[c], sum);
    rows[c] = TakeRow(sum);
  });
}

FlatArray<int> ExplicitRows::Columns(size_t row) const {
  if (empty[row])
    return FlatArray<int>(0, nullptr);
  return place[row] >= 0 ? FlatArray<int>(rows[place[row]].columns) : mat->GetRowIndices(row);
}

FlatVector<> ExplicitRows::Values(size_t row) const {
  if (empty[row])
    return FlatVector<>(0, nullptr);
  if (place[row] < 0)
    return mat->GetRowValues(row);
  auto & values = rows[place[row]].values;
  return FlatVector<>(values.Size(), values.Data());
}

shared_ptr<SparseMatrix<double>> ExplicitRows::Part(const BitArray * bits) const {
  size_t n = mat->Height();
  if (bits && bits->Size() != n)
    throw Exception("Condensation: " + ToString(bits->Size()) + " bits for " + ToString(n) +
                    " rows");
  Array<int> number(n), dofs;
  number = -1;
  for (int i : Range(n))
    if (!bits || bits->Test(i)) {
      number[i] = dofs.Size();
      dofs.Append(i);
    }
  Array<int> sizes(dofs.Size());
  ParallelFor(dofs.Size(), [&](size_t i) {
    sizes[i] = 0;
    for (int j : Columns(dofs[i]))
      sizes[i] += number[j] >= 0;
  });
  auto part = make_shared<SparseMatrix<double>>(sizes, dofs.Size());
  ParallelFor(dofs.Size(), [&](size_t i) {
    auto from = Columns(dofs[i]), columns = part->GetRowIndices(i);
    auto entries = Values(dofs[i]), values = part->GetRowValues(i);
    Array<int> order(from.Size());
    for (int j : Range(order))
      order[j] = j;
    if (place[dofs[i]] >= 0) // others are sorted
      QuickSortI(from, order);
    int k = 0;
    for (int j : order)
      if (number[from[j]] >= 0) {
        columns[k] = number[from[j]];
        values(k++) = entries(j);
      }
  });
  return part;
}

Array<double> ExplicitRows::Diagonal() const {
  Array<double> diagonal(mat->Height());
  ParallelFor(diagonal.Size(), [&](size_t i) {
    auto columns = Columns(i);
    size_t j = columns.Pos(i);
    diagonal[i] = j < columns.Size() ? Values(i)(j) : 0;
  });
  return diagonal;
}
} // namespace ngslac
