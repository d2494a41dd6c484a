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

/// Of any two operators; without an inverse M is the identity.
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
  int patience; // so many that do not halve the residual together are a stall; 0: there is none
};

struct GMResSolution {
  shared_ptr<BaseVector> x; // with the smallest residual
  Array<double> residuals;  // before the first product and after each
  bool converged;
};

/// GMRES without restart from zero for  A x = rhs  on the free dofs, preconditioned from the right:
/// the norm is that of the residual itself. Where processes have parts of the vectors all of them
/// call it, and take the same decisions.
///
/// The vectors  z = M^-1 q  are kept and combined (flexible GMRES, Saad 1993): M^-1 may be in any
/// precision and not even the same each time, its rounding errors are none of the solution. A basis
/// vector that the projection left with less than half its length is projected twice (Daniel,
/// Gragg, Kaufman and Stewart 1976). `look` is called before each product; what it throws ends the
/// iteration. Saad and Schultz 1986.
GMResSolution GMRes(const PreconditionedProduct & product, const BaseVector & rhs,
                    const BitArray & free, const GMResLimits & limits,
                    const function<void()> & look);
} // namespace ngslac
