#include "merge.hpp"

namespace ngslac {
namespace {
const double & Entry(const double & value, int, int) {
  return value;
}
template <int N>
const double & Entry(const Mat<N, N> & value, int i, int j) {
  return value(i, j);
}

/// Calls f with the matrix in its true type and the size of its entries.
template <typename F>
auto Dispatch(const BaseMatrix & mat, F f) {
  if (auto m = dynamic_cast<const BaseSparseMatrix *>(&mat); m && m->Height() != m->Width())
    throw Exception("ngslac: the bulk matrix must be square");
  if (dynamic_cast<const SparseMatrixSymmetric<double> *>(&mat))
    throw Exception("ngslac: symmetric_storage=True keeps one triangle only, which several solvers "
                    "read as a full matrix; build the BilinearForm without it");
  if (auto m = dynamic_cast<const SparseMatrixTM<double> *>(&mat))
    return f(*m, 1);
  if (auto m = dynamic_cast<const SparseMatrixTM<Mat<2, 2>> *>(&mat))
    return f(*m, 2);
  if (auto m = dynamic_cast<const SparseMatrixTM<Mat<3, 3>> *>(&mat))
    return f(*m, 3);
  throw Exception("ngslac: the bulk matrix is no assembled real sparse matrix");
}
} // namespace

Array<double> ScalarDiagonal(const BaseMatrix & mat) {
  return Dispatch(mat, [](auto & a, int block) {
    Array<double> diagonal(a.Height() * block);
    diagonal = 0.0;
    ParallelFor(a.Height(), [&](size_t i) {
      if (size_t pos = a.GetPositionTest(i, i); pos != numeric_limits<size_t>::max())
        for (int k : Range(block))
          diagonal[block * i + k] = Entry(a[pos], k, k);
    });
    return diagonal;
  });
}

Array<double> EquilibrationScale(const BaseMatrix & bulk) {
  auto scale = ScalarDiagonal(bulk);
  for (double & s : scale)
    s = s > 0 ? 1 / sqrt(s) : 0;
  Dispatch(bulk, [&](auto & a, int block) {
    Array<double> zero_rows(scale.Size());
    ParallelFor(a.Height(), [&](size_t i) {
      for (int k : Range(block)) {
        double largest = 0;
        auto cols = a.GetRowIndices(i);
        auto values = a.GetRowValues(i);
        for (size_t j : Range(cols))
          for (int l : Range(block))
            largest = max(largest, fabs(Entry(values(j), k, l)) * scale[block * cols[j] + l]);
        zero_rows[block * i + k] = largest > 0 ? 1 / largest : 1;
      }
    });
    for (size_t i : Range(scale))
      if (scale[i] == 0)
        scale[i] = zero_rows[i];
    return 0;
  });
  return scale;
}

shared_ptr<SparseMatrix<double>> MergeMatrices(const BaseMatrix & bulk,
                                               FlatArray<shared_ptr<SparseMatrix<double>>> contacts,
                                               FlatVector<> scale) {
  static Timer timer("ngslac::MergeMatrices");
  RegionTimer reg(timer);
  return Dispatch(bulk, [&](auto & a, int block) {
    size_t n = a.Height() * block;
    for (auto & c : contacts)
      if (c->Height() != n)
        throw Exception("ngslac: bulk and contact live on different spaces");

    // Rows with contact are few: only those are merged, all others are copied.
    auto union_row = [&](size_t i, Array<int> & cols) {
      cols.SetSize0();
      for (int j : a.GetRowIndices(i / block))
        for (int l : Range(block))
          cols.Append(block * j + l);
      size_t own = cols.Size();
      for (auto & c : contacts)
        for (int j : c->GetRowIndices(i))
          cols.Append(j);
      if (cols.Size() == own)
        return;
      QuickSort(cols);
      size_t kept = 0;
      for (int j : cols)
        if (kept == 0 || cols[kept - 1] != j)
          cols[kept++] = j;
      cols.SetSize(kept);
    };
    Array<int> sizes(n);
    ParallelForRange(n, [&](IntRange range) {
      Array<int> cols;
      for (auto i : range) {
        union_row(i, cols);
        sizes[i] = cols.Size();
      }
    });
    auto merged = make_shared<SparseMatrix<double>>(sizes, n);
    ParallelForRange(n, [&](IntRange range) {
      Array<int> cols;
      for (auto i : range) {
        union_row(i, cols);
        auto row = merged->GetRowIndices(i);
        auto values = merged->GetRowValues(i);
        row = cols;
        values = 0.0;
        auto add = [&, pos = size_t(0)](int col, double value) mutable {
          while (row[pos] < col)
            pos++;
          values(pos) += scale(i) * value * scale(col);
        };
        auto bulk_cols = a.GetRowIndices(i / block);
        auto bulk_values = a.GetRowValues(i / block);
        for (auto add_bulk = add; size_t j : Range(bulk_cols))
          for (int l : Range(block))
            add_bulk(block * bulk_cols[j] + l, Entry(bulk_values(j), i % block, l));
        for (auto & c : contacts) {
          auto add_contact = add;
          auto contact_cols = c->GetRowIndices(i);
          auto contact_values = c->GetRowValues(i);
          for (size_t j : Range(contact_cols))
            add_contact(contact_cols[j], contact_values(j));
        }
      }
    });
    return merged;
  });
}
} // namespace ngslac
