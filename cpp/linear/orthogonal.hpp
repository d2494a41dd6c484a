#pragma once
#include "condense.hpp"

namespace ngslac {
/// Orthogonal lifts, for preconditioned iterations:  B = E2^T (E2 E2^T)^-1, Bl = G2 (G2^T G2)^-1 on
/// the free displacements.
///
/// In the scaled system, whose diagonal is 1, these are the lifts of least energy in the diagonal
/// of K. They go to the softer side by themselves, so that the condition does not depend on the
/// ratio of the stiffnesses. No inner displacement is needed.
///
/// The sparse rows are  K + G2 S E2  with a penalty S as stiff as the diagonal of K. On the kernel
/// of E2 this is K, and since E2 is bounded from both sides in these norms, a preconditioner for it
/// is one for A: a Gauss-Seidel sweep does not notice the penalty, and it couples fewer dofs than
/// P.
class OrthogonalCondensation : public Condensation {
public:
  /// Throws where the constraints depend on each other.
  OrthogonalCondensation(shared_ptr<SparseMatrix<double>> mat, FlatArray<int> multipliers, int d,
                         const BitArray & free);

  void MultAdd(double s, const BaseVector & x, BaseVector & y) const override;
  void ToImage(FlatVector<> z, FlatVector<> image) const override;

private:
  void AddLift(double s, FlatVector<> r, FlatVector<> u) const override;
  Vector<> Reactions(FlatVector<> forces) const override;
  Array<int> FreeDofs(int m) const;
  void FillLocal(int m);
  void FillRows();
  void SumRow(int row, RowSum & sum) const;

  Array<Matrix<>> E, Gt, penalised; // on the free dofs: E2, G2^T; S E2 of each macro-element
  shared_ptr<SparseMatrix<double>> gram, gramleft; // E2 E2^T, G2^T G2
  shared_ptr<BaseMatrix> inverse, inverseleft;     // theirs
};
} // namespace ngslac
