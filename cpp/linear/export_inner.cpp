// SPDX-License-Identifier: LGPL-2.1-or-later
#include "inner.hpp"
#include "numpy.hpp"

namespace ngslac {
static size_t Size(const InnerElimination & self) {
  return self.Left()->VHeight();
}

void ExportInner(py::module & m) {
  py::class_<InnerElimination, shared_ptr<InnerElimination>>(
      m, "InnerElimination",
      "Exact elimination of `inner` dofs, which are coupled within elements only, from a real\n"
      "sparse matrix. Throws where they cannot be eliminated.")
      .def(py::init([](shared_ptr<BaseMatrix> mat, const BitArray & inner) {
             auto sparse = dynamic_pointer_cast<SparseMatrix<double>>(mat);
             if (!sparse || dynamic_pointer_cast<SparseMatrixSymmetric<double>>(mat))
               throw Exception("InnerElimination: the matrix must be sparse, real and scalar");
             py::gil_scoped_release release;
             return make_shared<InnerElimination>(sparse, inner);
           }),
           py::arg("mat").none(false), py::arg("inner"))
      .def_property_readonly(
          "mat",
          [](const InnerElimination & self) -> shared_ptr<BaseMatrix> { return self.Left(); },
          "Matrix of the other dofs; the inner ones have their diagonal alone.")
      .def(
          "Reduce",
          [](const InnerElimination & self, Numbers<double> rhs) {
            Numbers<double> reduced(rhs.size());
            auto from = View(rhs, Size(self)), to = View(reduced, Size(self));
            py::gil_scoped_release release;
            self.Reduce(from, to);
            return reduced;
          },
          py::arg("rhs"), "Right hand side of `mat`, zero on inner dofs.")
      .def(
          "Expand",
          [](const InnerElimination & self, Numbers<double> rhs, Numbers<double> x) {
            Numbers<double> solution(x.size());
            auto from = View(rhs, Size(self)), part = View(x, Size(self));
            auto to = View(solution, Size(self));
            py::gil_scoped_release release;
            to = part;
            self.Expand(from, to);
            return solution;
          },
          py::arg("rhs"), py::arg("x"), "Solution on all dofs from one of `mat`.");
}
} // namespace ngslac
