// SPDX-License-Identifier: LGPL-2.1-or-later
#include "condense.hpp"
#include "blocksum.hpp"

namespace ngslac {
namespace {
/// Of the constraints, in units of the diagonal of K: three times as stiff as the latter takes the
/// fewest iterations, 1 and 10 take a fifth more.
constexpr double penalty = 3;
/// Error of a product with a lift, relative: constraints that depend on each other leave more.
constexpr double inexact = 1e-6;
const char * dependent = "ngslac: constraints of macro-elements depend on each other";

void CheckNumbers(size_t n, FlatArray<int> multipliers, int d, const BitArray & free) {
  if (free.Size() != n)
    throw Exception("Condensation: " + ToString(free.Size()) + " bits of free dofs for " +
                    ToString(n) + " rows");
  if (d < 1 || multipliers.Size() % d)
    throw Exception("Condensation: " + ToString(multipliers.Size()) +
                    " multipliers are no blocks of " + ToString(d));
  for (int i : multipliers)
    if (i < 0 || size_t(i) >= n)
      throw Exception("Condensation: there is no multiplier " + ToString(i) + " among " +
                      ToString(n) + " rows");
}

/// y += s mat x
void AddTimes(double s, const SparseMatrix<double> & mat, FlatVector<> x, FlatVector<> y) {
  ParallelFor(mat.Height(), [&](size_t i) {
    if (mat.GetRowIndices(i).Size())
      y(i) += s * mat.RowTimesVector(i, x);
  });
}

shared_ptr<SparseMatrix<double>> FromRows(FlatArray<SparseRow> rows, size_t width) {
  Array<int> sizes(rows.Size());
  for (size_t i : Range(rows))
    sizes[i] = rows[i].columns.Size();
  auto mat = make_shared<SparseMatrix<double>>(sizes, width);
  ParallelFor(rows.Size(), [&](size_t i) {
    mat->GetRowIndices(i) = rows[i].columns;
    std::copy(rows[i].values.begin(), rows[i].values.end(), mat->GetRowValues(i).Data());
  });
  return mat;
}

Vector<> Times(const BaseMatrix & mat, FlatVector<> r) {
  Vector<> y(r.Size());
  VFlatVector<double> in(r.Size(), r.Data()), out(y.Size(), y.Data());
  mat.Mult(in, out);
  return y;
}

shared_ptr<SparseMatrix<double>> Transposed(const SparseMatrix<double> & mat) {
  return dynamic_pointer_cast<SparseMatrix<double>>(mat.CreateTranspose(true));
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

Condensation::Condensation(shared_ptr<SparseMatrix<double>> amat, FlatArray<int> multipliers,
                           int ad, const BitArray & afree)
    : SquareOperator(*amat), mat(amat), free(make_shared<BitArray>(afree)), d(ad) {
  static Timer timer("ngslac::Condense");
  RegionTimer reg(timer);
  CheckNumbers(mat->Height(), multipliers, d, *free);
  Supports(multipliers);
  terms.SetSize(blocks.Size());
  std::atomic<bool> fails = false;
  ParallelFor(blocks.Size(), [&](size_t m) {
    try {
      SplitBlock(blocks[m], *mat, FreeDofs(m));
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

void Condensation::Supports(FlatArray<int> multipliers) {
  size_t n = mat->Height();
  ismultiplier.SetSize(n);
  ismultiplier = false;
  for (int i : multipliers) {
    if (!free->Test(i))
      throw Exception("ngslac: a multiplier is not free");
    ismultiplier[i] = true;
    free->Clear(i);
  }
  blocks.SetSize(multipliers.Size() / d);
  ParallelFor(blocks.Size(), [&](size_t m) {
    auto & block = blocks[m];
    block.multipliers = multipliers.Range(d * m, d * (m + 1));
    for (int lam : block.multipliers)
      for (int j : mat->GetRowIndices(lam))
        if (!ismultiplier[j])
          block.dofs.Append(j);
    SortUnique(block.dofs);
  });
  TableCreator<int> creator(n);
  for (; !creator.Done(); creator++)
    for (int m : Range(blocks))
      for (int dof : blocks[m].dofs)
        creator.Add(dof, m);
  touching = creator.MoveTable();
}

/// Positions.
Array<int> Condensation::FreeDofs(int m) const {
  Array<int> found;
  for (int j : Range(blocks[m].dofs))
    if (free->Test(blocks[m].dofs[j]))
      found.Append(j);
  return found;
}

void Condensation::FillTerm(int m) {
  auto & block = blocks[m];
  size_t solved = block.slides ? block.E1.Height() : 0, n = block.dofs.Size();
  size_t count = solved + block.NConstraints();
  auto & term = terms[m];
  term.dofs.Assign(block.dofs);
  term.left.SetSize(n, count);
  term.right.SetSize(count, n);
  if (solved) {
    term.left.Cols(0, solved) = -1 * block.GL;
    term.right.Rows(0, solved) = block.E1;
  }
  if (block.NConstraints()) {
    term.left.Cols(solved, count) = block.G2;
    term.right.Rows(solved, count) = Stiffness(block, FreeDofs(m)) * block.E2;
  }
}

void Condensation::NumberConstraints() {
  first.SetSize(blocks.Size() + 1);
  first[0] = 0;
  for (int m : Range(blocks))
    first[m + 1] = first[m] + blocks[m].NConstraints();
  constraints = Stacked([&](int m) { return blocks[m].E2; });
  forces = Transposed(HasSymmetricContact() ? *constraints : *Stacked([&](int m) {
    return Matrix<>(Trans(blocks[m].G2));
  }));
  slips = Stacked([&](int m) {
    auto & block = blocks[m];
    return block.slides ? block.E1 : Matrix<>(0.0 * block.E1);
  });
  pushes = Transposed(*Stacked([&](int m) { return Matrix<>(Trans(blocks[m].GL)); }));
}

shared_ptr<SparseMatrix<double>>
Condensation::Stacked(const function<const Matrix<>(int)> & rows) const {
  Array<Array<SparseRow>> local(blocks.Size());
  ParallelFor(blocks.Size(), [&](size_t m) {
    const Matrix<> values = rows(m);
    local[m].SetSize(values.Height());
    for (int q : Range(values.Height()))
      for (int j : Range(blocks[m].dofs))
        if (int dof = blocks[m].dofs[j]; values(q, j) != 0 && free->Test(dof)) {
          local[m][q].columns.Append(dof);
          local[m][q].values.Append(values(q, j));
        }
  });
  Array<SparseRow> all;
  for (auto & part : local)
    for (auto & row : part)
      all.Append(std::move(row));
  return FromRows(all, mat->Height());
}

void Condensation::FillLifts() {
  bool symmetric = HasSymmetricContact();
  lift = symmetric ? forces : Transposed(*constraints);
  carry = symmetric ? constraints : Transposed(*forces);
  gram = Product(*constraints, *lift);
  inverse = Inverse(*gram);
  gramleft = symmetric ? gram : Product(*carry, *forces);
  inverseleft = symmetric ? inverse : Inverse(*gramleft);
}

bool Condensation::Changes(size_t row) const {
  if (!ismultiplier[row])
    for (int m : touching[row])
      if (blocks[m].NConstraints() || blocks[m].slides)
        return true;
  return false;
}

Array<int> Condensation::Constraints() const {
  Array<int> counts(blocks.Size());
  for (int m : Range(blocks))
    counts[m] = blocks[m].NConstraints();
  return counts;
}

bool Condensation::HasSymmetricContact() const {
  for (auto & block : blocks)
    if (block.slides || L2Norm(Matrix<>(block.E2 - Trans(block.G2))) > 1e-12 * L2Norm(block.E2))
      return false;
  return true;
}

void Condensation::SumRow(int row, RowSum & sum) const {
  auto columns = mat->GetRowIndices(row);
  auto values = mat->GetRowValues(row);
  for (int j : Range(columns))
    if (!ismultiplier[columns[j]])
      sum.Add(columns[j], values(j));
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

shared_ptr<SparseMatrix<double>> Condensation::Part(FlatArray<int> dofs,
                                                    const BitArray * wanted) const {
  Array<int> number(mat->Height());
  number = -1;
  for (int i : Range(dofs))
    if (int dof = dofs[i]; dof >= 0) {
      if (dof >= int(number.Size()) || number[dof] >= 0)
        throw Exception("Condensation: dof " + ToString(dof) + " is not there, or listed twice");
      number[dof] = i;
    }
  Array<SparseRow> rows(dofs.Size());
  ForEachSum(dofs.Size(), [&](size_t i, RowSum & sum) {
    if (wanted && !wanted->Test(i))
      return;
    ArrayMem<std::pair<int, double>, 300> entries;
    auto take = [&](FlatArray<int> columns, auto values) {
      for (int j : Range(columns))
        if (int column = columns[j]; number[column] >= 0 && !ismultiplier[column])
          entries.Append({number[column], values[j]});
    };
    int dof = dofs[i];
    if (dof < 0)
      entries.Append({int(i), 1.0});
    else if (touching[dof].Size()) {
      sum.Clear();
      SumRow(dof, sum);
      take(sum.Columns(), sum.Values());
    } else if (!ismultiplier[dof])
      take(mat->GetRowIndices(dof), mat->GetRowValues(dof));
    QuickSort(entries);
    rows[i].SetEntries(entries);
  });
  return FromRows(rows, dofs.Size());
}

Array<double> Condensation::Diagonal() const {
  Array<double> diagonal(mat->Height());
  ParallelFor(diagonal.Size(), [&](size_t i) {
    diagonal[i] = 0;
    if (ismultiplier[i])
      return;
    auto columns = mat->GetRowIndices(i);
    if (size_t j = columns.Pos(i); j < columns.Size())
      diagonal[i] = mat->GetRowValues(i)(j);
    for (int m : touching[i]) {
      int pos = terms[m].Position(i);
      for (int k : Range(terms[m].left.Width()))
        diagonal[i] += terms[m].left(pos, k) * terms[m].right(k, pos);
    }
  });
  return diagonal;
}

void Condensation::MultAdd(double s, const BaseVector & x, BaseVector & y) const {
  static Timer timer("ngslac::Condensation - Mult");
  RegionTimer reg(timer);
  Vector<> w = x.FV<double>();
  ClearFixed(w);
  Project(w);
  Vector<> image = Times(*mat, w);
  ToImage(w, image);
  y.FV<double>() += s * image;
}
void Condensation::ClearFixed(FlatVector<> x) const {
  ParallelFor(x.Size(), [&](size_t i) {
    if (!free->Test(i))
      x(i) = 0;
  });
}

void Condensation::AddLift(double s, FlatVector<> r, FlatVector<> u) const {
  if (first.Last())
    AddTimes(s, *lift, Times(*inverse, r), u);
}

Vector<> Condensation::Reactions(FlatVector<> f) const {
  Vector<> sums(first.Last());
  sums = 0.0;
  if (!first.Last())
    return sums;
  AddTimes(1, *carry, f, sums);
  return Times(*inverseleft, sums);
}

void Condensation::Project(FlatVector<> z) const {
  Vector<> jumps(first.Last());
  jumps = 0.0;
  AddTimes(1, *constraints, z, jumps);
  AddLift(-1, jumps, z);
}

void Condensation::Test(FlatVector<> f) const {
  AddTimes(-1, *forces, Reactions(f), f);
  ClearFixed(f);
}

void Condensation::ToImage(FlatVector<> w, FlatVector<> image) const {
  Vector<> solved(slips->Height());
  solved = 0.0;
  AddTimes(-1, *slips, w, solved);
  AddTimes(1, *pushes, solved, image);
  Test(image);
}

Vector<> Condensation::NearImage(FlatVector<> u) const {
  Array<bool> near(u.Size());
  near = false;
  for (size_t i : Range(near))
    if (Changes(i))
      for (int j : mat->GetRowIndices(i))
        near[j] = true;
  Vector<> image(u.Size());
  ParallelFor(near.Size(), [&](size_t i) { image(i) = near[i] ? mat->RowTimesVector(i, u) : 0; });
  return image;
}

Vector<> Condensation::Left(FlatVector<> rhs, FlatVector<> u, FlatVector<> image) const {
  Vector<> left = rhs - image, solved(slips->Height());
  ParallelFor(blocks.Size(), [&](size_t m) {
    solved.Range(SolvedOf(m)) = blocks[m].U1 * Gather(blocks[m].multipliers, rhs);
  });
  AddTimes(-1, *slips, u, solved);
  AddTimes(-1, *pushes, solved, left);
  return left;
}

Vector<> Condensation::Displacements(FlatVector<> rhs, FlatVector<> w) const {
  Vector<> u = w, r2(first.Last());
  Project(u);
  ParallelFor(blocks.Size(), [&](size_t m) {
    if (blocks[m].NConstraints())
      r2.Range(ConstraintsOf(m)) = blocks[m].U2 * Gather(blocks[m].multipliers, rhs);
  });
  AddLift(1, r2, u);
  ParallelFor(blocks.Size(), [&](size_t m) {
    for (int lam : blocks[m].multipliers)
      u(lam) = 0;
  });
  return u;
}

Vector<> Condensation::Reduce(FlatVector<> rhs, FlatVector<> u, FlatVector<> image) const {
  Vector<> reduced = Left(rhs, u, image);
  Test(reduced);
  return reduced;
}

void Condensation::Complete(FlatVector<> rhs, FlatVector<> image, FlatVector<> x) const {
  Vector<> reactions = Reactions(Left(rhs, x, image));
  ParallelFor(blocks.Size(), [&](size_t m) {
    auto & block = blocks[m];
    Vector<> solved = block.U1 * Gather(block.multipliers, rhs);
    solved -= block.E1 * Gather(block.dofs, x);
    Vector<> lam = block.solved * solved;
    if (block.NConstraints())
      lam += block.V2 * reactions.Range(ConstraintsOf(m));
    for (int k : Range(lam))
      x(block.multipliers[k]) = lam(k);
  });
}
} // namespace ngslac
