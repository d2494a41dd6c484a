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

template <int D>
shared_ptr<SparseMatrix<double>> EliminateMultipliers(const SparseMatrix<double> & mat,
                                                      FlatArray<int> multipliers,
                                                      FlatArray<double> penalties) {
  static Timer timer("ngslac::EliminateMultipliers");
  RegionTimer reg(timer);
  size_t n = mat.Height();
  Array<int> number(n); // of the multiplier
  number = -1;
  for (int i : Range(multipliers))
    number[multipliers[i]] = i;
  auto displacements = [&](int row, auto f) {
    auto cols = mat.GetRowIndices(row);
    auto values = mat.GetRowValues(row);
    for (int j : Range(cols))
      if (number[cols[j]] < 0)
        f(cols[j], values(j));
  };
  // Calls f(multiplier, force) for each multiplier that acts on a dof.
  auto acting = [&](int row, auto f) {
    auto cols = mat.GetRowIndices(row);
    auto values = mat.GetRowValues(row);
    for (int j : Range(cols))
      if (number[cols[j]] >= 0)
        f(number[cols[j]], values(j));
  };
  TableCreator<int> creator(n);
  for (; !creator.Done(); creator++)
    ParallelFor(n, [&](size_t i) {
      if (number[i] >= 0)
        return;
      displacements(i, [&](int col, double) { creator.Add(i, col); });
      acting(i, [&](int k, double) {
        displacements(multipliers[k], [&](int col, double) { creator.Add(i, col); });
      });
    });
  auto result = MatrixOf(creator.MoveTable());
  ParallelForRange(n, [&](IntRange rows) {
    RowSum sum;
    for (auto i : rows) {
      if (number[i] >= 0)
        continue;
      displacements(i, [&](int col, double value) { sum.Add(col, value); });
      acting(i, [&](int k, double force) {
        double factor = force * penalties[k / D];
        displacements(multipliers[k], [&](int col, double value) { sum.Add(col, factor * value); });
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

template shared_ptr<SparseMatrix<double>>
EliminateMultipliers<2>(const SparseMatrix<double> &, FlatArray<int>, FlatArray<double>);
template shared_ptr<SparseMatrix<double>>
EliminateMultipliers<3>(const SparseMatrix<double> &, FlatArray<int>, FlatArray<double>);
} // namespace ngslac
