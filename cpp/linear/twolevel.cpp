// SPDX-License-Identifier: LGPL-2.1-or-later
#include "twolevel.hpp"

namespace ngslac {
SparseRows SparseRows::Transposed(size_t width) const {
  SparseRows result;
  result.starts.SetSize(width + 1);
  result.starts = 0;
  for (int column : columns)
    result.starts[column + 1]++;
  for (size_t column : Range(width))
    result.starts[column + 1] += result.starts[column];
  result.columns.SetSize(columns.Size());
  result.values.SetSize(columns.Size());
  Array<int> next(result.starts.Range(0, width));
  for (size_t row : Range(Size()))
    for (size_t j : Row(row)) {
      int k = next[columns[j]]++;
      result.columns[k] = row;
      result.values[k] = values[j];
    }
  return result;
}

Prolongation::Prolongation(const SparseRows & given, FlatArray<int> dofs, FlatArray<int> slot,
                           size_t width) {
  if (given.starts.Size() != dofs.Size() + 1 || given.starts[0] != 0 ||
      given.columns.Size() != given.values.Size() ||
      size_t(given.starts.Last()) != given.columns.Size())
    throw Exception("TwoLevel: the prolongation does not fit its dofs");
  for (size_t i : Range(dofs))
    if (given.starts[i] > given.starts[i + 1])
      throw Exception("TwoLevel: the prolongation does not fit its dofs");
  for (int column : given.columns)
    if (column < 0 || size_t(column) >= width)
      throw Exception("TwoLevel: the coarse system does not fit the prolongation");
  Array<std::pair<int, int>> order; // slot, row
  for (int i : Range(dofs)) {
    if (dofs[i] < 0 || size_t(dofs[i]) >= slot.Size() || slot[dofs[i]] < 0)
      throw Exception("TwoLevel: dof " + ToString(dofs[i]) + " of the coarse system is not free");
    if (given.starts[i] < given.starts[i + 1])
      order.Append({slot[dofs[i]], i});
  }
  QuickSort(order);
  rows.starts.Append(0);
  for (auto [s, row] : order) {
    slots.Append(s);
    for (size_t j : given.Row(row)) {
      rows.columns.Append(given.columns[j]);
      rows.values.Append(given.values[j]);
    }
    rows.starts.Append(rows.columns.Size());
  }
  transposed = rows.Transposed(width);
}

void Prolongation::Restrict(FlatArray<float> left, FlatVector<> coarse) const {
  ParallelFor(coarse.Size(), [&](size_t i) {
    double sum = 0;
    for (size_t j : transposed.Row(i))
      sum += transposed.values[j] * left[transposed.columns[j]];
    coarse(i) = sum;
  });
}

TwoLevel::TwoLevel(const Condensation & system, shared_ptr<StarSweeps> asweeps,
                   shared_ptr<BaseMatrix> acoarse, const SparseRows & rows, FlatArray<int> dofs)
    : SquareOperator(system), sweeps(asweeps), coarse(acoarse),
      prolongation(rows, dofs, asweeps->Order().slot, acoarse->VHeight()) {}

void TwoLevel::Correct(FlatArray<Node> b, FlatArray<Node> z) const {
  auto slots = prolongation.Slots();
  Array<float> left(slots.Size());
  ParallelFor(slots.Size(), [&](size_t i) {
    size_t node = slots[i] / width;
    if (i && size_t(slots[i - 1]) / width == node)
      return; // the first slot of a node does it for all
    Node product = sweeps->Rows().Times(node, z);
    for (size_t j = i; j < slots.Size() && size_t(slots[j]) / width == node; j++)
      left[j] = b[node][slots[j] % width] - product[slots[j] % width];
  });
  auto rhs = coarse->CreateColVector(), solution = coarse->CreateRowVector();
  prolongation.Restrict(left, rhs.FV<double>());
  coarse->Mult(rhs, solution);
  prolongation.Add(solution.FV<double>(),
                   [&](int slot, float value) { z[slot / width][slot % width] += value; });
  sweeps->SetMacroValues(z);
}

void TwoLevel::Mult(const BaseVector & x, BaseVector & y) const {
  static Timer timer("ngslac::TwoLevel");
  RegionTimer reg(timer);
  Array<Node> b(sweeps->Order().Size()), z(sweeps->NValues());
  sweeps->Gather(x.FV<double>(), b);
  ParallelFor(z.Size(), [&](size_t row) { z[row].fill(0); });
  sweeps->Sweep(b, z, false);
  Correct(b, z);
  sweeps->Sweep(b, z, true);
  sweeps->Scatter(z, y.FV<double>());
}

void TwoLevel::MultBulk(const BaseVector & x, BaseVector & y) const {
  static Timer timer("ngslac::TwoLevel - bulk");
  RegionTimer reg(timer);
  Array<Node> z(sweeps->Order().Size()), image(z.Size());
  sweeps->Gather(x.FV<double>(), z);
  ParallelFor(z.Size(), [&](size_t row) { image[row] = sweeps->Rows().TimesBulk(row, z); });
  sweeps->Scatter(image, y.FV<double>());
}

void TwoLevelProduct::Apply(const BaseVector & x, BaseVector & z, BaseVector & image) const {
  pre->Mult(x, z);
  system->Project(z.FV<double>());
  pre->MultBulk(z, image);
  system->ToImage(z.FV<double>(), image.FV<double>());
}
} // namespace ngslac
