// SPDX-License-Identifier: LGPL-2.1-or-later
#include "blocksum.hpp"

namespace ngslac {
shared_ptr<SparseMatrix<double>> ZeroMatrix(size_t n, FlatArray<GraphBlock> blocks) {
  auto table = [&](Array<int> GraphBlock::* lists) {
    Array<int> sizes(blocks.Size());
    for (size_t i : Range(blocks))
      sizes[i] = (blocks[i].*lists).Size();
    Table<int> result(sizes);
    ParallelFor(blocks.Size(), [&](size_t i) { result[i] = blocks[i].*lists; });
    return result;
  };
  auto rows = table(&GraphBlock::rows), columns = table(&GraphBlock::columns);
  auto mat = make_shared<SparseMatrix<double>>(MatrixGraph(n, n, rows, columns, false));
  mat->SetZero();
  return mat;
}

namespace {
void AddToRow(SparseMatrix<double> & mat, int row, FlatArray<int> columns, FlatVector<> values) {
  auto all = mat.GetRowIndices(row);
  auto entries = mat.GetRowValues(row);
  size_t at = 0;
  for (size_t j : Range(columns)) {
    if (values(j) == 0)
      continue;
    if (at == 0)
      at = std::lower_bound(all.begin(), all.end(), columns[j]) - all.begin();
    while (at < all.Size() && all[at] < columns[j])
      at++;
    if (at == all.Size() || all[at] != columns[j])
      throw Exception("ngslac: a contact force has no place in the matrix");
    entries(at) += values(j);
  }
}
} // namespace

void BlockSum::AddTo(SparseMatrix<double> & mat, int part, int parts) const {
  constexpr int together = 16; // rows of a part: those of neighbouring dofs
  for (auto & block : blocks)
    for (int i : Range(block.rows))
      if (block.rows[i] / together % parts == part)
        AddToRow(mat, block.rows[i], block.columns, block.values.Row(i));
}

shared_ptr<SparseMatrix<double>> MatrixOf(size_t n, FlatArray<BlockSum> sums) {
  Array<GraphBlock> graph;
  for (auto & sum : sums)
    sum.AppendGraph(graph);
  auto mat = ZeroMatrix(n, graph);
  for (auto & sum : sums)
    sum.AddTo(*mat, 0, 1);
  return mat;
}

shared_ptr<SparseMatrix<double>> Sum(const SparseMatrix<double> & a,
                                     const SparseMatrix<double> & b) {
  size_t n = a.Height();
  auto columns = [&](size_t row) {
    Array<int> all(a.GetRowIndices(row));
    all += b.GetRowIndices(row);
    SortUnique(all);
    return all;
  };
  Array<int> sizes(n);
  ParallelFor(n, [&](size_t i) { sizes[i] = columns(i).Size(); });
  auto sum = make_shared<SparseMatrix<double>>(sizes, n);
  ParallelFor(n, [&](size_t i) { sum->GetRowIndices(i) = columns(i); });
  sum->SetZero();
  ParallelFor(n, [&](size_t i) {
    for (auto * part : {&a, &b})
      AddToRow(*sum, i, part->GetRowIndices(i), part->GetRowValues(i));
  });
  return sum;
}
} // namespace ngslac
