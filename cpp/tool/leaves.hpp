#pragma once
#include <fem.hpp>

namespace ngslac {
using namespace ngfem;

/// Is that end of an expression a number, or a Parameter?
inline bool IsNumber(const CoefficientFunction & leaf) {
  return dynamic_cast<const ParameterCoefficientFunction<double> *>(&leaf) ||
         dynamic_cast<const ConstantCoefficientFunction *>(&leaf) ||
         leaf.GetDescription() == "ZeroCF";
}
} // namespace ngslac
