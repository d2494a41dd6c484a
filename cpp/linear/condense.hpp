// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include "explicitrows.hpp"
#include "localblock.hpp"
#include "squareoperator.hpp"

namespace ngslac {
/// Newton system on the displacements alone, without the multipliers of the macro-elements.
///
/// Of  K u + G lam = f,  E u + F lam = r  (F couples the multipliers of one macro-element only)
/// every macro-element solves those combinations of its rows that tell multipliers. The others are
/// constraints  E2 u = r2  with reactions along G2. With right inverses B of E2 and Bl of G2^T, the
/// lifts, the oblique projections  P = 1 - B E2,  Pl = 1 - Bl G2^T  eliminate them exactly: what is
/// left is  A = Pl^T (K - GL E1) P  on the free displacements. Derived classes choose the lifts,
/// and the sparse rows that stand for A in preconditioners, which have the numbers of the dofs of
/// the given system; those of the multipliers stay empty.
class Condensation : public SquareOperator {
public:
  /// The sparse rows.
  virtual shared_ptr<ExplicitRows> Rows() const = 0;

  const SparseMatrix<double> & Whole() const { return *mat; }
  /// Are forces and constraints of each macro-element the same combinations?
  bool HasSymmetricContact() const;
  /// Do macro-elements add something to its row?
  bool Changes(size_t row) const;
  /// the free displacements
  shared_ptr<BitArray> Free() const { return free; }
  /// eliminated directions of each macro-element
  Array<int> Constraints() const;
  /// Right hand side of A.
  void Reduce(FlatVector<> rhs, FlatVector<> reduced) const;
  /// Solution of the given system from that of A.
  void Expand(FlatVector<> rhs, FlatVector<> w, FlatVector<> x) const;
  /// z = P z
  void Project(FlatVector<> z) const;
  /// Makes  A z  of the image K w of  w = P z.
  void ToImage(FlatVector<> w, FlatVector<> image) const;

protected:
  /// `mat` is merged and scaled, `multipliers` lists d scalar dofs per macro-element.
  Condensation(shared_ptr<SparseMatrix<double>> mat, FlatArray<int> multipliers, int d,
               const BitArray & free);

  /// Of the blocks that are split: B (r) = lift inverse r,  Bl^T (f) = inverseleft carry f.
  struct Lifts {
    shared_ptr<SparseMatrix<double>> lift, carry;
    shared_ptr<SparseMatrix<double>> gram, gramleft; // which the inverses need
    shared_ptr<BaseMatrix> inverse, inverseleft;     // the identity where there is none
  };

  /// Numbers the constraints, and stacks what the macro-elements have to tell.
  void NumberConstraints();
  /// rows(m), k x dofs, of all macro-elements one below the other, on the free displacements.
  shared_ptr<SparseMatrix<double>> Stacked(const function<const Matrix<>(int)> & rows) const;
  void ClearFixed(FlatVector<> x) const;
  /// Adds a row of K.
  void AddBulkRow(int row, double factor, RowSum & sum) const;

  shared_ptr<SparseMatrix<double>> mat;
  shared_ptr<BitArray> free;
  int d; // multipliers of a macro-element
  Array<bool> ismultiplier;
  Array<LocalBlock> blocks;                             // of the macro-elements
  Array<int> first;                                     // constraint of each, and their count
  Table<int> touching;                                  // macro-elements of each dof
  shared_ptr<SparseMatrix<double>> constraints, forces; // E2, G2
  Lifts lifts;

private:
  IntRange ConstraintsOf(int m) const { return IntRange(first[m], first[m + 1]); }
  /// The rows that tell multipliers.
  IntRange ToldOf(int m) const { return IntRange(d * m - first[m], d * (m + 1) - first[m + 1]); }
  void Supports(FlatArray<int> multipliers);
  void FindNear();
  /// u += s B r
  void AddLift(double s, FlatVector<> r, FlatVector<> u) const;
  /// Bl^T f: what the constraints have to carry.
  Vector<> Reactions(FlatVector<> f) const;
  Vector<> Left(FlatVector<> rhs, FlatVector<> u) const;
  Vector<> Particular(FlatVector<> rhs) const;

  shared_ptr<SparseMatrix<double>> slips, pushes; // E1 of what slides, GL
  Array<int> near; // displacements on which constraints act, and those coupled to them
};

/// The transposed matrix.
shared_ptr<SparseMatrix<double>> Transposed(const SparseMatrix<double> & mat);
} // namespace ngslac
