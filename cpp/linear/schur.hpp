// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include "cholesky.hpp"

namespace ngslac {
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
