// SPDX-License-Identifier: LGPL-2.1-or-later
#include "numpy.hpp"
#include "schur.hpp"

namespace ngslac {
using namespace ngcomp;

namespace {
SparseColumns Columns(const Numbers<size_t> & starts, const Numbers<int> & rows,
                      const Numbers<double> & values, int height) {
  SparseColumns columns{FromNumPy(starts), FromNumPy(rows), FromNumPy(values)};
  auto fits = [&](int row) { return row >= 0 && row < height; };
  if (!columns.starts.Size() || columns.starts[0] != 0 ||
      !std::is_sorted(columns.starts.begin(), columns.starts.end()) ||
      columns.starts.Last() != columns.rows.Size() ||
      columns.rows.Size() != columns.values.Size() ||
      !std::all_of(columns.rows.begin(), columns.rows.end(), fits))
    throw Exception("SchurComplement: starts, rows and values are no sparse columns");
  return columns;
}
} // namespace

void ExportSchur(py::module & m) {
  py::class_<SchurComplement, shared_ptr<SchurComplement>>(
      m, "SchurComplement",
      "C^T A^-1 C for sparse columns C, from a 'sparsecholesky' A = L D L^T.\n\n"
      "The columns are those of a scipy csc_matrix; throws where L^-1 C had more entries than L.")
      .def(py::init([](shared_ptr<BaseMatrix> inverse, Numbers<size_t> starts, Numbers<int> rows,
                       Numbers<double> values) {
             auto columns = Columns(starts, rows, values, inverse->VHeight());
             py::gil_scoped_release release;
             return make_shared<SchurComplement>(inverse, columns);
           }),
           py::arg("inverse").none(false), py::arg("starts"), py::arg("rows"), py::arg("values"))
      .def_property_readonly(
          "complement",
          [](const SchurComplement & self) {
            auto & c = self.Complement();
            return Numbers<double>(std::vector<size_t>{c.Height(), c.Width()}, c.Data());
          },
          "(m, m): C^T A^-1 C")
      .def(
          "Forward",
          [](const SchurComplement & self, Numbers<double> rhs) {
            return ToNumPy(self.Factors().Forward(View(rhs, self.Height())));
          },
          py::arg("rhs"), "y = L^-1 rhs, in the order of elimination.")
      .def(
          "Trace",
          [](const SchurComplement & self, Numbers<double> y) {
            return ToNumPy(self.Trace(View(y, self.Factors().Size())));
          },
          py::arg("y"), "C^T A^-1 rhs from y = L^-1 rhs.")
      .def(
          "Solve",
          [](const SchurComplement & self, Numbers<double> y, Numbers<double> x) {
            Vector<> left = View(y, self.Factors().Size());
            self.Subtract(View(x, self.Size()), left);
            return ToNumPy(self.Factors().Backward(left));
          },
          py::arg("y"), py::arg("x"), "A^-1 (rhs - C x) from y = L^-1 rhs.");
}
} // namespace ngslac
