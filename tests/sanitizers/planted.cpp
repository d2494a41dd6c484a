/// Errors on purpose: the command is worth nothing if it does not find them.

#include <bla.hpp>
#include <memory>
#include <optional>
#include <pybind11/pybind11.h>

namespace {
volatile int three = 3; // unknown to the compiler

template <typename T>
auto Third(T && values) {
  return values[three];
}
} // namespace

PYBIND11_MODULE(planted, module) {
  module.def("past_the_end", [] { return Third(std::unique_ptr<int[]>(new int[3]{1, 2, 3})); });
  module.def("after_the_end", [] {
    int * value = new int(three);
    delete value;
    return *value;
  });
  module.def("past_the_stack", [] {
    volatile int values[3] = {1, 2, 3};
    return values[three];
  });
  module.def("overflow", [] { return 0x7fffffff - 2 + three; });
  module.def("shift", [] { return 1 << (29 + three); });
  module.def("standard_vector", [] { return Third(std::vector<int>(3)); });
  module.def("empty_optional", [] {
    std::optional<int> value;
    if (three == 4)
      value = 3;
    return *value;
  });
  module.def("netgen_array", [] { return Third(ngcore::Array<int>{1, 2, 3}); });
  module.def("netgen_vector", [] {
    double values[4] = {0, 1, 2, 3};
    return Third(ngbla::FlatVector<>(3, values));
  });
  module.def("netgen_matrix", [] {
    double values[6] = {};
    return ngbla::FlatMatrix<>(2, 3, values)(0, three);
  });
}
