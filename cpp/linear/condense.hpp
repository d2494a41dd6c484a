#pragma once
#include "localblock.hpp"
#include "sparserow.hpp"
#include "squareoperator.hpp"

namespace ngslac {
/// Newton system on the displacements alone, without the multipliers of the macro-elements.
///
/// Of  K u + G lam = f,  E u + F lam = r  (F couples the multipliers of one macro-element only)
/// every macro-element solves those combinations of its rows that tell multipliers. The others are
/// constraints  E2 u = r2  with reactions along G2. With right inverses B of E2 and Bl of G2^T, the
/// lifts, the oblique projections  P = 1 - B E2,  Pl = 1 - Bl G2^T  eliminate them exactly: what is
/// left is  A = Pl^T K P  on the displacements. Derived classes choose the lifts, and the sparse
/// rows that stand for A in preconditioners. They have the numbers of the dofs of the given system;
/// those of the multipliers stay empty. Only rows that differ from those of the given matrix are
/// stored.
class Condensation : public SquareOperator {
public:
  FlatArray<int> Columns(size_t row) const;
  FlatVector<> Values(size_t row) const;
  /// Rows and columns of some dofs, numbered anew; all of them with their own numbers without bits.
  shared_ptr<SparseMatrix<double>> Part(const BitArray * bits) const;

  const SparseMatrix<double> & Whole() const { return *mat; }
  /// Are forces and constraints of each macro-element the same combinations?
  bool HasSymmetricContact() const;
  /// Does its row differ from that of the given matrix?
  bool Changes(size_t row) const { return place[row] >= 0; }
  /// Of the sparse rows.
  Array<double> Diagonal() const;
  /// the free displacements
  shared_ptr<BitArray> Free() const { return free; }
  /// eliminated directions of each macro-element
  Array<int> Constraints() const;
  /// Right hand side of A.
  void Reduce(FlatVector<> rhs, FlatVector<> reduced) const;
  /// Solution of the given system from that of A.
  void Expand(FlatVector<> rhs, FlatVector<> w, FlatVector<> x) const;
  /// Makes  A z  of `image`, the product of the sparse rows with z.
  virtual void ToImage(FlatVector<> z, FlatVector<> image) const = 0;

protected:
  /// `mat` is merged and scaled, `multipliers` lists d scalar dofs per macro-element.
  Condensation(shared_ptr<SparseMatrix<double>> mat, FlatArray<int> multipliers, int d,
               const BitArray & free);

  /// Number of the constraints of each macro-element's first one, whose last entry is their count;
  /// and the rows near them.
  void NumberConstraints();
  IntRange ConstraintsOf(int m) const { return IntRange(first[m], first[m + 1]); }
  /// Adds a row of  K - sum GL E1.
  void AddRow(int row, double factor, RowSum & sum) const;
  /// Takes the rows from  sum_row(row, sum)  for those that differ.
  void StoreRows(FlatArray<int> changed, const function<void(int, RowSum &)> & sum_row);
  /// y += s (sparse rows) x
  void AddProduct(double s, FlatVector<> x, FlatVector<> y) const;

  /// u += s B r
  virtual void AddLift(double s, FlatVector<> r, FlatVector<> u) const = 0;
  /// Bl^T forces: what the constraints have to carry.
  virtual Vector<> Reactions(FlatVector<> forces) const = 0;
  /// E2 u
  Vector<> Jumps(FlatVector<> u) const;
  /// forces -= G2 reactions
  void SubtractReactions(FlatVector<> reactions, FlatVector<> forces) const;

  shared_ptr<SparseMatrix<double>> mat;
  shared_ptr<BitArray> free;
  Array<bool> ismultiplier;
  Array<LocalBlock> blocks; // of the macro-elements
  Array<int> first;         // constraint of each
  Table<int> touching;      // macro-elements of each dof
  Array<int> near;          // displacements on which constraints act, and those coupled to them

private:
  void Supports(FlatArray<int> multipliers, int d);
  void FindNear();
  Vector<> Left(FlatVector<> rhs, FlatVector<> u) const;
  Vector<> Particular(FlatVector<> rhs) const;

  Array<int> place;      // of each row that differs from that of the given matrix, or -1
  Array<SparseRow> rows; // which differ
};
} // namespace ngslac
