// SPDX-License-Identifier: LGPL-2.1-or-later
#include "condense.hpp"
#include "formdiagonal.hpp"
#include "gmres.hpp"
#include "inner.hpp"
#include "numpy.hpp"
#include "schur.hpp"
#include "twolevel.hpp"

namespace ngslac {
using namespace ngcomp;

namespace {
std::pair<shared_ptr<SparseMatrix<double>>, Array<int>>
Given(shared_ptr<BaseMatrix> mat, const std::vector<int> & multipliers) {
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
Numbers<double> Changed(const Condensation & system, const Numbers<double> & given, F f) {
  Vector<> values = View(given, system.VHeight());
  {
    py::gil_scoped_release release;
    f(FlatVector<>(values));
  }
  return ToNumPy(FlatVector<>(values));
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
             auto [sparse, dofs] = Given(mat, multipliers);
             py::gil_scoped_release release;
             return make_shared<Condensation>(sparse, dofs, dim, free);
           }),
           py::arg("mat"), py::arg("multipliers"), py::arg("dim"), py::arg("freedofs"))
      .def(
          "Part",
          [](const Condensation & self, shared_ptr<BitArray> dofs) -> shared_ptr<BaseMatrix> {
            py::gil_scoped_release release;
            return self.Part(dofs.get());
          },
          py::arg("dofs") = nullptr,
          "Sparse matrix of some dofs, numbered anew; of all with their own numbers by default.")
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
          [](const Condensation & self, Values rhs, Values u, Values image) {
            return Changed(self, rhs,
                           [&, displacements = View(u, self.VHeight()),
                            forces = View(image, self.VHeight())](FlatVector<> x) {
                             x = self.Reduce(Vector<>(x), displacements, forces);
                           });
          },
          py::arg("rhs"), py::arg("u"), py::arg("image"),
          "Right hand side of `mat`, with the bulk's forces of what fulfils the constraints.")
      .def(
          "Complete",
          [](const Condensation & self, Values rhs, Values u, Values image) {
            return Changed(self, u,
                           [&, from = View(rhs, self.VHeight()),
                            forces = View(image, self.VHeight())](FlatVector<> x) {
                             self.Complete(from, forces, x);
                           });
          },
          py::arg("rhs"), py::arg("u"), py::arg("image"),
          "Displacements and multipliers, with the bulk's forces of the first.");
  py::class_<StarSweeps, shared_ptr<StarSweeps>>(
      m, "StarSweeps",
      "Sweeps on some scalar dofs, by overlapping `stars` of dofs with `dim` entries each, all of\n"
      "which are solved for at once.")
      .def(py::init([](const Condensation & system, const BitArray & dofs, const Table<int> & stars,
                       int dim) {
             py::gil_scoped_release release;
             return make_shared<StarSweeps>(system, dofs, stars, dim);
           }),
           py::arg("system"), py::arg("dofs"), py::arg("stars"), py::arg("dim"))
      .def("Update", &StarSweeps::Update, py::call_guard<py::gil_scoped_release>(),
           py::arg("system"), "Takes over a system with the same bulk.");
  py::class_<TwoLevel, shared_ptr<TwoLevel>, BaseMatrix>(
      m, "TwoLevel",
      "Preconditioner: a sweep forward, a correction of some free dofs, a sweep backward. The\n"
      "operator `coarse` makes the correction from the residual on these dofs.")
      .def(py::init([](const Condensation & system, shared_ptr<StarSweeps> sweeps,
                       shared_ptr<BaseMatrix> coarse, const Numbers<int> & dofs) {
             return make_shared<TwoLevel>(system, sweeps, coarse, FromNumPy(dofs));
           }),
           py::arg("system"), py::arg("sweeps").none(false), py::arg("coarse").none(false),
           py::arg("dofs"));
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
  py::class_<TwoLevelProduct, shared_ptr<TwoLevelProduct>, PreconditionedProduct>(
      m, "TwoLevelProduct",
      "On the free dofs for a preconditioner M of A itself, to single precision.")
      .def(py::init<shared_ptr<TwoLevel>, shared_ptr<Condensation>>(),
           py::arg("preconditioner").none(false), py::arg("system").none(false));
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
