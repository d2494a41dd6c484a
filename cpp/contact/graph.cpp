#include "jump.hpp"

namespace ngslac {
shared_ptr<SparseMatrix<double>> MatrixOf(Table<int> && table) {
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
shared_ptr<SparseMatrix<double>> ContactGraph(const MacroJump<D> & jump, FlatArray<int> lamdof,
                                              size_t ndof) {
  TableCreator<int> creator(ndof);
  for (; !creator.Done(); creator++)
    for (size_t m : Range(jump.Size()))
      for (int k : Range(D)) {
        int row = lamdof[D * m + k];
        for (int l : Range(D))
          creator.Add(row, lamdof[D * m + l]);
        for (auto & e : jump.Row(m)) {
          creator.Add(row, e.dof);
          if (e.integral(k) != 0)
            creator.Add(e.dof, row);
        }
      }
  return MatrixOf(creator.MoveTable());
}

template shared_ptr<SparseMatrix<double>> ContactGraph(const MacroJump<2> &, FlatArray<int>,
                                                       size_t);
template shared_ptr<SparseMatrix<double>> ContactGraph(const MacroJump<3> &, FlatArray<int>,
                                                       size_t);
} // namespace ngslac
