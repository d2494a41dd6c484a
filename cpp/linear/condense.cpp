#include "condense.hpp"
#include "indexmap.hpp"

namespace ngslac {
namespace {
Vector<> Gather(FlatArray<int> dofs, FlatVector<> x) {
  Vector<> values(dofs.Size());
  for (int i : Range(dofs))
    values(i) = x(dofs[i]);
  return values;
}

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

/// Calls f(i, sum) for all i, in parallel, with one RowSum per range.
template <typename F>
void ForEach(size_t count, F f) {
  ParallelForRange(count, [&](IntRange range) {
    RowSum sum;
    for (auto i : range)
      f(i, sum);
  });
}

/// The sum; starts the next one.
SparseRow Take(RowSum & sum) {
  SparseRow row{Array<int>(sum.Columns()), Array<double>(sum.Values())};
  sum.Clear();
  return row;
}
} // namespace

Condensation::Condensation(shared_ptr<SparseMatrix<double>> amat, FlatArray<int> multipliers, int d,
                           const BitArray & afree, bool symmetric)
    : SquareOperator(*amat), mat(amat), free(make_shared<BitArray>(afree)) {
  static Timer timer("ngslac::Condense");
  RegionTimer reg(timer);
  CheckGiven(mat->Height(), multipliers, d, *free);
  Supports(multipliers, d);
  auto inner = [&](int dof) { return free->Test(dof) && touching[dof].Size() == 1; };
  std::atomic<bool> fails = false;
  ParallelFor(blocks.Size(), [&](size_t m) {
    try {
      FillBlock(blocks[m], *mat, symmetric, inner);
    } catch (const Exception &) {
      fails = true;
    }
  });
  if (fails)
    throw Exception("ngslac: a macro-element has no displacement of its own to be eliminated");
  pivotblock.SetSize(mat->Height());
  pivotblock = -1;
  for (int m : Range(blocks))
    if (blocks[m].NConstraints())
      for (int p : blocks[m].pivots)
        pivotblock[blocks[m].dofs[p]] = m;

  auto carried = Carried();
  auto changed = ChangedRows();
  place.SetSize(mat->Height());
  place = -1;
  rows.SetSize(changed.Size());
  ForEach(changed.Size(), [&](size_t c, RowSum & sum) {
    place[changed[c]] = c;
    SumRow(changed[c], carried, sum);
    rows[c] = Take(sum);
  });
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

/// Adds a row of  K - sum GL E1.
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

/// Multiplies by P from the right.
void Condensation::Project(RowSum & sum) const {
  ArrayMem<int, 20> found;
  for (int column : sum.Columns())
    if (int m = pivotblock[column]; m >= 0 && !found.Contains(m))
      found.Append(m);
  for (int m : found) {
    auto & block = blocks[m];
    Vector<> reaction(block.NConstraints());
    reaction = 0.0;
    for (int p : Range(block.pivots))
      reaction += sum[block.dofs[block.pivots[p]]] * block.B.Row(p);
    for (int k : Range(reaction))
      for (int j : Range(block.dofs))
        if (double e = block.E2(k, j); e != 0)
          sum.Add(block.dofs[j], -reaction(k) * e);
  }
}

/// Rows  Bl^T K P  of each macro-element: what the reactions carry to the other rows.
Array<Array<SparseRow>> Condensation::Carried() const {
  Array<Array<SparseRow>> carried(blocks.Size());
  ForEach(blocks.Size(), [&](size_t m, RowSum & sum) {
    auto & block = blocks[m];
    carried[m].SetSize(block.NConstraints());
    for (int k : Range(block.NConstraints())) {
      for (int p : Range(block.pivots))
        AddRow(block.dofs[block.pivots[p]], block.Bl(p, k), sum);
      Project(sum);
      carried[m][k] = Take(sum);
    }
  });
  return carried;
}

/// Displacements on which a multiplier acts, or with a pivot among their columns.
Array<int> Condensation::ChangedRows() const {
  size_t n = mat->Height();
  Array<bool> changes(n);
  ParallelFor(n, [&](size_t i) {
    changes[i] = !ismultiplier[i] && touching[i].Size();
    if (!ismultiplier[i])
      for (int j : mat->GetRowIndices(i))
        changes[i] = changes[i] || pivotblock[j] >= 0;
  });
  Array<int> rows;
  for (size_t i : Range(n))
    if (changes[i])
      rows.Append(i);
  return rows;
}

/// Sums up a row of A.
void Condensation::SumRow(int row, FlatArray<Array<SparseRow>> carried, RowSum & sum) const {
  AddRow(row, 1, sum);
  Project(sum);
  for (int m : touching[row]) {
    auto & block = blocks[m];
    int pos = block.Position(row);
    for (int k : Range(block.NConstraints()))
      if (double force = block.G2(pos, k); force != 0) {
        auto & [columns, values] = carried[m][k];
        for (int j : Range(columns))
          sum.Add(columns[j], -force * values[j]);
      }
    for (int p : Range(block.complement.Height()))
      if (block.pivots[p] == pos)
        for (int q : Range(block.pivots))
          sum.Add(block.dofs[block.pivots[q]], block.complement(p, q));
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

void Condensation::MultAdd(double s, const BaseVector & x, BaseVector & y) const {
  static Timer timer("ngslac::Condensation - Mult");
  RegionTimer reg(timer);
  auto from = x.FV<double>();
  auto to = y.FV<double>();
  ParallelFor(mat->Height(), [&](size_t i) {
    auto columns = Columns(i);
    auto values = Values(i);
    double sum = 0;
    for (size_t j : Range(columns))
      sum += values(j) * from(columns[j]);
    to(i) += s * sum;
  });
}

/// K (u of x) on the displacements, with the local terms.
Vector<> Condensation::Forces(FlatVector<> u) const {
  Vector<> forces(u.Size());
  VFlatVector<double> in(u.Size(), u.Data()), out(forces.Size(), forces.Data());
  mat->Mult(in, out);
  for (auto & block : blocks)
    if (block.slides)
      Subtract(forces, block.dofs, block.GL * Vector<>(block.E1 * Gather(block.dofs, u)));
  return forces;
}

/// f - G (multipliers that r tells) - K u
Vector<> Condensation::Left(FlatVector<> rhs, FlatVector<> u) const {
  Vector<> left = rhs - Forces(u);
  for (auto & block : blocks)
    Subtract(left, block.dofs, block.GL * Vector<>(block.U1 * Gather(block.multipliers, rhs)));
  return left;
}

/// Displacements of the pivots alone with  E2 u = r2.
Vector<> Condensation::Particular(FlatVector<> rhs) const {
  Vector<> u(rhs.Size());
  u = 0.0;
  for (auto & block : blocks)
    if (block.NConstraints()) {
      Vector<> r2 = Matrix<>(block.B * block.U2) * Gather(block.multipliers, rhs);
      for (int p : Range(block.pivots))
        u(block.dofs[block.pivots[p]]) = r2(p);
    }
  return u;
}

void Condensation::Reduce(FlatVector<> rhs, FlatVector<> reduced) const {
  Vector<> left = Left(rhs, Particular(rhs));
  reduced = left;
  for (auto & block : blocks)
    if (block.NConstraints())
      Subtract(reduced, block.dofs, block.G2 * block.Reactions(left));
  for (size_t i : Range(reduced))
    if (!free->Test(i))
      reduced(i) = 0;
}

void Condensation::Expand(FlatVector<> rhs, FlatVector<> w, FlatVector<> x) const {
  x = Particular(rhs) + w;
  for (auto & block : blocks)
    if (block.NConstraints()) {
      Vector<> local = block.B * Vector<>(block.E2 * Gather(block.dofs, w));
      for (int p : Range(block.pivots))
        x(block.dofs[block.pivots[p]]) -= local(p);
    }
  Vector<> left = Left(rhs, x);
  for (auto & block : blocks) {
    Vector<> told = block.U1 * Gather(block.multipliers, rhs);
    told -= block.E1 * Gather(block.dofs, x);
    Vector<> lam = block.told * told;
    if (block.NConstraints())
      lam += block.V2 * block.Reactions(left);
    for (int k : Range(lam))
      x(block.multipliers[k]) = lam(k);
  }
}
} // namespace ngslac
