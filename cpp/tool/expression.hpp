// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include "distance.hpp"

namespace ngslac {
/// A function of the coordinates, with Parameters in it, as a signed distance.
template <int D>
class Expression final : public SignedDistance<D> {
  shared_ptr<CoefficientFunction> function;
  shared_ptr<CoefficientFunction> first,
      second; // value and gradient, upper triangle of the Hessian
  FE_ElementTransformation<D, D> reference;

public:
  /// Throws where it is no function of these coordinates, or has no derivatives.
  explicit Expression(shared_ptr<CoefficientFunction> afunction);
  Nearness<D> At(const Vec<D> & x) const override;
  Mat<D, D> Hessian(const Vec<D> & x) const override;
  void CollectFunctions(Array<shared_ptr<CoefficientFunction>> & all) const override {
    all.Append(function);
  }

private:
  void Evaluate(const CoefficientFunction & what, const Vec<D> & x, FlatVector<> values) const;
};
} // namespace ngslac
