// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <la.hpp>

namespace ngslac {
using namespace ngla;

/// Products with a matrix A after a preconditioner M.
class PreconditionedProduct {
public:
  virtual ~PreconditionedProduct() = default;
  virtual shared_ptr<BaseVector> MakeVector() const = 0;
  /// z = M^-1 x  and  image = A z.
  virtual void Apply(const BaseVector & x, BaseVector & z, BaseVector & image) const = 0;
  /// Sums up numbers over all processes that have parts of the vectors.
  virtual void Total(FlatVector<>) const {}
};

/// A product with any two operators; if `inverse` is null, M is the identity.
class OperatorProduct : public PreconditionedProduct {
public:
  OperatorProduct(shared_ptr<BaseMatrix> mat, shared_ptr<BaseMatrix> inverse)
      : mat(mat), inverse(inverse) {}
  shared_ptr<BaseVector> MakeVector() const override { return mat->CreateColVector(); }
  void Apply(const BaseVector & x, BaseVector & z, BaseVector & image) const override {
    if (inverse)
      inverse->Mult(x, z);
    else
      z = x;
    mat->Mult(z, image);
  }

private:
  shared_ptr<BaseMatrix> mat, inverse;
};

/// When GMRES ends.
struct GMResLimits {
  double tol;   // relative residual that is small enough
  int maxiter;  // products with the matrix
  int patience; // a stall is this many products that do not halve the residual; 0: no stall
};

struct GMResSolution {
  shared_ptr<BaseVector> x; // with the smallest residual
  Array<double> residuals;  // before the first product and after each
  bool converged;
};

/// GMRES from zero, without restart, for  A x = rhs  on the free dofs (Saad and Schultz 1986). The
/// preconditioner is on the right: the norm is that of the residual itself. If several processes
/// have parts of the vectors, all of them call it and take the same decisions.
///
/// The vectors  z = M^-1 q  are kept and combined (flexible GMRES, Saad 1993): M^-1 may have any
/// precision and may differ from call to call; its rounding errors do not enter the solution. If
/// the projection leaves less than half the length of a basis vector, it is repeated (Daniel,
/// Gragg, Kaufman and Stewart 1976). `look` is called before each product; an exception from it
/// ends the iteration.
GMResSolution GMRes(const PreconditionedProduct & product, const BaseVector & rhs,
                    const BitArray & free, const GMResLimits & limits,
                    const function<void()> & look);
} // namespace ngslac
