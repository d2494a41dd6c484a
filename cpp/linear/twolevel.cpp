// SPDX-License-Identifier: LGPL-2.1-or-later
#include "gmres.hpp"
#include "numpy.hpp"
#include "starsweeps.hpp"

namespace ngslac {
namespace {
/// Preconditioner: a sweep forward, a correction on a coarse space, and a sweep backward.
///
/// Symmetric where the system and the correction are.
class TwoLevel : public SquareOperator {
public:
  using Node = BlockedRows::Node;

  /// The coarse operator takes the residual on some dofs, 0 at -1, and returns their correction.
  TwoLevel(const Condensation & system, shared_ptr<StarSweeps> asweeps,
           shared_ptr<BaseMatrix> acoarse, FlatArray<int> dofs)
      : SquareOperator(system), sweeps(asweeps), coarse(acoarse) {
    if (size_t(coarse->VHeight()) != dofs.Size())
      throw Exception("TwoLevel: " + ToString(dofs.Size()) +
                      " dofs for a coarse operator of size " + ToString(coarse->VHeight()));
    auto & slot = sweeps->Order().slot;
    for (int i : Range(dofs))
      if (dofs[i] == -1)
        continue;
      else if (dofs[i] < 0 || size_t(dofs[i]) >= slot.Size() || slot[dofs[i]] < 0)
        throw Exception("TwoLevel: dof " + ToString(dofs[i]) + " of the coarse system is not free");
      else
        places.Append({slot[dofs[i]], i});
    QuickSort(places);
  }

  /// y = M^-1 x
  void Mult(const BaseVector & x, BaseVector & y) const override {
    static Timer timer("ngslac::TwoLevel");
    RegionTimer reg(timer);
    Array<Node> b(sweeps->Order().Size()), z(sweeps->NValues());
    sweeps->Gather(x.FV<double>(), b);
    ParallelFor(z.Size(), [&](size_t row) { z[row].fill(0); });
    sweeps->Sweep(b, z, false);
    Correct(b, z);
    sweeps->Sweep(b, z, true);
    sweeps->Scatter(z, y.FV<double>());
  }

  /// y = K x  without what macro-elements add, to single precision.
  void MultBulk(const BaseVector & x, BaseVector & y) const {
    static Timer timer("ngslac::TwoLevel - bulk");
    RegionTimer reg(timer);
    Array<Node> z(sweeps->Order().Size()), image(z.Size());
    sweeps->Gather(x.FV<double>(), z);
    ParallelFor(z.Size(), [&](size_t row) { image[row] = sweeps->Rows().TimesBulk(row, z); });
    sweeps->Scatter(image, y.FV<double>());
  }

private:
  static constexpr int width = NodeOrder::width;
  void Correct(FlatArray<Node> b, FlatArray<Node> z) const {
    auto left = coarse->CreateColVector(), correction = coarse->CreateRowVector();
    auto node = [&](size_t i) { return size_t(places[i].first) / width; };
    left = 0;
    ParallelFor(places.Size(), [&](size_t i) {
      if (i && node(i - 1) == node(i))
        return; // the first dof of a node does it for all
      Node product = sweeps->Rows().Times(node(i), z);
      for (size_t j = i; j < places.Size() && node(j) == node(i); j++) {
        auto [slot, dof] = places[j];
        left.FV<double>()(dof) = b[slot / width][slot % width] - product[slot % width];
      }
    });
    coarse->Mult(left, correction);
    ParallelFor(places.Size(), [&](size_t i) {
      auto [slot, dof] = places[i];
      z[slot / width][slot % width] += float(correction.FV<double>()(dof));
    });
    sweeps->SetMacroValues(z);
  }

  shared_ptr<StarSweeps> sweeps;
  shared_ptr<BaseMatrix> coarse;
  Array<std::pair<int, int>> places; // slot of each dof, in ascending order, and its number
};

/// With this preconditioner, to single precision.
class TwoLevelProduct : public PreconditionedProduct {
public:
  TwoLevelProduct(shared_ptr<TwoLevel> pre, shared_ptr<Condensation> system)
      : pre(pre), system(system) {}
  shared_ptr<BaseVector> MakeVector() const override { return system->CreateColVector(); }
  void Apply(const BaseVector & x, BaseVector & z, BaseVector & image) const override {
    pre->Mult(x, z);
    system->Project(z.FV<double>());
    pre->MultBulk(z, image);
    system->ToImage(z.FV<double>(), image.FV<double>());
  }

private:
  shared_ptr<TwoLevel> pre;
  shared_ptr<Condensation> system;
};
} // namespace

void ExportTwoLevel(py::module & m) {
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
      "operator `coarse` makes the correction from the residual on these `dofs`, which is 0 where\n"
      "they are -1.")
      .def(py::init([](const Condensation & system, shared_ptr<StarSweeps> sweeps,
                       shared_ptr<BaseMatrix> coarse, const Numbers<int> & dofs) {
             return make_shared<TwoLevel>(system, sweeps, coarse, FromNumPy(dofs));
           }),
           py::arg("system"), py::arg("sweeps").none(false), py::arg("coarse").none(false),
           py::arg("dofs"));
  py::class_<TwoLevelProduct, shared_ptr<TwoLevelProduct>, PreconditionedProduct>(
      m, "TwoLevelProduct",
      "On the free dofs for a preconditioner M of A itself, to single precision.")
      .def(py::init<shared_ptr<TwoLevel>, shared_ptr<Condensation>>(),
           py::arg("preconditioner").none(false), py::arg("system").none(false));
}
} // namespace ngslac
