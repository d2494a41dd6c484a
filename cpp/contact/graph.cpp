#include "jump.hpp"

namespace ngslac {
template <int D>
shared_ptr<SparseMatrix<double>> ContactGraph(const MacroJump<D> & jump, FlatArray<int> lamdof,
                                              size_t ndof) {
  TableCreator<int> creator(ndof); // of the rows of displacements
  for (; !creator.Done(); creator++)
    ParallelFor(jump.Size(), [&](size_t m) {
      for (auto & e : jump.Row(m))
        for (int k : Range(D))
          if (e.integral(k) != 0)
            creator.Add(e.dof, lamdof[D * m + k]);
    });
  auto columns = creator.MoveTable();
  Array<int> sizes(ndof);
  ParallelFor(ndof, [&](size_t i) {
    sizes[i] = columns[i].Size();
    if (sizes[i] > 1)
      std::sort(columns[i].begin(), columns[i].end());
  });
  for (size_t i : Range(lamdof))
    sizes[lamdof[i]] = D + jump.Row(i / D).Size();
  auto mat = make_shared<SparseMatrix<double>>(sizes, ndof);
  mat->SetZero();
  ParallelFor(ndof, [&](size_t i) {
    if (columns[i].Size())
      mat->GetRowIndices(i) = columns[i];
  });
  ParallelFor(jump.Size(), [&](size_t m) {
    auto own = lamdof.Range(D * m, D * (m + 1));
    auto first = mat->GetRowIndices(own[0]);
    int n = 0;
    for (auto & e : jump.Row(m))
      first[n++] = e.dof;
    for (int dof : own)
      first[n++] = dof;
    std::sort(first.begin(), first.end());
    for (int row : own)
      mat->GetRowIndices(row) = first;
  });
  return mat;
}

template shared_ptr<SparseMatrix<double>> ContactGraph(const MacroJump<2> &, FlatArray<int>,
                                                       size_t);
template shared_ptr<SparseMatrix<double>> ContactGraph(const MacroJump<3> &, FlatArray<int>,
                                                       size_t);
} // namespace ngslac
