// SPDX-License-Identifier: LGPL-2.1-or-later
#include "condense.hpp"

namespace ngslac {
namespace {
/// Multipliers whose own stiffness is this small against the elastic one: rows are constraints.
constexpr double negligible = 1e-4;

struct Entries {
  Matrix<> E, G, F;
};

Entries Read(const LocalBlock & block, const SparseMatrix<double> & mat) {
  FlatArray<int> dofs = block.dofs, lam = block.multipliers;
  auto entry = [&](int i, int j) {
    size_t pos = mat.GetPositionTest(i, j);
    return pos == numeric_limits<size_t>::max() ? 0.0 : mat[pos];
  };
  size_t n = dofs.Size(), d = lam.Size();
  Entries entries{Matrix<>(d, n), Matrix<>(n, d), Matrix<>(d, d)};
  for (int k : Range(d)) {
    for (int j : Range(n)) {
      entries.E(k, j) = entry(lam[k], dofs[j]);
      entries.G(j, k) = entry(dofs[j], lam[k]);
    }
    for (int l : Range(d))
      entries.F(k, l) = entry(lam[k], lam[l]);
  }
  return entries;
}

/// Eigenvalues, ascending, and eigenvectors as rows.
std::pair<Vector<>, Matrix<>> Eigensystem(const Matrix<> & symmetric) {
  size_t n = symmetric.Height();
  Vector<> unsorted(n), values(n);
  Matrix<> rows(n, n), vectors(n, n);
  CalcEigenSystem(symmetric, unsorted, rows);
  Array<int> order(n);
  for (int i : Range(n))
    order[i] = i;
  QuickSort(order, [&](int i, int j) { return unsorted(i) < unsorted(j); });
  for (int i : Range(n)) {
    values(i) = unsorted(order[i]);
    vectors.Row(i) = rows.Row(order[i]);
  }
  return {std::move(values), std::move(vectors)};
}

Matrix<> Transposed(const Matrix<> & a) {
  return Matrix<>(Trans(a));
}

/// How many singular values of F, ascending, belong to constraints.
int CountConstraints(const Matrix<> & F, const Matrix<> & V, double size) {
  int count = 0;
  while (count < int(F.Height()) && L2Norm(Vector<>(F * V.Row(count))) < negligible * sqr(size))
    count++;
  return count;
}
} // namespace

void SplitBlock(LocalBlock & block, const SparseMatrix<double> & mat, FlatArray<int> lifts) {
  auto [E, G, F] = Read(block, mat);
  size_t d = F.Height();
  double size = 0; // of the forces on the dofs of lifts
  for (int i : lifts)
    size += L2Norm2(G.Row(i));
  size = sqrt(size);

  Matrix<> V = Eigensystem(Transposed(F) * F).second, U = Eigensystem(F * Transposed(F)).second;
  size_t count = CountConstraints(F, V, size);
  block.U2 = U.Rows(0, count);
  block.U1 = U.Rows(count, d);
  block.V2 = Transposed(V.Rows(0, count));
  Matrix<> V1 = Transposed(V.Rows(count, d));
  Matrix<> F1 = block.U1 * Matrix<>(F * V1);
  CalcInverse(F1);
  block.solved = V1 * F1;
  block.E1 = block.U1 * E;
  block.GL = G * block.solved;
  block.slides = L2Norm(block.E1) > 1e-13 * L2Norm(G);
  block.E2 = block.U2 * E;
  block.G2 = G * block.V2;
}
} // namespace ngslac
