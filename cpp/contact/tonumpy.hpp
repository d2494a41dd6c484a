#pragma once
#include <python_comp.hpp>

namespace ngslac {
using namespace ngcomp;

/// A copy.
template <typename T>
py::array_t<T> ToNumPy(const Array<T> & values) {
  return py::array_t<T>(values.Size(), values.Data());
}
} // namespace ngslac
