// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include "indexmap.hpp"
#include <la.hpp>

namespace ngslac {
using namespace ngla;

/// A real square matrix that is known by its products; derived classes define one of Mult, MultAdd.
class SquareOperator : public BaseMatrix {
public:
  /// With vectors of the same kind as another one.
  explicit SquareOperator(const BaseMatrix & other)
      : size(other.VHeight()), format(other.RowFormat()) {}

  bool IsComplex() const override { return false; }
  int VHeight() const override { return size; }
  int VWidth() const override { return size; }
  VecFormat RowFormat() const override { return format; }
  VecFormat ColFormat() const override { return format; }

private:
  int size;
  VecFormat format;
};

/// What one macro-element contributes to a Newton system, split into multipliers that its rows
/// determine and constraints; see Condensation.
struct LocalBlock {
  Array<int> dofs;        // displacements, sorted
  Array<int> multipliers; // d
  Matrix<> E2, G2;        // constraints x dofs, dofs x constraints
  Matrix<> U1, U2;        // rows that determine multipliers, rows that are constraints
  Matrix<> V2;            // multipliers that the constraints leave free
  Matrix<> solved;        // V1 (U1^T F V1)^-1
  Matrix<> E1, GL;        // U1^T E and G solved: the local term of K is  - GL E1
  bool slides = false;    // E1 is not zero

  int NConstraints() const { return E2.Height(); }
};

/// Entries of a vector.
inline Vector<> Gather(FlatArray<int> dofs, FlatVector<> x) {
  Vector<> values(dofs.Size());
  for (int i : Range(dofs))
    values(i) = x(dofs[i]);
  return values;
}

/// Splits a block, whose dofs and multipliers are set; `lifts` are the positions that may carry the
/// constraints.
void SplitBlock(LocalBlock & block, const SparseMatrix<double> & mat, FlatArray<int> lifts);

/// What a macro-element adds to the rows of its dofs:  left right.
struct LocalTerm {
  FlatArray<int> dofs;
  Matrix<> left, right; // dofs x k, k x dofs

  /// Position of a dof that is among the dofs.
  int Position(int dof) const {
    return std::lower_bound(dofs.begin(), dofs.end(), dof) - dofs.begin();
  }
};

/// Newton system on the displacements alone, without the multipliers of the macro-elements.
///
/// Of  K u + G lam = f,  E u + F lam = r  (F couples the multipliers of one macro-element only)
/// every macro-element solves those combinations of its rows that determine multipliers. The others
/// are constraints  E2 u = r2  with reactions along G2. The lifts  B = E2^T (E2 E2^T)^-1  and
/// Bl = G2 (G2^T G2)^-1  on the free displacements give projections  P = 1 - B E2,
/// Pl = 1 - Bl G2^T,  which eliminate them exactly: what is left is  A = Pl^T (K - GL E1) P  on the
/// free displacements.
///
/// In the scaled system, whose diagonal is 1, these are the lifts of least energy in the diagonal
/// of K. They go to the softer side by themselves, so that the condition does not depend on the
/// ratio of the stiffnesses.
///
/// For preconditioners  K + T,  T = - GL E1 + G2 S E2  with a penalty S as stiff as the diagonal of
/// K, stands for A. On the kernel of E2 this is A, and since E2 is bounded from both sides in these
/// norms, a preconditioner for it is one for A: a Gauss-Seidel sweep does not notice the penalty,
/// and it couples fewer dofs than P. T is kept as local terms of at most d columns: summed up to
/// rows they would be most of the matrix where everything is near to a contact. Rows have the
/// numbers of the dofs of the given system; those of the multipliers stay empty.
///
/// But for products and rows, nothing depends on K: `mat` may hold the rows and columns of the
/// multipliers alone where others know the products with K.
class Condensation : public SquareOperator {
public:
  /// `mat` is merged and scaled, `multipliers` lists d scalar dofs per macro-element. Throws where
  /// the constraints depend on each other.
  Condensation(shared_ptr<SparseMatrix<double>> mat, FlatArray<int> multipliers, int d,
               const BitArray & free);

  /// y += s A x
  void MultAdd(double s, const BaseVector & x, BaseVector & y) const override;
  /// Rows and columns of K + T of some dofs in this order; those of -1 are of the identity. Rows
  /// that are not wanted are empty.
  shared_ptr<SparseMatrix<double>> Part(FlatArray<int> dofs,
                                        const BitArray * wanted = nullptr) const;
  /// Of K + T.
  Array<double> Diagonal() const;
  /// Of each macro-element; without columns where it adds nothing.
  FlatArray<LocalTerm> Terms() const { return terms; }
  const SparseMatrix<double> & Whole() const { return *mat; }
  /// Are forces and constraints of each macro-element the same combinations?
  bool HasSymmetricContact() const;
  /// Do macro-elements add something to its row?
  bool Changes(size_t row) const;
  /// the free displacements
  shared_ptr<BitArray> Free() const { return free; }
  /// eliminated directions of each macro-element
  Array<int> Constraints() const;

  /// z = P z
  void Project(FlatVector<> z) const;
  /// f = Pl^T f  on the free displacements
  void Test(FlatVector<> f) const;
  /// Makes  A z  of the image K w of  w = P z.
  void ToImage(FlatVector<> w, FlatVector<> image) const;
  /// The displacements of a solution from that of A; without it, those that fulfil the constraints.
  Vector<> Displacements(FlatVector<> rhs, FlatVector<> w) const;
  /// K u, at the dofs that macro-elements touch and their neighbours; the others are 0.
  Vector<> NearImage(FlatVector<> u) const;
  /// Right hand side of A, with the image K u of the u that fulfil the constraints.
  Vector<> Reduce(FlatVector<> rhs, FlatVector<> u, FlatVector<> image) const;
  /// Adds the multipliers to the displacements of a solution, with their image K x.
  void Complete(FlatVector<> rhs, FlatVector<> image, FlatVector<> x) const;

private:
  void Supports(FlatArray<int> multipliers);
  Array<int> FreeDofs(int m) const;
  void FillTerm(int m);
  /// Numbers the constraints, and stacks the rows of the macro-elements.
  void NumberConstraints();
  void FillLifts();
  /// rows(m), k x dofs, of all macro-elements one below the other, on the free displacements.
  shared_ptr<SparseMatrix<double>> Stacked(const function<const Matrix<>(int)> & rows) const;
  void SumRow(int row, RowSum & sum) const;
  IntRange ConstraintsOf(int m) const { return IntRange(first[m], first[m + 1]); }
  /// The rows that determine multipliers.
  IntRange SolvedOf(int m) const { return IntRange(d * m - first[m], d * (m + 1) - first[m + 1]); }
  void ClearFixed(FlatVector<> x) const;
  /// u += s B r
  void AddLift(double s, FlatVector<> r, FlatVector<> u) const;
  /// Bl^T f: the forces that the constraints carry.
  Vector<> Reactions(FlatVector<> f) const;
  /// f - G (multipliers that r determines) - K u
  Vector<> Left(FlatVector<> rhs, FlatVector<> u, FlatVector<> image) const;

  shared_ptr<SparseMatrix<double>> mat;
  shared_ptr<BitArray> free;
  int d; // multipliers of a macro-element
  Array<bool> ismultiplier;
  Array<LocalBlock> blocks; // of the macro-elements
  Array<LocalTerm> terms;
  Array<int> first;                                     // constraint of each, and their count
  Table<int> touching;                                  // macro-elements of each dof
  shared_ptr<SparseMatrix<double>> constraints, forces; // E2, G2
  shared_ptr<SparseMatrix<double>> slips, pushes;       // E1 of what slides, GL
  shared_ptr<SparseMatrix<double>> lift, carry;         // E2^T, G2^T
  shared_ptr<SparseMatrix<double>> gram, gramleft;      // E2 E2^T, G2^T G2
  shared_ptr<BaseMatrix> inverse, inverseleft;          // of these
};
} // namespace ngslac
