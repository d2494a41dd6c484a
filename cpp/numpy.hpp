// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <python_comp.hpp>

namespace ngslac {
using namespace ngcomp;

/// Numbers passed by Python, contiguous in memory.
template <typename T>
using Numbers = py::array_t<T, py::array::c_style | py::array::forcecast>;

/// A copy.
template <typename T>
Numbers<T> ToNumPy(FlatArray<T> values) {
  return Numbers<T>(values.Size(), values.Data());
}
template <typename T>
Numbers<T> ToNumPy(const Array<T> & values) {
  return ToNumPy(FlatArray<T>(values));
}
inline Numbers<double> ToNumPy(FlatVector<> values) {
  return Numbers<double>(values.Size(), values.Data());
}

/// A copy.
template <typename T>
Array<T> FromNumPy(const Numbers<T> & values) {
  Array<T> copy(values.size());
  std::copy_n(values.data(), values.size(), copy.begin());
  return copy;
}

/// The memory of numbers, which have to be as many as `size`.
inline FlatVector<> View(const Numbers<double> & values, size_t size) {
  if (size_t(values.size()) != size)
    throw Exception("ngslac: a vector has " + ToString(values.size()) + " entries, not " +
                    ToString(size));
  return {size, const_cast<double *>(values.data())};
}
} // namespace ngslac
