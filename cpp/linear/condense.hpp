#pragma once
#include "localblock.hpp"
#include "squareoperator.hpp"

namespace ngslac {
class RowSum;

/// Columns and values.
struct SparseRow {
  Array<int> columns;
  Array<double> values;
};

/// Newton system on the displacements alone, without the multipliers of the macro-elements.
///
/// Of  K u + G lam = f,  E u + F lam = r  (F couples the multipliers of one macro-element only)
/// every macro-element solves those combinations of its rows that tell multipliers. The others are
/// constraints  E2 u = r2  with reactions along G2. Both act on d displacements of one node inside
/// the macro-element, its pivots, that no other macro-element touches: with right inverses B, Bl on
/// the pivots the oblique projections  P = 1 - B E2,  Pl = 1 - Bl G2^T  eliminate them exactly,
///   A = Pl^T K P + (projection on the pivots' eliminated directions),
/// symmetric and positive definite where K is and G2 = E2^T. A has the numbers of the dofs of the
/// given system; the rows of the multipliers stay empty. Only the rows of A that differ from those
/// of the given matrix are stored.
class Condensation : public SquareOperator {
public:
  /// `mat` is merged and scaled, `multipliers` lists d scalar dofs per macro-element. The symmetric
  /// variant takes slip for frictionless, and for sticking where that is stiffer: for
  /// preconditioners. Throws where a macro-element has no suitable pivots.
  Condensation(shared_ptr<SparseMatrix<double>> mat, FlatArray<int> multipliers, int d,
               const BitArray & free, bool symmetric);

  void MultAdd(double s, const BaseVector & x, BaseVector & y) const override;

  FlatArray<int> Columns(size_t row) const;
  FlatVector<> Values(size_t row) const;
  /// Rows and columns of some dofs, numbered anew; all of them with their own numbers without bits.
  shared_ptr<SparseMatrix<double>> Part(const BitArray * bits) const;

  const SparseMatrix<double> & Whole() const { return *mat; }
  /// Are forces and constraints of each macro-element the same combinations?
  bool HasSymmetricContact() const;
  /// the free displacements
  shared_ptr<BitArray> Free() const { return free; }
  /// eliminated directions of each macro-element
  Array<int> Constraints() const;
  /// Right hand side of A.
  void Reduce(FlatVector<> rhs, FlatVector<> reduced) const;
  /// Solution of the given system from that of A.
  void Expand(FlatVector<> rhs, FlatVector<> w, FlatVector<> x) const;

private:
  void Supports(FlatArray<int> multipliers, int d);
  Array<Array<SparseRow>> Carried() const;
  Array<int> ChangedRows() const;
  void SumRow(int row, FlatArray<Array<SparseRow>> carried, RowSum & sum) const;
  void AddRow(int row, double factor, RowSum & sum) const;
  void Project(RowSum & sum) const;
  Vector<> Forces(FlatVector<> u) const;
  Vector<> Left(FlatVector<> rhs, FlatVector<> u) const;
  Vector<> Particular(FlatVector<> rhs) const;

  shared_ptr<SparseMatrix<double>> mat;
  shared_ptr<BitArray> free;
  Array<bool> ismultiplier;
  Array<LocalBlock> blocks; // of the macro-elements
  Array<int> pivotblock;    // of each dof, or -1
  Table<int> touching;      // macro-elements of each dof
  Array<int> place;         // of each row that differs from that of the given matrix, or -1
  Array<SparseRow> rows;    // which differ
};
} // namespace ngslac
