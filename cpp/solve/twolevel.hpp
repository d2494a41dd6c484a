#pragma once
#include <la.hpp>

namespace ngslac {
using namespace ngla;

/// Preconditioner: a Gauss-Seidel sweep forward, a correction, and a sweep backward.
///
/// Symmetric where the matrix and the correction are. The first sweep starts from zero, so that
/// each sweep reads one triangle of the matrix, and the other one is a product in parallel. What
/// counts is memory traffic: the triangles are copied in single precision.
class TwoLevel : public BaseMatrix {
public:
  /// `coarse` is the correction: an approximate inverse on some of the free dofs.
  TwoLevel(shared_ptr<SparseMatrix<double>> mat, shared_ptr<BitArray> free,
           shared_ptr<BaseMatrix> coarse);

  bool IsComplex() const override { return false; }
  int VHeight() const override { return mat->Height(); }
  int VWidth() const override { return mat->Width(); }
  VecFormat RowFormat() const override { return mat->RowFormat(); }
  VecFormat ColFormat() const override { return mat->ColFormat(); }
  void Mult(const BaseVector & x, BaseVector & y) const override;
  void MultAdd(double s, const BaseVector & x, BaseVector & y) const override;

private:
  /// Entries on one side of the diagonal, between free dofs.
  struct Triangle {
    Array<size_t> first;
    Array<int> columns;
    Array<float> values;

    template <typename F>
    void Set(const SparseMatrix<double> & mat, F keep);
    double Times(size_t row, const double * y) const;
  };

  shared_ptr<SparseMatrix<double>> mat;
  shared_ptr<BaseMatrix> coarse;
  Array<double> inverse_diagonal; // 0 where a dof is not free
  Triangle lower, upper;
};
} // namespace ngslac
