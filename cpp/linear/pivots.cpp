// SPDX-License-Identifier: LGPL-2.1-or-later
#include "pivots.hpp"

namespace ngslac {
namespace {
/// Rows of the transposed lift, which has entries at the pivots only.
Matrix<> Spread(const LocalBlock & block, const Matrix<> & lift) {
  Matrix<> rows(block.NConstraints(), block.dofs.Size());
  rows = 0.0;
  for (int p : Range(lift.Height()))
    rows.Col(block.pivots[p]) = lift.Row(p);
  return rows;
}
} // namespace

PivotCondensation::PivotCondensation(shared_ptr<SparseMatrix<double>> amat,
                                     FlatArray<int> multipliers, int d, const BitArray & afree,
                                     bool symmetric)
    : Condensation(amat, multipliers, d, afree) {
  static Timer timer("ngslac::Condense");
  RegionTimer reg(timer);
  auto inner = [&](int dof) { return free->Test(dof) && touching[dof].Size() == 1; };
  std::atomic<bool> fails = false;
  ParallelFor(blocks.Size(), [&](size_t m) {
    try {
      SplitBlock(blocks[m], *mat, [&](const Matrix<> & G) {
        blocks[m].pivots = ChoosePivots(blocks[m].dofs, G, inner);
        return Array<int>(blocks[m].pivots);
      });
      FillPivots(blocks[m], symmetric);
    } catch (const Exception &) {
      fails = true;
    }
  });
  if (fails)
    throw Exception("ngslac: a macro-element has no displacement of its own to be eliminated");
  NumberConstraints();
  pivotblock.SetSize(mat->Height());
  pivotblock = -1;
  for (int m : Range(blocks))
    if (blocks[m].NConstraints())
      for (int p : blocks[m].pivots)
        pivotblock[blocks[m].dofs[p]] = m;
  FillLifts();
  auto carried = Carried();
  rows = make_shared<ExplicitRows>(mat, ismultiplier, ChangedRows(),
                                   [&](int row, RowSum & sum) { SumRow(row, carried, sum); });
}

void PivotCondensation::MultAdd(double s, const BaseVector & x, BaseVector & y) const {
  static Timer timer("ngslac::Condensation - Mult");
  RegionTimer reg(timer);
  rows->AddProduct(s, x.FV<double>(), y.FV<double>());
}

void PivotCondensation::FillLifts() {
  lifts.lift = Transposed(*Stacked([&](int m) { return Spread(blocks[m], blocks[m].B); }));
  lifts.carry = Stacked([&](int m) { return Spread(blocks[m], blocks[m].Bl); });
}

/// Adds a row of  K - sum GL E1.
void PivotCondensation::AddRow(int row, double factor, RowSum & sum) const {
  AddBulkRow(row, factor, sum);
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
void PivotCondensation::Project(RowSum & sum) const {
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
Array<Array<SparseRow>> PivotCondensation::Carried() const {
  Array<Array<SparseRow>> carried(blocks.Size());
  ForEachSum(blocks.Size(), [&](size_t m, RowSum & sum) {
    auto & block = blocks[m];
    carried[m].SetSize(block.NConstraints());
    for (int k : Range(block.NConstraints())) {
      for (int p : Range(block.pivots))
        AddRow(block.dofs[block.pivots[p]], block.Bl(p, k), sum);
      Project(sum);
      carried[m][k] = TakeRow(sum);
    }
  });
  return carried;
}

/// Displacements on which a multiplier acts, or with a pivot among their columns.
Array<int> PivotCondensation::ChangedRows() const {
  size_t n = mat->Height();
  Array<bool> changes(n);
  ParallelFor(n, [&](size_t i) {
    changes[i] = !ismultiplier[i] && touching[i].Size();
    if (!ismultiplier[i])
      for (int j : mat->GetRowIndices(i))
        changes[i] = changes[i] || pivotblock[j] >= 0;
  });
  return Where(changes);
}

/// Sums up a row of A.
void PivotCondensation::SumRow(int row, FlatArray<Array<SparseRow>> carried, RowSum & sum) const {
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

} // namespace ngslac
