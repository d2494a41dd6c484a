// SPDX-License-Identifier: LGPL-2.1-or-later
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
    Array<double> factors(scale.Size());
    ParallelFor(a.Height(), [&](size_t i) {
      for (int k : Range(block)) {
        double & factor = factors[block * i + k] = scale[block * i + k];
        if (factor != 0)
          continue;
        double largest = 0;
        auto cols = a.GetRowIndices(i);
        auto values = a.GetRowValues(i);
        for (size_t j : Range(cols))
          for (int l : Range(block))
            largest = max(largest, fabs(Entry(values(j), k, l)) * scale[block * cols[j] + l]);
        factor = largest > 0 ? 1 / largest : 1;
      }
    });
    scale = std::move(factors);
    return 0;
  });
  return scale;
}

namespace {
/// Merges rows of matrices in their scalar entries.
template <typename TM>
struct RowMerger {
  const TM & bulk;
  int block;
  FlatArray<shared_ptr<SparseMatrix<double>>> contacts;
  FlatVector<> scale;

  bool HasContact(size_t row) const {
    for (auto & c : contacts)
      if (c->GetRowIndices(row).Size())
        return true;
    return false;
  }

  size_t BulkSize(size_t row) const { return block * bulk.GetRowIndices(row / block).Size(); }

  void Columns(size_t row, Array<int> & cols) const {
    cols.SetSize0();
    for (int j : bulk.GetRowIndices(row / block))
      for (int l : Range(block))
        cols.Append(block * j + l);
    for (auto & c : contacts)
      if (auto others = c->GetRowIndices(row); others.Size()) { // both are sorted
        Array<int> all(cols.Size() + others.Size());
        all.SetSize(
            std::set_union(cols.begin(), cols.end(), others.begin(), others.end(), all.begin()) -
            all.begin());
        Swap(cols, all);
      }
  }

  void Fill(size_t i, FlatArray<int> row, FlatVector<> values) const {
    values = 0.0;
    auto add = [&, pos = size_t(0)](int col, double value) mutable {
      while (pos < row.Size() && row[pos] < col)
        pos++;
      if (pos == row.Size() || row[pos] != col)
        throw Exception("ngslac: the columns of a matrix are not sorted");
      values(pos) += scale(i) * value * scale(col);
    };
    auto bulk_cols = bulk.GetRowIndices(i / block);
    auto bulk_values = bulk.GetRowValues(i / block);
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

  /// Has a merged matrix the graph of what would be merged now?
  bool Fits(const SparseMatrix<double> & merged) const {
    if (merged.Height() != bulk.Height() * block)
      return false;
    std::atomic<bool> fits = true;
    ParallelForRange(merged.Height(), [&](IntRange range) {
      Array<int> cols;
      for (auto i : range) {
        auto row = merged.GetRowIndices(i);
        if (HasContact(i)) {
          Columns(i, cols);
          if (cols != row)
            fits = false;
        } else if (row.Size() != BulkSize(i))
          fits = false;
      }
    });
    return fits;
  }
};
} // namespace

shared_ptr<SparseMatrix<double>> MergeMatrices(const BaseMatrix & bulk,
                                               FlatArray<shared_ptr<SparseMatrix<double>>> contacts,
                                               FlatVector<> scale,
                                               shared_ptr<SparseMatrix<double>> former) {
  static Timer timer("ngslac::MergeMatrices");
  RegionTimer reg(timer);
  return Dispatch(bulk, [&](auto & a, int block) {
    size_t n = a.Height() * block;
    for (auto & c : contacts)
      if (c->Height() != n)
        throw Exception("ngslac: bulk and contact live on different spaces");
    if (scale.Size() != n)
      throw Exception("MergeMatrices: scale has " + ToString(scale.Size()) +
                      " entries, but the matrix has " + ToString(n) + " rows");
    RowMerger merger{a, block, contacts, scale};
    if (former && merger.Fits(*former)) {
      ParallelFor(n, [&](size_t i) {
        if (merger.HasContact(i))
          merger.Fill(i, former->GetRowIndices(i), former->GetRowValues(i));
      });
      return former;
    }
    Array<int> sizes(n);
    ParallelForRange(n, [&](IntRange range) {
      Array<int> cols;
      for (auto i : range) {
        sizes[i] = merger.BulkSize(i);
        if (merger.HasContact(i)) {
          merger.Columns(i, cols);
          sizes[i] = cols.Size();
        }
      }
    });
    auto merged = make_shared<SparseMatrix<double>>(sizes, n);
    ParallelForRange(n, [&](IntRange range) {
      Array<int> cols;
      for (auto i : range) {
        merger.Columns(i, cols);
        merged->GetRowIndices(i) = cols;
        merger.Fill(i, cols, merged->GetRowValues(i));
      }
    });
    return merged;
  });
}
} // namespace ngslac
