// SPDX-License-Identifier: LGPL-2.1-or-later
#include "schur.hpp"
#include "addscaled.hpp"
#include "blocksum.hpp"
#include <triangular.hpp>

namespace ngslac {
CholeskyFactors::CholeskyFactors(shared_ptr<BaseMatrix> inverse)
    : factors(dynamic_pointer_cast<const SparseCholeskyTM<double>>(inverse)) {
  if (!factors)
    throw Exception("SchurComplement: the inverse must be a real scalar 'sparsecholesky'");
  blockof.SetSize(Size());
  for (int nr : Range(NBlocks()))
    blockof[Block(nr)] = nr;
}

Vector<> CholeskyFactors::Forward(FlatVector<> rhs) const {
  Vector<> y(Size());
  for (int i : Range(y))
    y(i) = rhs(factors->GetInvOrder()[i]);
  Array<double> local;
  for (int nr : Range(NBlocks())) {
    auto block = Block(nr);
    auto below = Below(nr);
    int size = block.Size(), all = size + below.Size();
    local.SetSize(all);
    local = 0.0;
    for (int i : Range(size))
      local[i] = y(block.First() + i);
    for (int i : Range(size))
      AddScaled(-local[i], Column(block.First() + i).Data(), &local[i] + 1, all - i - 1);
    for (int i : Range(size))
      y(block.First() + i) = local[i];
    for (int i : Range(below))
      y(below[i]) += local[size + i];
  }
  return y;
}

Vector<> CholeskyFactors::Backward(FlatVector<> y) const {
  for (int i : Range(y))
    y(i) *= InverseDiagonal()[i];
  Array<double> local;
  for (int nr = int(NBlocks()) - 1; nr >= 0; nr--) {
    auto block = Block(nr);
    auto below = Below(nr);
    int size = block.Size(), all = size + below.Size();
    local.SetSize(all);
    for (int i : Range(size))
      local[i] = y(block.First() + i);
    for (int i : Range(below))
      local[size + i] = y(below[i]);
    for (int i = size - 1; i >= 0; i--) {
      auto column = Column(block.First() + i);
      local[i] -= InnerProduct(column, FlatVector<>(column.Size(), &local[i] + 1));
      y(block.First() + i) = local[i];
    }
  }
  Vector<> x(Height());
  x = 0.0;
  for (int i : Range(y))
    x(factors->GetInvOrder()[i]) = y(i);
  return x;
}

constexpr size_t few = 1'000'000;

SchurComplement::SchurComplement(shared_ptr<BaseMatrix> cholesky, const SparseColumns & columns)
    : factors(cholesky), size(columns.Size()) {
  static Timer timer("ngslac::SchurComplement");
  RegionTimer reg(timer);
  CheckSize(size * size);
  FindParts(columns);
  Fill(columns);
  complement.SetSize(size, size);
  complement = 0.0;
  for (auto & part : parts) {
    Eliminate(part);
    AddSquare(part);
    PassOn(part);
  }
}

void SchurComplement::CheckSize(size_t entries) const {
  if (entries > max(factors.NEntries(), few))
    throw Exception("SchurComplement: the interface is too large");
}

void SchurComplement::FindParts(const SparseColumns & columns) {
  Array<Array<int>> found(factors.NBlocks());
  for (int j : Range(size))
    for (auto k : Range(columns.starts[j], columns.starts[j + 1])) {
      int place = factors.Place(columns.rows[k]);
      if (place < 0)
        throw Exception("SchurComplement: a column has an entry where nothing is free");
      found[factors.BlockOf(place)].Append(j);
    }
  partof.SetSize(found.Size());
  partof = -1;
  size_t entries = 0;
  for (int nr : Range(found)) {
    auto & own = found[nr];
    if (!own.Size())
      continue;
    SortUnique(own);
    entries += own.Size() * factors.Block(nr).Size();
    CheckSize(entries);
    int last = -1;
    for (int i : factors.Below(nr))
      if (int next = factors.BlockOf(i); next != last) {
        found[next] += own;
        last = next;
      }
    partof[nr] = parts.Size();
    parts.Append(Part{nr, std::move(own), {}});
  }
}

void SchurComplement::Fill(const SparseColumns & columns) {
  for (auto & part : parts) {
    part.values.SetSize(factors.Block(part.block).Size(), part.columns.Size());
    part.values = 0.0;
  }
  for (int j : Range(size))
    for (auto k : Range(columns.starts[j], columns.starts[j + 1])) {
      int place = factors.Place(columns.rows[k]), block = factors.BlockOf(place);
      auto & part = parts[partof[block]];
      auto at = std::lower_bound(part.columns.begin(), part.columns.end(), j);
      part.values(place - factors.Block(block).First(), at - part.columns.begin()) +=
          columns.values[k];
    }
}

void SchurComplement::Eliminate(Part & part) {
  auto block = factors.Block(part.block);
  int n = block.Size();
  Matrix<> lower(n, n);
  for (int i : Range(n))
    lower.Col(i).Range(i + 1, n) = factors.Column(block.First() + i).Range(0, n - i - 1);
  TriangularSolve<LowerLeft, Normalized>(lower, part.values);
}

void SchurComplement::AddSquare(const Part & part) {
  auto block = factors.Block(part.block);
  auto & y = part.values;
  Matrix<> divided = y;
  for (int i : Range(block.Size()))
    divided.Row(i) *= factors.InverseDiagonal()[block.First() + i];
  Matrix<> square = Trans(y) * divided;
  for (int k : Range(part.columns))
    for (int l : Range(part.columns))
      complement(part.columns[k], part.columns[l]) += square(k, l);
}

void SchurComplement::PassOn(const Part & part) {
  auto block = factors.Block(part.block);
  auto below = factors.Below(part.block);
  int n = block.Size();
  Matrix<> lower(below.Size(), n);
  for (int i : Range(n))
    lower.Col(i) = factors.Column(block.First() + i).Range(n - i - 1, n - i - 1 + below.Size());
  Matrix<> passed = lower * part.values;
  Array<int> place(part.columns.Size());
  for (int r = 0, last = -1; r < below.Size(); r++) {
    int next = factors.BlockOf(below[r]);
    auto & target = parts[partof[next]];
    if (next != last) {
      auto at = target.columns.begin();
      for (int k : Range(place)) {
        at = std::lower_bound(at, target.columns.end(), part.columns[k]);
        place[k] = at - target.columns.begin();
      }
      last = next;
    }
    auto row = target.values.Row(below[r] - factors.Block(next).First());
    for (int k : Range(place))
      row(place[k]) -= passed(r, k);
  }
}

Vector<> SchurComplement::Trace(FlatVector<> y) const {
  Vector<> trace(size);
  trace = 0.0;
  for (auto & part : parts)
    for (int i : Range(part.values.Height())) {
      int row = factors.Block(part.block).First() + i;
      double factor = factors.InverseDiagonal()[row] * y(row);
      for (int k : Range(part.columns))
        trace(part.columns[k]) += factor * part.values(i, k);
    }
  return trace;
}

void SchurComplement::Subtract(FlatVector<> x, FlatVector<> y) const {
  Vector<> local(size);
  for (auto & part : parts) {
    auto own = local.Range(0, part.columns.Size());
    for (int k : Range(part.columns))
      own(k) = x(part.columns[k]);
    for (int i : Range(part.values.Height()))
      y(factors.Block(part.block).First() + i) -= InnerProduct(part.values.Row(i), own);
  }
}
} // namespace ngslac
