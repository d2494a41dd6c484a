// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <la.hpp>

namespace ngslac {
using namespace ngla;

/// Products with a matrix A after a preconditioner M.
class PreconditionedProduct {
public:
  virtual ~PreconditionedProduct() = default;
  /// Makes vectors.
  virtual const BaseMatrix & Matrix() const = 0;
  /// z = M^-1 x  and  image = A z.
  virtual void Apply(const BaseVector & x, BaseVector & z, BaseVector & image) const = 0;
};

/// Of any two operators; without an inverse M is the identity.
class OperatorProduct : public PreconditionedProduct {
public:
  OperatorProduct(shared_ptr<BaseMatrix> mat, shared_ptr<BaseMatrix> inverse)
      : mat(mat), inverse(inverse) {}
  const BaseMatrix & Matrix() const override { return *mat; }
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
} // namespace ngslac
