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

/// A sparse matrix by columns: those of column j are [starts[j], starts[j+1]).
struct SparseColumns {
  Array<size_t> starts;
  Array<int> rows;
  Array<double> values;
  size_t Size() const { return starts.Size() - 1; }
};

/// C^T A^-1 C for sparse columns C, from the factors A = L D L^T.
///
/// Y = L^-1 C has entries where the elimination tree leads from those of C to its root only: a few
/// per column and level in 2D. They are computed block by block of L, all columns at once.
class SchurComplement {
  /// Rows of Y in a block of L, and the columns that may have entries there.
  struct Part {
    int block;
    Array<int> columns; // sorted
    Matrix<> values;
  };
  CholeskyFactors factors;
  size_t size;
  Array<Part> parts;   // in the order of elimination
  Array<int> partof;   // of the blocks, or -1
  Matrix<> complement; // (size, size)

public:
  /// Throws where Y or the product had more entries than L, and more than a few.
  SchurComplement(shared_ptr<BaseMatrix> cholesky, const SparseColumns & columns);

  size_t Height() const { return factors.Height(); }
  size_t Size() const { return size; }
  const Matrix<> & Complement() const { return complement; }
  const CholeskyFactors & Factors() const { return factors; }
  /// C^T A^-1 f from y = L^-1 f
  Vector<> Trace(FlatVector<> y) const;
  /// y -= L^-1 C x
  void Subtract(FlatVector<> x, FlatVector<> y) const;

private:
  void FindParts(const SparseColumns & columns);
  void CheckSize(size_t entries) const;
  void Fill(const SparseColumns & columns);
  void Eliminate(Part & part);
  void AddSquare(const Part & part);
  void PassOn(const Part & part);
};
} // namespace ngslac
