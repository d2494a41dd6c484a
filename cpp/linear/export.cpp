// SPDX-License-Identifier: LGPL-2.1-or-later
#include "condense.hpp"
#include "formdiagonal.hpp"
#include "gmres.hpp"
#include "numpy.hpp"

namespace ngslac {
using namespace ngcomp;

namespace {
std::pair<shared_ptr<SparseMatrix<double>>, Array<int>>
SparseWithDofs(shared_ptr<BaseMatrix> mat, const std::vector<int> & multipliers) {
  auto sparse = dynamic_pointer_cast<SparseMatrix<double>>(mat);
  if (!sparse)
    throw Exception("Condensation: the matrix must be sparse, real and scalar");
  Array<int> dofs(multipliers.size());
  for (int i : Range(dofs))
    dofs[i] = multipliers[i];
  return {sparse, std::move(dofs)};
}

/// A vector that f has changed.
template <typename F>
Numbers<double> Changed(const Condensation & system, const Numbers<double> & numbers, F f) {
  Vector<> values = View(numbers, system.VHeight());
  {
    py::gil_scoped_release release;
    f(FlatVector<>(values));
  }
  return ToNumPy(FlatVector<>(values));
}

/// The forces of the bulk: from the caller, or of these displacements at the dofs that matter.
Vector<> Forces(const Condensation & self, FlatVector<> u,
                const optional<Numbers<double>> & image) {
  if (image)
    return View(*image, self.VHeight());
  py::gil_scoped_release release;
  return self.NearImage(u);
}

/// Products that Python makes of arrays, of which each process may have a part.
class FunctionProduct : public PreconditionedProduct {
  size_t size;
  py::function apply, total;

  static Numbers<double> Shown(const BaseVector & vec) {
    auto values = vec.FV<double>();
    return Numbers<double>(values.Size(), values.Data(), py::none()); // a view
  }

public:
  FunctionProduct(size_t asize, py::function function, py::function atotal)
      : size(asize), apply(function), total(atotal) {}
  shared_ptr<BaseVector> MakeVector() const override { return make_shared<VVector<double>>(size); }
  void Apply(const BaseVector & x, BaseVector & z, BaseVector & image) const override {
    py::gil_scoped_acquire acquire;
    apply(Shown(x), Shown(z), Shown(image));
  }
  void Total(FlatVector<> sums) const override {
    py::gil_scoped_acquire acquire;
    auto found = total(ToNumPy(sums)).cast<Numbers<double>>();
    sums = View(found, sums.Size());
  }
};

/// Throws what a signal raised, such as the user's Ctrl-C.
void LookForSignals() {
  py::gil_scoped_acquire acquire;
  if (PyErr_CheckSignals())
    throw py::error_already_set();
}
} // namespace

void ExportLinear(py::module & m) {
  using Values = Numbers<double>;
  auto in_place = [](void (Condensation::*change)(FlatVector<>) const) {
    return [change](const Condensation & self, Values z) {
      return Changed(self, z, [&](FlatVector<> x) { (self.*change)(x); });
    };
  };
  py::class_<Condensation, shared_ptr<Condensation>, BaseMatrix>(
      m, "Condensation",
      "Newton system without multipliers, by lifts of least energy, whatever the stiffnesses.\n"
      "`Part` is of a sparse matrix that is equivalent to the product. But for both, `mat` may "
      "hold\n"
      "the rows and columns of the multipliers alone.")
      .def(py::init([](shared_ptr<BaseMatrix> mat, const std::vector<int> & multipliers, int dim,
                       const BitArray & free) {
             auto [sparse, dofs] = SparseWithDofs(mat, multipliers);
             py::gil_scoped_release release;
             return make_shared<Condensation>(sparse, dofs, dim, free);
           }),
           py::arg("mat"), py::arg("multipliers"), py::arg("dim"), py::arg("freedofs"))
      .def(
          "Part",
          [](const Condensation & self, const Numbers<int> & dofs,
             const BitArray * rows) -> shared_ptr<BaseMatrix> {
            auto list = FromNumPy(dofs);
            if (rows && rows->Size() != list.Size())
              throw Exception("Condensation: " + ToString(rows->Size()) + " bits of rows for " +
                              ToString(list.Size()) + " dofs");
            py::gil_scoped_release release;
            return self.Part(list, rows);
          },
          py::arg("dofs"), py::arg("rows") = nullptr,
          "Sparse matrix of some dofs in this order; rows and columns of -1 are of the identity. "
          "Only\n`rows` (BitArray) are filled.")
      .def_property_readonly(
          "changed",
          [](const Condensation & self) {
            Array<bool> changed(self.Height());
            for (size_t i : Range(changed))
              changed[i] = self.Changes(i);
            return ToNumPy(changed);
          },
          "(n,) bool: rows that macro-elements may add to")
      .def_property_readonly(
          "constraints", [](const Condensation & self) { return ToNumPy(self.Constraints()); },
          "(n,) int: eliminated directions of each macro-element")
      .def_property_readonly(
          "diagonal", [](const Condensation & self) { return ToNumPy(self.Diagonal()); },
          "(n,): of the sparse matrix")
      .def_property_readonly("has_symmetric_contact", &Condensation::HasSymmetricContact,
                             "as without slip")
      .def_property_readonly("freedofs", &Condensation::Free, "the free displacements")
      .def("Project", in_place(&Condensation::Project), py::arg("z"),
           "P z: the part of displacements that keeps the constraints.")
      .def("Test", in_place(&Condensation::Test), py::arg("f"),
           "The part of forces that tests what keeps the constraints.")
      .def(
          "Displacements",
          [](const Condensation & self, Values rhs, Values w) {
            return Changed(self, w, [&, from = View(rhs, self.VHeight())](FlatVector<> x) {
              x = self.Displacements(from, x);
            });
          },
          py::arg("rhs"), py::arg("w"),
          "Those of the solution from one of `mat`; from zero: what fulfils the constraints.")
      .def(
          "Reduce",
          [](const Condensation & self, Values rhs, Values u, optional<Values> image) {
            auto moved = View(u, self.VHeight());
            Vector<> bulk = Forces(self, moved, image);
            return Changed(self, rhs,
                           [&](FlatVector<> x) { x = self.Reduce(Vector<>(x), moved, bulk); });
          },
          py::arg("rhs"), py::arg("u"), py::arg("image") = nullopt,
          "Right hand side of `mat`, with the bulk's forces of what fulfils the constraints.")
      .def(
          "Complete",
          [](const Condensation & self, Values rhs, Values u, optional<Values> image) {
            auto from = View(rhs, self.VHeight());
            Vector<> bulk = Forces(self, View(u, self.VHeight()), image);
            return Changed(self, u, [&](FlatVector<> x) { self.Complete(from, bulk, x); });
          },
          py::arg("rhs"), py::arg("u"), py::arg("image") = nullopt,
          "Displacements and multipliers, with the bulk's forces of the first.");
  py::class_<PreconditionedProduct, shared_ptr<PreconditionedProduct>>(
      m, "PreconditionedProduct", "Products with a matrix A after a preconditioner M.")
      .def(py::init([](shared_ptr<BaseMatrix> mat, shared_ptr<BaseMatrix> inverse) {
             shared_ptr<PreconditionedProduct> product = make_shared<OperatorProduct>(mat, inverse);
             return product;
           }),
           py::arg("mat").none(false), py::arg("inverse") = nullptr)
      .def(py::init([](size_t size, py::function apply, py::function total) {
             shared_ptr<PreconditionedProduct> product =
                 make_shared<FunctionProduct>(size, apply, total);
             return product;
           }),
           py::arg("size"), py::arg("apply"), py::arg("total"),
           "apply(x, z, image) fills arrays: z = M^-1 x and image = A z. Where processes have "
           "parts\n"
           "of the vectors, total(numbers) sums up arrays over all of them.")
      .def("Apply", &PreconditionedProduct::Apply, py::call_guard<py::gil_scoped_release>(),
           py::arg("x"), py::arg("z"), py::arg("image"), "z = M^-1 x and image = A z.");
  m.def(
      "FormDiagonal",
      [](const BilinearForm & form, const BitArray & wanted) {
        return ToNumPy(FlatVector<>(FormDiagonal(form, wanted)));
      },
      py::arg("form"), py::arg("wanted"),
      "Diagonal (n,) of the elements of a form that hold one of the wanted dofs.");

  m.def(
      "GMRes",
      [](shared_ptr<PreconditionedProduct> product, shared_ptr<BaseVector> rhs,
         const BitArray & free, double tol, int maxiter, int patience) {
        GMResSolution found;
        {
          py::gil_scoped_release release;
          found = GMRes(*product, *rhs, free, {tol, maxiter, patience}, LookForSignals);
        }
        return py::make_tuple(found.x, ToNumPy(found.residuals), found.converged);
      },
      py::arg("product").none(false), py::arg("rhs").none(false), py::arg("freedofs"),
      py::arg("tol"), py::arg("maxiter"), py::arg("patience") = 0,
      "GMRES from zero without restart, preconditioned from the right: solution of least "
      "residual,\n"
      "norms of the residuals before the first product and after each, and whether the last is at\n"
      "most `tol` times the first. Ends where `patience` products, if not 0, did not halve it.\n"
      "The preconditioner may be of any precision: flexible GMRES.");
}
} // namespace ngslac
