#include "twolevel.hpp"

namespace ngslac {
TwoLevel::TwoLevel(shared_ptr<SparseMatrix<double>> amat, shared_ptr<BitArray> free,
                   shared_ptr<BaseMatrix> acoarse)
    : mat(amat), coarse(acoarse), inverse_diagonal(amat->Height()), diagonal(amat->Height()) {
  std::atomic<bool> singular = false;
  ParallelFor(mat->Height(), [&](size_t i) {
    auto columns = mat->GetRowIndices(i);
    diagonal[i] = std::lower_bound(columns.begin(), columns.end(), int(i)) - columns.begin();
    bool stored = diagonal[i] < int(columns.Size()) && columns[diagonal[i]] == int(i);
    inverse_diagonal[i] = 0;
    if (!free->Test(i))
      return;
    if (stored && mat->GetRowValues(i)(diagonal[i]) > 0)
      inverse_diagonal[i] = 1 / mat->GetRowValues(i)(diagonal[i]);
    else
      singular = true;
  });
  if (singular)
    throw Exception("ngslac: the matrix has a diagonal entry that is not positive");
}

double TwoLevel::Lower(size_t row, FlatVector<> y) const {
  auto columns = mat->GetRowIndices(row);
  auto values = mat->GetRowValues(row);
  double sum = 0;
  for (int j : Range(diagonal[row]))
    sum += values(j) * y(columns[j]);
  return sum;
}

double TwoLevel::Upper(size_t row, FlatVector<> y) const {
  auto columns = mat->GetRowIndices(row);
  auto values = mat->GetRowValues(row);
  double sum = 0;
  for (int j = diagonal[row] + 1; j < int(columns.Size()); j++)
    sum += values(j) * y(columns[j]);
  return sum;
}

void TwoLevel::Mult(const BaseVector & x, BaseVector & y) const {
  static Timer timer("ngslac::TwoLevel");
  RegionTimer reg(timer);
  auto b = x.FV<double>();
  auto fy = y.FV<double>();
  size_t n = b.Size();
  auto work = mat->CreateColVector(), step = mat->CreateRowVector();
  auto left = work.FV<double>();
  y = 0.0;
  for (size_t i : Range(n))
    if (double d = inverse_diagonal[i]; d != 0)
      fy(i) = d * (b(i) - Lower(i, fy));
  // After the sweep  (L + D) y = b  what is left is  - U y.
  ParallelFor(n, [&](size_t i) { left(i) = inverse_diagonal[i] != 0 ? -Upper(i, fy) : 0; });
  coarse->Mult(work, step);
  y += step;
  ParallelFor(n, [&](size_t i) {
    if (inverse_diagonal[i] != 0)
      left(i) = b(i) - Lower(i, fy);
  });
  for (size_t i = n; i-- > 0;)
    if (double d = inverse_diagonal[i]; d != 0)
      fy(i) = d * (left(i) - Upper(i, fy));
}

void TwoLevel::MultAdd(double s, const BaseVector & x, BaseVector & y) const {
  auto product = CreateRowVector();
  Mult(x, product);
  y += s * product;
}
} // namespace ngslac
