// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <la.hpp>

namespace ngslac {
using namespace ngla;

/// The factors A = L D L^T of NGSolve's sparse Cholesky factorisation, one after the other.
///
/// Vectors of Forward and Backward are in the order of elimination, those of the matrix in its own.
class CholeskyFactors {
  shared_ptr<const SparseCholeskyTM<double>> factors;
  Array<int> blockof; // in the order of elimination

public:
  /// Throws unless `inverse` is such a factorisation of a real scalar matrix.
  explicit CholeskyFactors(shared_ptr<BaseMatrix> inverse);

  size_t Height() const { return factors->VHeight(); }
  size_t Size() const { return factors->GetNUsed(); } // eliminated dofs
  size_t NEntries() const { return factors->GetLFact().Size(); }
  size_t NBlocks() const { return factors->GetBlocks().Size() - 1; }
  /// Rows of L that share what is below them.
  IntRange Block(int nr) const { return factors->BlockDofs(nr); }
  FlatArray<int> Below(int nr) const { return factors->BlockExtDofs(nr); }
  int BlockOf(int i) const { return blockof[i]; }
  /// Place of a dof in the order of elimination, -1 where it has none.
  int Place(int dof) const { return factors->GetOrder()[dof]; }
  /// 1 / D
  FlatArray<double> InverseDiagonal() const { return factors->GetDiag(); }
  /// Entries of a column of L below the diagonal: the rest of its block, then what is below.
  FlatVector<> Column(int i) const {
    auto first = factors->GetFirstInRow();
    return {first[i + 1] - first[i], &factors->GetLFact()[first[i]]};
  }

  /// L^-1 of a vector of the matrix.
  Vector<> Forward(FlatVector<> rhs) const;
  /// L^-T D^-1 y as a vector of the matrix; y is used up.
  Vector<> Backward(FlatVector<> y) const;
};
} // namespace ngslac
