#include "twolevel.hpp"

namespace ngslac {
/// Copies the entries (i, j) with keep(i, j).
template <typename F>
void TwoLevel::Triangle::Set(const SparseMatrix<double> & mat, F keep) {
  first.SetSize(mat.Height() + 1);
  first[0] = 0;
  ParallelFor(mat.Height(), [&](size_t i) {
    first[i + 1] = 0;
    for (int j : mat.GetRowIndices(i))
      first[i + 1] += keep(i, j);
  });
  for (size_t i : Range(mat.Height()))
    first[i + 1] += first[i];
  columns.SetSize(first[mat.Height()]);
  values.SetSize(first[mat.Height()]);
  ParallelFor(mat.Height(), [&](size_t i) {
    auto row = mat.GetRowIndices(i);
    auto entries = mat.GetRowValues(i);
    size_t place = first[i];
    for (size_t k : Range(row))
      if (keep(i, row[k])) {
        columns[place] = row[k];
        values[place++] = float(entries(k));
      }
  });
}

double TwoLevel::Triangle::Times(size_t row, const double * y) const {
  double sum[4] = {0, 0, 0, 0}; // none waits for the others
  size_t j = first[row], end = first[row + 1];
  for (; j + 4 <= end; j += 4)
    for (int k : Range(4))
      sum[k] += values[j + k] * y[columns[j + k]];
  for (; j < end; j++)
    sum[0] += values[j] * y[columns[j]];
  return (sum[0] + sum[1]) + (sum[2] + sum[3]);
}

TwoLevel::TwoLevel(shared_ptr<SparseMatrix<double>> amat, shared_ptr<BitArray> free,
                   shared_ptr<BaseMatrix> acoarse)
    : mat(amat), coarse(acoarse), inverse_diagonal(amat->Height()) {
  static Timer timer("ngslac::TwoLevel - setup");
  RegionTimer reg(timer);
  std::atomic<bool> singular = false;
  ParallelFor(mat->Height(), [&](size_t i) {
    inverse_diagonal[i] = 0;
    if (!free->Test(i))
      return;
    size_t pos = mat->GetPositionTest(i, i);
    if (pos != numeric_limits<size_t>::max() && (*mat)[pos] > 0)
      inverse_diagonal[i] = 1 / (*mat)[pos];
    else
      singular = true;
  });
  if (singular)
    throw Exception("ngslac: the matrix has a diagonal entry that is not positive");
  auto isfree = [&](int i) { return inverse_diagonal[i] != 0; };
  lower.Set(*mat, [&](int i, int j) { return j < i && isfree(i) && isfree(j); });
  upper.Set(*mat, [&](int i, int j) { return j > i && isfree(i) && isfree(j); });
}

void TwoLevel::Mult(const BaseVector & x, BaseVector & y) const {
  static Timer timer("ngslac::TwoLevel");
  RegionTimer reg(timer);
  auto b = x.FV<double>();
  auto fy = y.FV<double>();
  double * values = fy.Data();
  size_t n = b.Size();
  auto work = mat->CreateColVector(), step = mat->CreateRowVector();
  auto left = work.FV<double>();
  for (size_t i : Range(n))
    fy(i) = inverse_diagonal[i] * (b(i) - lower.Times(i, values));
  // After the sweep  (L + D) y = b  what is left is  - U y.
  ParallelFor(n, [&](size_t i) { left(i) = -upper.Times(i, values); });
  coarse->Mult(work, step);
  y += step;
  ParallelFor(n, [&](size_t i) { left(i) = b(i) - lower.Times(i, values); });
  for (size_t i = n; i-- > 0;)
    fy(i) = inverse_diagonal[i] * (left(i) - upper.Times(i, values));
}

void TwoLevel::MultAdd(double s, const BaseVector & x, BaseVector & y) const {
  auto product = CreateRowVector();
  Mult(x, product);
  y += s * product;
}
} // namespace ngslac
