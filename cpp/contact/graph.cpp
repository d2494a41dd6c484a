// SPDX-License-Identifier: LGPL-2.1-or-later
#include "jump.hpp"

namespace ngslac {
namespace {
/// Displacements of a macro-element, in any order.
template <int D>
Array<int> Displacements(const MacroJump<D> & jump, size_t m, FlatArray<int> coupled) {
  Array<int> dofs(coupled);
  if (!coupled.Size())
    for (auto & e : jump.Row(m))
      dofs.Append(e.dof);
  return dofs;
}

void SortUnique(Array<int> & numbers) {
  QuickSort(numbers);
  numbers.SetSize(std::unique(numbers.begin(), numbers.end()) - numbers.begin());
}
} // namespace

template <int D>
shared_ptr<SparseMatrix<double>> ContactGraph(const MacroJump<D> & jump, FlatArray<int> lamdof,
                                              size_t ndof, FlatArray<FlatArray<int>> coupled) {
  TableCreator<int> creator(ndof); // of the rows of displacements
  for (; !creator.Done(); creator++)
    ParallelFor(jump.Size(), [&](size_t m) {
      auto own = lamdof.Range(D * m, D * (m + 1));
      for (int dof : coupled[m]) {
        for (int other : coupled[m])
          creator.Add(dof, other);
        for (int lam : own)
          creator.Add(dof, lam);
      }
      if (coupled[m].Size())
        return;
      for (auto & e : jump.Row(m))
        for (int k : Range(D))
          if (e.integral(k) != 0)
            creator.Add(e.dof, own[k]);
    });
  auto columns = creator.MoveTable();
  Array<int> sizes(ndof);
  ParallelFor(ndof, [&](size_t i) {
    if (columns[i].Size() > 1)
      QuickSort(columns[i]);
    sizes[i] = std::unique(columns[i].begin(), columns[i].end()) - columns[i].begin();
  });
  Array<Array<int>> rows(jump.Size()); // of multipliers
  ParallelFor(jump.Size(), [&](size_t m) {
    rows[m] = Displacements(jump, m, coupled[m]);
    rows[m] += lamdof.Range(D * m, D * (m + 1));
    SortUnique(rows[m]);
    for (int row : lamdof.Range(D * m, D * (m + 1)))
      sizes[row] = rows[m].Size();
  });
  auto mat = make_shared<SparseMatrix<double>>(sizes, ndof);
  mat->SetZero();
  ParallelFor(ndof, [&](size_t i) {
    if (columns[i].Size())
      mat->GetRowIndices(i) = columns[i].Range(0, sizes[i]);
  });
  ParallelFor(jump.Size(), [&](size_t m) {
    for (int row : lamdof.Range(D * m, D * (m + 1)))
      mat->GetRowIndices(row) = rows[m];
  });
  return mat;
}

#define INSTANTIATE(D)                                                                             \
  template shared_ptr<SparseMatrix<double>> ContactGraph(const MacroJump<D> &, FlatArray<int>,     \
                                                         size_t, FlatArray<FlatArray<int>>);
INSTANTIATE(2)
INSTANTIATE(3)
} // namespace ngslac
