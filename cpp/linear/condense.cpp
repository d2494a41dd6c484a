// SPDX-License-Identifier: LGPL-2.1-or-later
#include "condense.hpp"

namespace ngslac {
namespace {
void CheckGiven(size_t n, FlatArray<int> multipliers, int d, const BitArray & free) {
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

Vector<> Solved(const BaseMatrix * inverse, Vector<> && r) {
  if (!inverse)
    return std::move(r);
  Vector<> y(r.Size());
  VFlatVector<double> in(r.Size(), r.Data()), out(y.Size(), y.Data());
  inverse->Mult(in, out);
  return y;
}
} // namespace

shared_ptr<SparseMatrix<double>> Transposed(const SparseMatrix<double> & mat) {
  return dynamic_pointer_cast<SparseMatrix<double>>(mat.CreateTranspose(true));
}

Condensation::Condensation(shared_ptr<SparseMatrix<double>> amat, FlatArray<int> multipliers,
                           int ad, const BitArray & afree)
    : SquareOperator(*amat), mat(amat), free(make_shared<BitArray>(afree)), d(ad) {
  CheckGiven(mat->Height(), multipliers, d, *free);
  Supports(multipliers);
}

void Condensation::NumberConstraints() {
  first.SetSize(blocks.Size() + 1);
  first[0] = 0;
  for (int m : Range(blocks))
    first[m + 1] = first[m] + blocks[m].NConstraints();
  FindNear();
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
  Array<int> sizes;
  for (auto & part : local)
    for (auto & row : part)
      sizes.Append(row.columns.Size());
  auto stacked = make_shared<SparseMatrix<double>>(sizes, mat->Height());
  size_t i = 0;
  for (auto & part : local)
    for (auto & row : part) {
      stacked->GetRowIndices(i) = row.columns;
      std::copy(row.values.begin(), row.values.end(), stacked->GetRowValues(i++).Data());
    }
  return stacked;
}

/// The graph of the given matrix is symmetric, or else the residual will tell.
void Condensation::FindNear() {
  Array<bool> held(mat->Height()), found(mat->Height());
  held = found = false;
  for (auto & block : blocks)
    for (int dof : block.dofs) {
      held[dof] = held[dof] || block.NConstraints();
      found[dof] = found[dof] || block.NConstraints() || block.slides;
    }
  for (int i : Range(touching))
    if (held[i])
      for (int j : mat->GetRowIndices(i))
        found[j] = !ismultiplier[j];
  near = Where(found);
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
    QuickSort(block.dofs);
    block.dofs.SetSize(std::unique(block.dofs.begin(), block.dofs.end()) - block.dofs.begin());
  });
  TableCreator<int> creator(n);
  for (; !creator.Done(); creator++)
    for (int m : Range(blocks))
      for (int dof : blocks[m].dofs)
        creator.Add(dof, m);
  touching = creator.MoveTable();
}

void Condensation::AddBulkRow(int row, double factor, RowSum & sum) const {
  auto columns = mat->GetRowIndices(row);
  auto values = mat->GetRowValues(row);
  for (int j : Range(columns))
    if (!ismultiplier[columns[j]])
      sum.Add(columns[j], factor * values(j));
}

void Condensation::AddLift(double s, FlatVector<> r, FlatVector<> u) const {
  if (first.Last())
    AddTimes(s, *lifts.lift, Solved(lifts.inverse.get(), Vector<>(r)), u);
}

Vector<> Condensation::Reactions(FlatVector<> f) const {
  Vector<> sums(first.Last());
  sums = 0.0;
  if (first.Last())
    AddTimes(1, *lifts.carry, f, sums);
  return Solved(first.Last() ? lifts.inverseleft.get() : nullptr, std::move(sums));
}

void Condensation::ClearFixed(FlatVector<> x) const {
  ParallelFor(x.Size(), [&](size_t i) {
    if (!free->Test(i))
      x(i) = 0;
  });
}

void Condensation::Project(FlatVector<> z) const {
  Vector<> jumps(first.Last());
  jumps = 0.0;
  AddTimes(1, *constraints, z, jumps);
  AddLift(-1, jumps, z);
}

void Condensation::ToImage(FlatVector<> w, FlatVector<> image) const {
  Vector<> told(slips->Height());
  told = 0.0;
  AddTimes(-1, *slips, w, told);
  AddTimes(1, *pushes, told, image);
  AddTimes(-1, *forces, Reactions(image), image);
  ClearFixed(image);
}

/// f - G (multipliers that r tells) - K u,  near the constraints: u is zero elsewhere, or what is
/// left there does not count.
Vector<> Condensation::Left(FlatVector<> rhs, FlatVector<> u) const {
  Vector<> left = rhs, told(slips->Height());
  ParallelFor(near.Size(), [&](size_t i) { left(near[i]) -= mat->RowTimesVector(near[i], u); });
  ParallelFor(blocks.Size(), [&](size_t m) {
    told.Range(ToldOf(m)) = blocks[m].U1 * Gather(blocks[m].multipliers, rhs);
  });
  AddTimes(-1, *slips, u, told);
  AddTimes(-1, *pushes, told, left);
  return left;
}

/// Displacements of the lifts alone with  E2 u = r2.
Vector<> Condensation::Particular(FlatVector<> rhs) const {
  Vector<> u(rhs.Size()), r2(first.Last());
  u = 0.0;
  ParallelFor(blocks.Size(), [&](size_t m) {
    if (blocks[m].NConstraints())
      r2.Range(ConstraintsOf(m)) = blocks[m].U2 * Gather(blocks[m].multipliers, rhs);
  });
  AddLift(1, r2, u);
  return u;
}

void Condensation::Reduce(FlatVector<> rhs, FlatVector<> reduced) const {
  Vector<> left = Left(rhs, Particular(rhs));
  reduced = left;
  AddTimes(-1, *forces, Reactions(left), reduced);
  ClearFixed(reduced);
}

void Condensation::Expand(FlatVector<> rhs, FlatVector<> w, FlatVector<> x) const {
  Vector<> projected = w;
  Project(projected);
  x = Particular(rhs) + projected;
  Vector<> reactions = Reactions(Left(rhs, x));
  ParallelFor(blocks.Size(), [&](size_t m) {
    auto & block = blocks[m];
    Vector<> told = block.U1 * Gather(block.multipliers, rhs);
    told -= block.E1 * Gather(block.dofs, x);
    Vector<> lam = block.told * told;
    if (block.NConstraints())
      lam += block.V2 * reactions.Range(ConstraintsOf(m));
    for (int k : Range(lam))
      x(block.multipliers[k]) = lam(k);
  });
}
} // namespace ngslac
