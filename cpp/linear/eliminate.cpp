// SPDX-License-Identifier: LGPL-2.1-or-later
#include "eliminate.hpp"
#include "indexmap.hpp"

namespace ngslac {
/// A zero matrix with the columns of each row in any order, maybe several times.
static shared_ptr<SparseMatrix<double>> MatrixOf(Table<int> && table) {
  size_t n = table.Size();
  Array<int> sizes(n);
  ParallelFor(n, [&](size_t i) {
    QuickSort(table[i]);
    sizes[i] = std::unique(table[i].begin(), table[i].end()) - table[i].begin();
  });
  auto mat = make_shared<SparseMatrix<double>>(sizes, n);
  ParallelFor(n, [&](size_t i) { mat->GetRowIndices(i) = table[i].Range(0, sizes[i]); });
  mat->SetZero();
  return mat;
}

shared_ptr<SparseMatrix<double>> EliminateMultipliers(const SparseMatrix<double> & mat,
                                                      FlatArray<int> multipliers, int d,
                                                      FlatArray<double> penalties) {
  static Timer timer("ngslac::EliminateMultipliers");
  RegionTimer reg(timer);
  size_t n = mat.Height();
  Array<int> number(n); // of the multiplier
  number = -1;
  for (int i : Range(multipliers))
    number[multipliers[i]] = i;
  // Calls f(column, entry) for the displacements, or for the multipliers, of a row.
  auto entries = [&](int row, bool multiplier, auto f) {
    auto cols = mat.GetRowIndices(row);
    auto values = mat.GetRowValues(row);
    for (int j : Range(cols))
      if ((number[cols[j]] >= 0) == multiplier)
        f(cols[j], values(j));
  };
  TableCreator<int> creator(n);
  for (; !creator.Done(); creator++)
    ParallelFor(n, [&](size_t i) {
      if (number[i] >= 0)
        return;
      auto add = [&](int col, double) { creator.Add(i, col); };
      entries(i, false, add);
      entries(i, true, [&](int lam, double) { entries(lam, false, add); });
    });
  auto result = MatrixOf(creator.MoveTable());
  ParallelForRange(n, [&](IntRange rows) {
    RowSum sum;
    for (auto i : rows) {
      if (number[i] >= 0)
        continue;
      entries(i, false, [&](int col, double value) { sum.Add(col, value); });
      entries(i, true, [&](int lam, double force) {
        double factor = force * penalties[number[lam] / d];
        entries(lam, false, [&](int col, double value) { sum.Add(col, factor * value); });
      });
      auto cols = result->GetRowIndices(i);
      auto values = result->GetRowValues(i);
      for (int j : Range(cols))
        values(j) = sum[cols[j]];
      sum.Clear();
    }
  });
  return result;
}
} // namespace ngslac
