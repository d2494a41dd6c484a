/// Errors on purpose: the command is worth nothing if it does not find them.

#include <bla.hpp>
#include <memory>
#include <optional>
#include <pybind11/pybind11.h>

namespace {
volatile int three = 3; // unknown to the compiler

int PastTheEnd() {
  std::unique_ptr<int[]> values(new int[3]{1, 2, 3});
  return values[three];
}

int AfterTheEnd() {
  int *value = new int(three);
  delete value;
  return *value;
}

int PastTheStack() {
  volatile int values[3] = {1, 2, 3};
  return values[three];
}

int Overflow() { return 0x7fffffff - 2 + three; }

int Shift() { return 1 << (29 + three); }

int StandardVector() {
  std::vector<int> values(3);
  return values[three];
}

int EmptyOptional() {
  std::optional<int> value;
  if (three == 4)
    value = 3;
  return *value;
}

int NetgenArray() {
  ngcore::Array<int> values{1, 2, 3};
  return values[three];
}

double NetgenVector() {
  double values[4] = {0, 1, 2, 3};
  ngbla::FlatVector<> vector(3, values);
  return vector[three];
}

double NetgenMatrix() {
  double values[6] = {};
  ngbla::FlatMatrix<> matrix(2, 3, values);
  return matrix(0, three);
}
} // namespace

PYBIND11_MODULE(planted, module) {
  module.def("past_the_end", &PastTheEnd);
  module.def("after_the_end", &AfterTheEnd);
  module.def("past_the_stack", &PastTheStack);
  module.def("overflow", &Overflow);
  module.def("shift", &Shift);
  module.def("standard_vector", &StandardVector);
  module.def("empty_optional", &EmptyOptional);
  module.def("netgen_array", &NetgenArray);
  module.def("netgen_vector", &NetgenVector);
  module.def("netgen_matrix", &NetgenMatrix);
}
