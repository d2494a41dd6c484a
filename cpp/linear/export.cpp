#include "gmres.hpp"
#include "nodeblocks.hpp"
#include "orthogonal.hpp"
#include "pivots.hpp"
#include "twolevel.hpp"
#include <comp.hpp>
#include <python_comp.hpp>

namespace ngslac {
using namespace ngcomp;

namespace {
using Numbers = py::array_t<double, py::array::c_style | py::array::forcecast>;

FlatVector<> View(const Numbers & values, const Condensation & self) {
  if (values.size() != self.VHeight())
    throw Exception("Condensation: a vector needs one entry per row of the matrix");
  return FlatVector<>(values.size(), const_cast<double *>(values.data()));
}

template <typename T>
using Entries = py::array_t<T, py::array::c_style | py::array::forcecast>;

template <typename T>
Array<T> Copied(const Entries<T> & entries) {
  Array<T> copy(entries.size());
  std::copy_n(entries.data(), entries.size(), copy.begin());
  return copy;
}

template <typename T>
Entries<T> Exported(FlatArray<T> values) {
  return Entries<T>(values.Size(), values.Data());
}

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

/// Throws what a signal raised, such as the user's Ctrl-C.
void LookForSignals() {
  py::gil_scoped_acquire acquire;
  if (PyErr_CheckSignals())
    throw py::error_already_set();
}
} // namespace

void ExportLinear(py::module & m) {
  py::class_<Condensation, shared_ptr<Condensation>, BaseMatrix>(
      m, "Condensation",
      "Newton system without multipliers: each macro-element's multiplier and one inner node of "
      "its\n"
      "displacement are eliminated exactly. `symmetric` takes slip for frictionless.")
      .def(py::init([](shared_ptr<BaseMatrix> mat, const std::vector<int> & multipliers, int dim,
                       const BitArray & free, bool symmetric) {
             auto [sparse, dofs] = Given(mat, multipliers);
             py::gil_scoped_release release;
             shared_ptr<Condensation> system =
                 make_shared<PivotCondensation>(sparse, dofs, dim, free, symmetric);
             return system;
           }),
           py::arg("mat"), py::arg("multipliers"), py::arg("dim"), py::arg("freedofs"),
           py::arg("symmetric") = false)
      .def(
          "Part",
          [](const Condensation & self, shared_ptr<BitArray> dofs) -> shared_ptr<BaseMatrix> {
            py::gil_scoped_release release;
            return self.Part(dofs.get());
          },
          py::arg("dofs") = nullptr,
          "Sparse matrix of some dofs, numbered anew; of all with their own numbers by default.")
      .def(
          "NodeBlocks",
          [](const Condensation & self, const Entries<int> & nodes) {
            if (nodes.ndim() != 2 || nodes.shape(1) < 1)
              throw Exception("NodeBlocks: nodes must be a table with a row of dofs for each");
            auto list = Copied(nodes);
            BlockRows rows;
            {
              py::gil_scoped_release release;
              rows = NodeBlocks(self, list, nodes.shape(1));
            }
            return py::make_tuple(Exported<int>(rows.starts), Exported<int>(rows.columns),
                                  Exported<double>(rows.values));
          },
          py::arg("nodes"),
          "The part of some nodes (m, k) of dofs, as starts, columns and entries of its blocks.\n"
          "-1 stands for no dof; what is not free is a row of the identity.")
      .def_property_readonly(
          "constraints",
          [](const Condensation & self) {
            auto counts = self.Constraints();
            return py::array_t<int>(counts.Size(), counts.Data());
          },
          "(n,) int: eliminated directions of each macro-element")
      .def_property_readonly(
          "diagonal", [](const Condensation & self) { return Exported<double>(self.Diagonal()); },
          "(n,): of the sparse matrix")
      .def_property_readonly("has_symmetric_contact", &Condensation::HasSymmetricContact,
                             "as without slip")
      .def_property_readonly("freedofs", &Condensation::Free, "the free displacements")
      .def(
          "Reduce",
          [](const Condensation & self, Numbers rhs) {
            Numbers reduced(rhs.size());
            auto from = View(rhs, self), to = View(reduced, self);
            py::gil_scoped_release release;
            self.Reduce(from, to);
            return reduced;
          },
          py::arg("rhs"), "Right hand side of `mat` for one of the whole system.")
      .def(
          "Expand",
          [](const Condensation & self, Numbers rhs, Numbers w) {
            Numbers x(rhs.size());
            auto from = View(rhs, self), part = View(w, self), to = View(x, self);
            py::gil_scoped_release release;
            self.Expand(from, part, to);
            return x;
          },
          py::arg("rhs"), py::arg("w"), "Solution of the whole system from one of `mat`.");
  py::class_<OrthogonalCondensation, shared_ptr<OrthogonalCondensation>, Condensation>(
      m, "OrthogonalCondensation",
      "The same by lifts of least energy, whatever the stiffnesses, for preconditioned "
      "iterations.\n"
      "`Part` is of a sparse matrix that is equivalent to the product.")
      .def(py::init([](shared_ptr<BaseMatrix> mat, const std::vector<int> & multipliers, int dim,
                       const BitArray & free) {
             auto [sparse, dofs] = Given(mat, multipliers);
             py::gil_scoped_release release;
             return make_shared<OrthogonalCondensation>(sparse, dofs, dim, free);
           }),
           py::arg("mat"), py::arg("multipliers"), py::arg("dim"), py::arg("freedofs"));
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
      "Preconditioner: a sweep forward, a correction, a sweep backward. The correction is by the\n"
      "operator `coarse`, on a space whose functions are the columns of a sparse matrix: the rows\n"
      "(starts, columns, values) belong to the free `dofs`, and others are empty.")
      .def(py::init([](const Condensation & system, shared_ptr<StarSweeps> sweeps,
                       shared_ptr<BaseMatrix> coarse, const Entries<int> & dofs,
                       const Entries<int> & starts, const Entries<int> & columns,
                       const Entries<float> & values) {
             SparseRows rows{Copied(starts), Copied(columns), Copied(values)};
             auto list = Copied(dofs);
             py::gil_scoped_release release;
             return make_shared<TwoLevel>(system, sweeps, coarse, rows, list);
           }),
           py::arg("system"), py::arg("sweeps").none(false), py::arg("coarse").none(false),
           py::arg("dofs"), py::arg("starts"), py::arg("columns"), py::arg("values"));
  py::class_<TwoLevelProduct, shared_ptr<TwoLevelProduct>, BaseMatrix>(
      m, "TwoLevelProduct",
      "A M^-1 on the free dofs for a preconditioner M of A, to single precision.")
      .def(py::init<shared_ptr<TwoLevel>, shared_ptr<Condensation>>(),
           py::arg("preconditioner").none(false), py::arg("system").none(false));
  m.def(
      "GMRes",
      [](shared_ptr<BaseMatrix> mat, shared_ptr<BaseVector> rhs, const BitArray & free, double tol,
         int maxiter, int patience, shared_ptr<BaseMatrix> inverse) {
        GMResSolution found;
        {
          py::gil_scoped_release release;
          found = GMRes(*mat, *rhs, free, {tol, maxiter, patience}, LookForSignals, inverse.get());
        }
        py::array_t<double> residuals(found.residuals.Size(), found.residuals.Data());
        return py::make_tuple(found.x, residuals, found.converged);
      },
      py::arg("mat").none(false), py::arg("rhs").none(false), py::arg("freedofs"), py::arg("tol"),
      py::arg("maxiter"), py::arg("patience") = 0, py::arg("inverse") = nullptr,
      "GMRES from zero without restart: solution of least residual, norms of the residuals before\n"
      "the first product and after each, and whether the last is at most `tol` times the first.\n"
      "Ends where `patience` products, if not 0, did not halve it.\n"
      "With an `inverse` as preconditioner from the right, of any precision: flexible GMRES.");
}
} // namespace ngslac
