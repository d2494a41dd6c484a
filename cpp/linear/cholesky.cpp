// SPDX-License-Identifier: LGPL-2.1-or-later
#include "cholesky.hpp"
#include "addscaled.hpp"

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
} // namespace ngslac
