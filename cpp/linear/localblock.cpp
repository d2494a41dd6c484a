// SPDX-License-Identifier: LGPL-2.1-or-later
#include "localblock.hpp"

namespace ngslac {
namespace {
/// Multipliers whose own stiffness is this small against the elastic one: rows are constraints.
constexpr double negligible = 1e-4;
/// Least share of the pivots in a constraint.
constexpr double least_pivot = 1e-4;

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

/// Orthogonal projection on the range.
Matrix<> Projection(const Matrix<> & B) {
  Matrix<> gram = Trans(B) * B;
  CalcInverse(gram);
  Matrix<> left = B * gram;
  return Matrix<>(left * Trans(B));
}

/// X (X^T X)^-1 for the rows of the pivots.
Matrix<> RightInverse(const Matrix<> & columns, FlatArray<int> pivots) {
  Matrix<> at(pivots.Size(), columns.Width());
  for (int i : Range(pivots))
    at.Row(i) = columns.Row(pivots[i]);
  Matrix<> gram = Trans(at) * at;
  double smallest = Eigensystem(gram).first(0);
  double largest = 0;
  for (double value : columns.AsVector())
    largest = max(largest, fabs(value));
  if (pivots.Size() < columns.Width() || !(smallest > sqr(least_pivot * largest)))
    throw Exception("ngslac: a macro-element has no displacement of its own to be eliminated");
  CalcInverse(gram);
  return Matrix<>(at * gram);
}

/// How many singular values of F, ascending, belong to constraints.
int CountConstraints(const Matrix<> & F, const Matrix<> & V, double size) {
  int count = 0;
  while (count < int(F.Height()) && L2Norm(Vector<>(F * V.Row(count))) < negligible * sqr(size))
    count++;
  return count;
}

/// Slip as frictionless, but sticking in the directions in which it is stiffer than the bulk.
void Symmetrize(LocalBlock & block) {
  size_t told = block.E1.Height(), count = block.E2.Height();
  if (block.slides) {
    Matrix<> rows(block.pivots.Size(), told), forces(block.pivots.Size(), told);
    for (int i : Range(block.pivots)) {
      rows.Row(i) = block.E1.Col(block.pivots[i]);
      forces.Row(i) = block.GL.Row(block.pivots[i]);
    }
    auto [values, vectors] = Eigensystem(Transposed(rows) * rows);
    for (int i : Range(told)) {
      Vector<> direction = vectors.Row(i);
      if (sqrt(max(values(i), 0.0)) * L2Norm(Vector<>(forces * direction)) <= 1)
        continue; // the diagonal of the scaled bulk is 1
      Matrix<> more(++count, block.dofs.Size());
      more.Rows(0, count - 1) = block.E2;
      more.Row(count - 1) = Trans(block.E1) * direction;
      block.E2 = std::move(more);
    }
  }
  block.slides = false;
  block.G2 = Trans(block.E2);
}
} // namespace

Array<int> ChoosePivots(FlatArray<int> dofs, const Matrix<> & G,
                        const function<bool(int)> & inner) {
  Array<int> candidates, pivots;
  for (int i : Range(dofs))
    if (inner(dofs[i]))
      candidates.Append(i);
  Matrix<> rest = G.Rows(candidates);
  double largest = L2Norm(G);
  while (pivots.Size() < G.Width() && candidates.Size()) {
    int best = 0;
    for (int i : Range(candidates))
      if (L2Norm2(rest.Row(i)) > (1 + 1e-8) * L2Norm2(rest.Row(best)))
        best = i;
    Vector<> direction = rest.Row(best);
    double size = L2Norm(direction);
    if (size <= least_pivot * largest)
      break;
    pivots.Append(candidates[best]);
    direction /= size;
    for (int i : Range(candidates))
      rest.Row(i) -= InnerProduct(rest.Row(i), direction) * direction;
  }
  return pivots;
}

void SplitBlock(LocalBlock & block, const SparseMatrix<double> & mat,
                const function<Array<int>(const Matrix<> & G)> & lifts) {
  auto [E, G, F] = Read(block, mat);
  size_t d = F.Height();
  double size = 0; // of the forces on the dofs of lifts
  for (int i : lifts(G))
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
  block.told = V1 * F1;
  block.E1 = block.U1 * E;
  block.GL = G * block.told;
  block.slides = L2Norm(block.E1) > 1e-13 * L2Norm(G);
  block.E2 = block.U2 * E;
  block.G2 = G * block.V2;
}

void FillPivots(LocalBlock & block, bool symmetric) {
  if (symmetric)
    Symmetrize(block);
  if (block.NConstraints() == 0)
    return;
  block.B = RightInverse(Transposed(block.E2), block.pivots);
  block.Bl = RightInverse(block.G2, block.pivots);
  block.complement = Projection(block.Bl) * Projection(block.B);
}
} // namespace ngslac
