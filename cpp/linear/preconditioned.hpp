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
} // namespace ngslac
