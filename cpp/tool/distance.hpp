// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <fem.hpp>

namespace ngslac {
using namespace ngfem;

/// How far a point is from a tool, > 0 outside, and the derivative of that by the point.
///
/// Where the nearest point is not unique or not known, the gradient is 0.
template <int D>
struct Nearness {
  double distance;
  Vec<D> gradient;
};

/// The shape of a tool, in any dimension.
class ToolShape {
public:
  virtual ~ToolShape() = default;
  virtual int Dim() const = 0;
  /// Appends the functions that it depends on, which may hold Parameters.
  virtual void CollectFunctions(Array<shared_ptr<CoefficientFunction>> & /* all */) const {}
};

/// The signed distance from a tool.
template <int D>
class SignedDistance : public ToolShape {
public:
  int Dim() const override { return D; }
  virtual Nearness<D> At(const Vec<D> & x) const = 0;
  /// Second derivatives, 0 where there are none.
  virtual Mat<D, D> Hessian(const Vec<D> & x) const = 0;
};

template <int D>
using SomeTool = shared_ptr<SignedDistance<D>>;
} // namespace ngslac
