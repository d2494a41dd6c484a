// SPDX-License-Identifier: LGPL-2.1-or-later
#include "orthogonal.hpp"

namespace ngslac {
namespace {
/// Of the constraints, in units of the diagonal of K: three times as stiff as the latter takes the
/// fewest iterations, 1 and 10 take a fifth more.
constexpr double penalty = 3;
/// Error of a product with a lift, relative: constraints that depend on each other leave more.
constexpr double inexact = 1e-6;
const char * dependent = "ngslac: constraints of macro-elements depend on each other";

Vector<> Times(const BaseMatrix & mat, FlatVector<> r) {
  Vector<> y(r.Size());
  VFlatVector<double> in(r.Size(), r.Data()), out(y.Size(), y.Data());
  mat.Mult(in, out);
  return y;
}

shared_ptr<SparseMatrix<double>> Product(const SparseMatrix<double> & a,
                                         const SparseMatrix<double> & b) {
  return dynamic_pointer_cast<SparseMatrix<double>>(MatMult(a, b));
}

/// Cholesky factorisation; throws where the matrix is singular.
shared_ptr<BaseMatrix> Inverse(const SparseMatrix<double> & gram) {
  gram.SetInverseType("sparsecholesky");
  auto inverse = gram.InverseMatrix();
  Vector<> x(gram.Height());
  for (size_t i : Range(x))
    x(i) = 1 + 0.5 * cos(double(i));
  Vector<> error = Times(gram, Times(*inverse, x)) - x;
  if (!(L2Norm(error) <= inexact * L2Norm(x)))
    throw Exception(dependent);
  return inverse;
}

/// The penalty's stiffness is that of the constraints on the free dofs.
Matrix<> Stiffness(const LocalBlock & block, FlatArray<int> free) {
  Matrix<> E(block.NConstraints(), free.Size()), Gt(block.NConstraints(), free.Size());
  for (int j : Range(free)) {
    E.Col(j) = block.E2.Col(free[j]);
    Gt.Col(j) = block.G2.Row(free[j]);
  }
  Matrix<> right = E * Trans(E), left = Gt * Trans(Gt);
  CalcInverse(right);
  CalcInverse(left);
  Matrix<> product = Gt * Trans(E);
  return penalty * left * Matrix<>(product * right);
}
} // namespace

OrthogonalCondensation::OrthogonalCondensation(shared_ptr<SparseMatrix<double>> amat,
                                               FlatArray<int> multipliers, int d,
                                               const BitArray & afree)
    : Condensation(amat, multipliers, d, afree) {
  static Timer timer("ngslac::Condense");
  RegionTimer reg(timer);
  terms.SetSize(blocks.Size());
  std::atomic<bool> fails = false;
  ParallelFor(blocks.Size(), [&](size_t m) {
    try {
      SplitBlock(blocks[m], *mat, [&](const Matrix<> &) { return FreeDofs(m); });
      FillTerm(m);
    } catch (const Exception &) {
      fails = true;
    }
  });
  if (fails)
    throw Exception(dependent);
  NumberConstraints();
  if (first.Last())
    FillLifts();
}

void OrthogonalCondensation::FillLifts() {
  bool symmetric = HasSymmetricContact();
  lifts.lift = symmetric ? forces : Transposed(*constraints);
  lifts.carry = symmetric ? constraints : Transposed(*forces);
  lifts.gram = Product(*constraints, *lifts.lift);
  lifts.inverse = Inverse(*lifts.gram);
  lifts.gramleft = symmetric ? lifts.gram : Product(*lifts.carry, *forces);
  lifts.inverseleft = symmetric ? lifts.inverse : Inverse(*lifts.gramleft);
}

/// Positions.
Array<int> OrthogonalCondensation::FreeDofs(int m) const {
  Array<int> found;
  for (int j : Range(blocks[m].dofs))
    if (free->Test(blocks[m].dofs[j]))
      found.Append(j);
  return found;
}

void OrthogonalCondensation::FillTerm(int m) {
  auto & block = blocks[m];
  size_t told = block.slides ? block.E1.Height() : 0, n = block.dofs.Size();
  size_t count = told + block.NConstraints();
  auto & term = terms[m];
  term.dofs.Assign(block.dofs);
  term.left.SetSize(n, count);
  term.right.SetSize(count, n);
  if (told) {
    term.left.Cols(0, told) = -1 * block.GL;
    term.right.Rows(0, told) = block.E1;
  }
  if (block.NConstraints()) {
    term.left.Cols(told, count) = block.G2;
    term.right.Rows(told, count) = Stiffness(block, FreeDofs(m)) * block.E2;
  }
}

void OrthogonalCondensation::SumRow(int row, RowSum & sum) const {
  AddBulkRow(row, 1, sum);
  for (int m : touching[row]) {
    auto & term = terms[m];
    int pos = term.Position(row);
    for (int k : Range(term.left.Width()))
      if (double force = term.left(pos, k); force != 0)
        for (int j : Range(term.dofs))
          if (double e = term.right(k, j); e != 0)
            sum.Add(term.dofs[j], force * e);
  }
}

shared_ptr<ExplicitRows> OrthogonalCondensation::Rows() const {
  Array<bool> changes(mat->Height());
  ParallelFor(changes.Size(), [&](size_t i) { changes[i] = Changes(i); });
  return make_shared<ExplicitRows>(mat, ismultiplier, Where(changes),
                                   [&](int row, RowSum & sum) { SumRow(row, sum); });
}

void OrthogonalCondensation::MultAdd(double s, const BaseVector & x, BaseVector & y) const {
  static Timer timer("ngslac::Condensation - Mult");
  RegionTimer reg(timer);
  Vector<> w = x.FV<double>(), image(x.Size());
  ClearFixed(w);
  Project(w);
  image = 0.0;
  VFlatVector<double> from(w.Size(), w.Data()), to(image.Size(), image.Data());
  mat->MultAdd(1, from, to);
  ToImage(w, image);
  y.FV<double>() += s * image;
}
} // namespace ngslac
