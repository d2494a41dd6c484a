#include "condense.hpp"

namespace ngslac {
namespace {
void Subtract(FlatVector<> x, FlatArray<int> dofs, const Vector<> & values) {
  for (int i : Range(dofs))
    x(dofs[i]) -= values(i);
}

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

} // namespace

Condensation::Condensation(shared_ptr<SparseMatrix<double>> amat, FlatArray<int> multipliers, int d,
                           const BitArray & afree)
    : SquareOperator(*amat), mat(amat), free(make_shared<BitArray>(afree)) {
  CheckGiven(mat->Height(), multipliers, d, *free);
  Supports(multipliers, d);
  place.SetSize(mat->Height());
  place = -1;
}

void Condensation::NumberConstraints() {
  first.SetSize(blocks.Size() + 1);
  first[0] = 0;
  for (int m : Range(blocks))
    first[m + 1] = first[m] + blocks[m].NConstraints();
  FindNear();
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

void Condensation::StoreRows(FlatArray<int> changed,
                             const function<void(int, RowSum &)> & sum_row) {
  rows.SetSize(changed.Size());
  ForEachSum(changed.Size(), [&](size_t c, RowSum & sum) {
    place[changed[c]] = c;
    sum_row(changed[c], sum);
    rows[c] = TakeRow(sum);
  });
}

Array<double> Condensation::Diagonal() const {
  Array<double> diagonal(mat->Height());
  ParallelFor(diagonal.Size(), [&](size_t i) {
    auto columns = Columns(i);
    size_t j = columns.Pos(i);
    diagonal[i] = j < columns.Size() ? Values(i)(j) : 0;
  });
  return diagonal;
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

void Condensation::Supports(FlatArray<int> multipliers, int d) {
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

void Condensation::AddRow(int row, double factor, RowSum & sum) const {
  auto columns = mat->GetRowIndices(row);
  auto values = mat->GetRowValues(row);
  for (int j : Range(columns))
    if (!ismultiplier[columns[j]])
      sum.Add(columns[j], factor * values(j));
  for (int m : touching[row]) {
    auto & block = blocks[m];
    if (!block.slides)
      continue;
    int pos = block.Position(row);
    for (int q : Range(block.E1.Height()))
      if (double force = factor * block.GL(pos, q); force != 0)
        for (int j : Range(block.dofs))
          if (block.E1(q, j) != 0)
            sum.Add(block.dofs[j], -force * block.E1(q, j));
  }
}

FlatArray<int> Condensation::Columns(size_t row) const {
  if (ismultiplier[row])
    return FlatArray<int>(0, nullptr);
  return place[row] >= 0 ? FlatArray<int>(rows[place[row]].columns) : mat->GetRowIndices(row);
}

FlatVector<> Condensation::Values(size_t row) const {
  if (ismultiplier[row])
    return FlatVector<>(0, nullptr);
  if (place[row] < 0)
    return mat->GetRowValues(row);
  auto & values = rows[place[row]].values;
  return FlatVector<>(values.Size(), values.Data());
}

shared_ptr<SparseMatrix<double>> Condensation::Part(const BitArray * bits) const {
  size_t n = mat->Height();
  if (bits && bits->Size() != n)
    throw Exception("Condensation: " + ToString(bits->Size()) + " bits for " + ToString(n) +
                    " rows");
  Array<int> number(n), dofs;
  number = -1;
  for (int i : Range(n))
    if (!bits || bits->Test(i)) {
      number[i] = dofs.Size();
      dofs.Append(i);
    }
  Array<int> sizes(dofs.Size());
  ParallelFor(dofs.Size(), [&](size_t i) {
    sizes[i] = 0;
    for (int j : Columns(dofs[i]))
      sizes[i] += number[j] >= 0;
  });
  auto part = make_shared<SparseMatrix<double>>(sizes, dofs.Size());
  ParallelFor(dofs.Size(), [&](size_t i) {
    auto from = Columns(dofs[i]), columns = part->GetRowIndices(i);
    auto entries = Values(dofs[i]), values = part->GetRowValues(i);
    Array<int> order(from.Size());
    for (int j : Range(order))
      order[j] = j;
    if (place[dofs[i]] >= 0) // others are sorted
      QuickSortI(from, order);
    int k = 0;
    for (int j : order)
      if (number[from[j]] >= 0) {
        columns[k] = number[from[j]];
        values(k++) = entries(j);
      }
  });
  return part;
}

void Condensation::AddProduct(double s, FlatVector<> x, FlatVector<> y) const {
  ParallelFor(mat->Height(), [&](size_t i) {
    auto columns = Columns(i);
    auto values = Values(i);
    double sum = 0;
    for (size_t j : Range(columns))
      sum += values(j) * x(columns[j]);
    y(i) += s * sum;
  });
}

Vector<> Condensation::Jumps(FlatVector<> u) const {
  Vector<> jumps(first.Last());
  ParallelFor(blocks.Size(), [&](size_t m) {
    if (blocks[m].NConstraints())
      jumps.Range(ConstraintsOf(m)) = blocks[m].E2 * Gather(blocks[m].dofs, u);
  });
  return jumps;
}

void Condensation::SubtractReactions(FlatVector<> reactions, FlatVector<> forces) const {
  for (int m : Range(blocks))
    if (blocks[m].NConstraints())
      Subtract(forces, blocks[m].dofs, blocks[m].G2 * reactions.Range(ConstraintsOf(m)));
}

/// f - G (multipliers that r tells) - K u,  near the constraints: u is zero elsewhere, or what is
/// left there does not count.
Vector<> Condensation::Left(FlatVector<> rhs, FlatVector<> u) const {
  Vector<> left = rhs;
  ParallelFor(near.Size(), [&](size_t i) { left(near[i]) -= mat->RowTimesVector(near[i], u); });
  for (auto & block : blocks) {
    Vector<> told = block.U1 * Gather(block.multipliers, rhs);
    if (block.slides)
      told -= block.E1 * Gather(block.dofs, u);
    Subtract(left, block.dofs, block.GL * told);
  }
  return left;
}

/// Displacements of the lifts alone with  E2 u = r2.
Vector<> Condensation::Particular(FlatVector<> rhs) const {
  Vector<> u(rhs.Size()), r2(first.Last());
  u = 0.0;
  for (int m : Range(blocks))
    if (auto & block = blocks[m]; block.NConstraints())
      r2.Range(ConstraintsOf(m)) = block.U2 * Gather(block.multipliers, rhs);
  AddLift(1, r2, u);
  return u;
}

void Condensation::Reduce(FlatVector<> rhs, FlatVector<> reduced) const {
  Vector<> left = Left(rhs, Particular(rhs));
  reduced = left;
  SubtractReactions(Reactions(left), reduced);
  for (size_t i : Range(reduced))
    if (!free->Test(i))
      reduced(i) = 0;
}

void Condensation::Expand(FlatVector<> rhs, FlatVector<> w, FlatVector<> x) const {
  x = Particular(rhs) + w;
  AddLift(-1, Jumps(w), x);
  Vector<> reactions = Reactions(Left(rhs, x));
  for (int m : Range(blocks)) {
    auto & block = blocks[m];
    Vector<> told = block.U1 * Gather(block.multipliers, rhs);
    told -= block.E1 * Gather(block.dofs, x);
    Vector<> lam = block.told * told;
    if (block.NConstraints())
      lam += block.V2 * reactions.Range(ConstraintsOf(m));
    for (int k : Range(lam))
      x(block.multipliers[k]) = lam(k);
  }
}
} // namespace ngslac
