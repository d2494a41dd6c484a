// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include "distance.hpp"
#include "leaves.hpp"

namespace ngslac {
constexpr const char * coordinates[] = {"coordinate x", "coordinate y", "coordinate z"};

/// Throws unless the function depends on coordinates of the space, and else on Parameters only.
inline void CheckLeaves(CoefficientFunction & function, int dim) {
  bool varies = false;
  function.TraverseTree([&](CoefficientFunction & node) {
    if (IsNumber(node) || (node.InputCoefficientFunctions().Size() && !IsByDomain(node)))
      return;
    string name = NameOf(node);
    auto known = std::find(coordinates, coordinates + dim, name);
    if (known == coordinates + dim)
      throw Exception("signed distance: it holds '" + name +
                      "', which has no value away from the mesh, or none in this dimension; "
                      "it may depend on coordinates of the space and on Parameters");
    varies = true;
  });
  if (!varies)
    throw Exception("signed distance: it does not depend on the coordinates x, y" +
                    string(dim == 3 ? ", z" : ""));
}

/// A function of the coordinates, with Parameters in it, as a signed distance.
template <int D>
class Expression final : public SignedDistance<D> {
  shared_ptr<CoefficientFunction> function;
  shared_ptr<CoefficientFunction> first,
      second; // value and gradient, upper triangle of the Hessian
  FE_ElementTransformation<D, D> reference;

public:
  /// Throws where it is no function of these coordinates, or has no derivatives.
  explicit Expression(shared_ptr<CoefficientFunction> afunction)
      : function(afunction), reference(D == 2 ? ET_TRIG : ET_TET) {
    CheckLeaves(*function, D);
    auto by = [](const shared_ptr<CoefficientFunction> & f, int k) {
      auto one = make_shared<ConstantCoefficientFunction>(1);
      return f->Diff(MakeCoordinateCoefficientFunction(k).get(), one);
    };
    Array<shared_ptr<CoefficientFunction>> values{function}, bends;
    for (int k : Range(D))
      values.Append(by(function, k));
    for (int k : Range(D))
      for (int l : Range(k, D))
        bends.Append(by(values[k + 1], l));
    first = Compile(MakeVectorialCoefficientFunction(std::move(values)));
    second = Compile(MakeVectorialCoefficientFunction(std::move(bends)));
  }

  Nearness<D> At(const Vec<D> & x) const override {
    Vec<D + 1> values;
    Evaluate(*first, x, values);
    if (!isfinite(values(0))) {
      string text;
      for (int k : Range(D))
        text += (k ? ", " : "") + ToString(x(k));
      throw Exception("signed distance: it is " + ToString(values(0)) + " at (" + text + ")");
    }
    Vec<D> gradient;
    for (int k : Range(D))
      gradient(k) = values(k + 1);
    return {values(0), isfinite(L2Norm2(gradient)) ? gradient : Vec<D>(0.0)};
  }

  Mat<D, D> Hessian(const Vec<D> & x) const override {
    Vec<D *(D + 1) / 2> values;
    Evaluate(*second, x, values);
    Mat<D, D> result;
    int next = 0;
    for (int k : Range(D))
      for (int l : Range(k, D))
        result(k, l) = result(l, k) = values(next++);
    return isfinite(L2Norm2(result)) ? result : Mat<D, D>(0.0);
  }

  void CollectFunctions(Array<shared_ptr<CoefficientFunction>> & all) const override {
    all.Append(function);
  }

private:
  void Evaluate(const CoefficientFunction & what, const Vec<D> & x, FlatVector<> values) const {
    IntegrationPoint ip;
    MappedIntegrationPoint<D, D> mip(ip, reference);
    mip.Point() = x; // of which the function sees nothing else
    what.Evaluate(mip, values);
  }
};
} // namespace ngslac
