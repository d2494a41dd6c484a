// SPDX-License-Identifier: LGPL-2.1-or-later
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

/// Has every domain a function of its own? Away from the mesh there are no domains.
inline bool IsByDomain(const CoefficientFunction & part) {
  return string(typeid(part).name()).find("DomainWise") != string::npos;
}

/// The name under which users may know a part of an expression.
inline string NameOf(const CoefficientFunction & part) {
  string name = part.GetDescription(), type = typeid(part).name();
  if (name != type)
    return name;
  return IsByDomain(part) ? "a function of each domain" : Demangle(type.c_str());
}
} // namespace ngslac
