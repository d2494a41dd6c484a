// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <python_comp.hpp>

namespace ngslac {
using namespace ngcomp;

/// An argument as the caller passed it. Signatures show it as T; for any other type the error names
/// the argument, its value and the wanted type, where pybind11 would list signatures.
template <typename T>
struct __attribute__((visibility("hidden"))) Argument { // as pybind11, whose object it holds
  py::object value;

  bool IsNone() const { return value.is_none(); }
  /// `name`: of function and argument; `wanted`: what the value has to be
  T As(const string & name, const string & wanted) const {
    py::detail::make_caster<T> caster;
    // Objects that merely convert to bool are no flags, a flag is no number, and bytes are no text.
    constexpr bool isflag = std::is_same_v<T, bool>;
    bool odd = PyBytes_Check(value.ptr()) || (!isflag && PyBool_Check(value.ptr()));
    if (IsNone() || odd || !caster.load(value, !isflag))
      throw py::type_error(name + " = " + Text(value) + " must be " + wanted);
    return py::detail::cast_op<T>(std::move(caster));
  }

  /// The value for a message, cut where it is long.
  static string Text(py::handle value) {
    constexpr size_t most = 80;
    string text;
    try {
      text = py::repr(value).cast<string>();
    } catch (const py::error_already_set &) { // of an object whose repr fails
      text = "<" + py::type::handle_of(value).attr("__name__").cast<string>() + ">";
    }
    return text.size() <= most ? text : text.substr(0, most) + "...";
  }
};

/// Throws if an argument is left over: the function has none of that name.
inline void CheckNoMore(const string & name, const py::args & positional, const py::kwargs & named,
                        const string & all) {
  if (positional.size())
    throw py::type_error(name + ": " + Argument<int>::Text(positional[0]) +
                         " was given without a name; the arguments are " + all);
  for (auto [key, value] : named)
    throw py::type_error(name + ": there is no argument " + Argument<int>::Text(key) +
                         "; the arguments are " + all);
}
} // namespace ngslac

namespace pybind11::detail {
template <typename T>
struct type_caster<ngslac::Argument<T>> {
  PYBIND11_TYPE_CASTER(ngslac::Argument<T>, make_caster<T>::name);
  bool load(handle source, bool) {
    value.value = reinterpret_borrow<object>(source);
    return true;
  }
  static handle cast(const ngslac::Argument<T> & argument, return_value_policy, handle) {
    return argument.value.inc_ref();
  }
};
} // namespace pybind11::detail
