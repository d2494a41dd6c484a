#pragma once
#include "given.hpp"

#include <regex>

namespace ngslac {
/// The boundaries that a pattern matches; `name`: of function and argument.
inline Region PatternRegion(shared_ptr<MeshAccess> mesh, const string & name,
                            const string & pattern) {
  try {
    return Region(mesh, BND, pattern);
  } catch (const std::regex_error & error) {
    throw py::value_error(name + " = '" + pattern + "' is no regular expression: " + error.what());
  }
}
} // namespace ngslac
