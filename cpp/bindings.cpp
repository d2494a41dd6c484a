#include "contact/contactform.hpp"
#include "contact/merge.hpp"
#include "space/arguments.hpp"

using namespace ngslac;

namespace ngslac {
void ExportMeshTools(py::module & m);
void ExportPolygon(py::module & m);
void ExportCondense(py::module & m);
} // namespace ngslac

namespace {
constexpr const char * space_doc =
    R"(Contact tractions, constant on macro-elements of the slave surface.

Every macro-element contains the support of at least one free displacement basis function, so that
the method is inf-sup stable (Abbas, Drouet, Hild, Pignet 2017, section 2.2). The supports are read
off the displacement space: single faces where these carry an inner dof (order >= 2 in 2D, or
`BubbleVectorH1`), stars of faces around a vertex for first order. A function of the space is the
traction acting on the slave body in Cartesian components (stress units), one vector per
macro-element; there are no other dofs.

Parameters
----------
V : ngsolve.FESpace
    Displacement space, vector-valued and real, of any kind and order: VectorH1, H1(dim=d),
    VectorValued, a component of a product space. Dofs with Dirichlet conditions do not count.
slave : str or Region
    Pattern of boundary names, or a boundary region: the side that carries the multipliers.
macros : list[int], optional
    Macro-element of each slave face in the order of the mesh, numbered densely from 0, in place of
    the automatic choice; refused if one holds no inner basis function. Not for refined meshes.
components : int, optional
    Numbers per macro-element; default: the space dimension, as `LACContact` needs it.
autoupdate : bool
    Update with `mesh.Refine()`. Default: as V does.

Raises
------
TypeError, ValueError
    An argument that does not fit: the message names it, its value and what is wanted.
NgException
    Faces of which no stable macro-element can be made (the message names them and the remedies).

Notes
-----
Where the slave's displacement is prescribed in some directions, macro-elements carry the others
exactly. In the prescribed ones they stick elastically, with a slip of a hundredth of what the surface
gives under the same traction, and slip as elsewhere. So do faces that nothing can move along their
normal, beside those that can. `LACContact.Check` names these macro-elements.

Examples
--------
>>> V = VectorH1(mesh, order=2, dirichlet="bottom")
>>> Q = LACSpace(V, slave="slave")
>>> (u, lam), (v, mu) = (V * Q).TnT()
>>> Q.ndof == mesh.dim * Q.nmacros
True
)";

void ExportSpace(py::module & m) {
  py::class_<LACSpace, shared_ptr<LACSpace>, FESpace>(m, "LACSpace", space_doc)
      .def(py::init([](const Given<shared_ptr<FESpace>> & V, const py::args & more,
                       const Given<std::variant<Region, string>> & slave,
                       const Given<std::vector<int>> & macros, const Given<int> & components,
                       const Given<bool> & autoupdate, const py::kwargs & others) {
             CheckNoMore("LACSpace", more, others, "V, slave=, macros=, components=, autoupdate=");
             return SpaceArguments{V, slave, macros, components, autoupdate}.Make();
           }),
           py::arg("V") = py::none(), py::arg("slave") = py::none(), py::arg("macros") = py::none(),
           py::arg("components") = py::none(), py::arg("autoupdate") = false)
      .def(py::pickle(
          [](const LACSpace & self) {
            return py::make_tuple(self.Displacement(), self.GetFlags());
          },
          [](py::tuple state) {
            return MakeSpace(state[0].cast<shared_ptr<FESpace>>(), state[1].cast<Flags>());
          }))
      .def_property_readonly(
          "displacement", &LACSpace::Displacement,
          "The displacement space (FESpace) that the macro-elements are made for.")
      .def_property_readonly("nmacros", &LACSpace::NMacros, "Number of macro-elements.")
      .def_property_readonly(
          "macros", [](const LACSpace & self) { return Array<int>(self.MacroOfFace()); },
          "Macro-element of each boundary element of the mesh, -1 off the slave surface.")
      .def_property_readonly("slave", &LACSpace::SlaveRegion, "The slave surface (Region).")
      .def(
          "WithComponents",
          [](const LACSpace & self, const Given<int> & components) {
            return self.WithComponents(CheckedComponents(components));
          },
          py::arg("components"),
          R"(The space on the same macro-elements with another number of components.

Parameters
----------
components : int
    1, 2 or 3 numbers per macro-element.

Returns
-------
LACSpace)")
      .def(
          "CoreDofs",
          [](const LACSpace & self, const Given<long> & given) {
            long macro = given.As("LACSpace.CoreDofs: macro", "the number of a macro-element");
            if (macro < 0 || size_t(macro) >= self.NMacros())
              throw py::index_error("LACSpace.CoreDofs: there is no macro-element " +
                                    ToString(macro));
            return Array<int>(self.CoreDofs(macro));
          },
          py::arg("macro"),
          R"(Displacement dofs whose trace on the slave surface lives in one macro-element alone.

Parameters
----------
macro : int

Returns
-------
Array of int
    Numbers in `displacement`; at least one.

Raises
------
IndexError
    If there is no such macro-element.)");
}

template <typename T>
py::array_t<T> ToNumPy(const Array<T> & values) {
  return py::array_t<T>(values.Size(), values.Data());
}

using History = std::map<string, py::array_t<double, py::array::c_style | py::array::forcecast>>;

FormHistory FromNumPy(const History & history) {
  FormHistory copy;
  for (auto & [name, values] : history)
    copy[name] = FlatArray<double>(values.size(), const_cast<double *>(values.data()));
  return copy;
}

void ExportContact(py::module & m) {
  py::enum_<Side>(m, "Side")
      .value("slave", Side::slave)
      .value("master", Side::master)
      .value("both", Side::both);
  py::class_<ContactForm, shared_ptr<ContactForm>>(m, "ContactForm")
      .def(py::init([](shared_ptr<CoefficientFunction> u, shared_ptr<CoefficientFunction> lam,
                       optional<Region> master, shared_ptr<CoefficientFunction> obstacle,
                       shared_ptr<CoefficientFunction> friction,
                       shared_ptr<CoefficientFunction> tresca, bool tied, bool finite,
                       double maxdist, double penetration) {
             return ContactForm::Create(ContactSetup{u, lam, master, obstacle, friction, tresca,
                                                     tied, finite, maxdist, penetration});
           }),
           py::kw_only(), py::arg("u").none(false), py::arg("lam").none(false),
           py::arg("master") = nullopt, py::arg("obstacle") = nullptr,
           py::arg("friction") = nullptr, py::arg("tresca") = nullptr, py::arg("tied") = false,
           py::arg("finite") = false, py::arg("maxdist") = 0.0, py::arg("penetration") = 0.0)
      .def(
          "Update",
          [](ContactForm & self, shared_ptr<GridFunction> gf, const optional<History> & history) {
            auto copy = history ? FromNumPy(*history) : FormHistory();
            py::gil_scoped_release release;
            self.Update(gf, history ? &copy : nullptr);
          },
          py::arg("gf") = nullptr, py::arg("history") = nullopt)
      .def("CheckPaired", &ContactForm::CheckPaired)
      .def(
          "SetStiffness",
          [](ContactForm & self, const BaseMatrix & bulk, double factor) {
            auto diagonal = ScalarDiagonal(bulk);
            self.SetStiffness(FlatVector<>(diagonal.Size(), diagonal.Data()), factor);
          },
          py::arg("bulk"), py::arg("factor") = 1.0, py::call_guard<py::gil_scoped_release>())
      .def("SetConstant", &ContactForm::SetConstant, py::arg("c"))
      .def("Follow", &ContactForm::Follow, py::call_guard<py::gil_scoped_release>())
      .def("AddApply", &ContactForm::AddApply, py::call_guard<py::gil_scoped_release>())
      .def("AssembleLinearization", &ContactForm::AssembleLinearization,
           py::call_guard<py::gil_scoped_release>())
      .def("AssembleStep", &ContactForm::AssembleStep, py::call_guard<py::gil_scoped_release>())
      .def("BeginSolve", &ContactForm::BeginSolve)
      .def("Evaluate", &ContactForm::Evaluate, py::call_guard<py::gil_scoped_release>())
      .def("Commit", &ContactForm::Commit, py::call_guard<py::gil_scoped_release>())
      .def("Restore", &ContactForm::Restore)
      .def("History",
           [](ContactForm & self) {
             py::dict history;
             for (auto & [name, values] : self.History())
               history[name.c_str()] = ToNumPy(values);
             return history;
           })
      .def("SetHistory",
           [](ContactForm & self, const History & history) { self.SetHistory(FromNumPy(history)); })
      .def(
          "AssembleAugmented",
          [](ContactForm & self, const BaseVector & x, BaseVector & residual, double factor)
              -> shared_ptr<BaseMatrix> { return self.AssembleAugmented(x, residual, factor); },
          py::arg("x"), py::arg("residual"), py::arg("factor") = 1.0,
          py::call_guard<py::gil_scoped_release>())
      .def(
          "AssembleSprings",
          [](ContactForm & self, const BaseVector & x,
             py::array_t<double, py::array::c_style | py::array::forcecast> stiffness)
              -> shared_ptr<BaseMatrix> {
            FlatArray<double> values(stiffness.size(), stiffness.mutable_data());
            py::gil_scoped_release release;
            return self.AssembleSprings(x, values);
          },
          py::arg("x"), py::arg("stiffness"))
      .def("UpdateMultipliers", &ContactForm::UpdateMultipliers, py::arg("x"),
           py::arg("factor") = 1.0, py::call_guard<py::gil_scoped_release>())
      .def("Close", &ContactForm::Close, py::arg("macros"), py::arg("x"))
      .def("JumpMatrix",
           [](ContactForm & self, Side side) -> shared_ptr<BaseMatrix> {
             return self.JumpMatrix(side);
           })
      .def("Vectors", [](ContactForm & self, string name) { return ToNumPy(self.Vectors(name)); })
      .def("Scalars", [](ContactForm & self, string name) { return ToNumPy(self.Scalars(name)); })
      .def("States",
           [](ContactForm & self) {
             Array<double> values;
             for (auto & s : self.States())
               AppendState(values, s);
             return ToNumPy(values);
           })
      .def("MultiplierDofs",
           [](ContactForm & self) { return ToNumPy(Array<int>(self.MultiplierDofs())); })
      .def("Segments",
           [](ContactForm & self) {
             auto table = self.Segments();
             return py::make_tuple(ToNumPy(table.values), ToNumPy(table.corners),
                                   ToNumPy(table.first));
           })
      .def("Overlaps", [](ContactForm & self) { return ToNumPy(self.Overlaps()); })
      .def_property_readonly("nsegments", &ContactForm::NSegments)
      .def_property_readonly("space", &ContactForm::Space)
      .def_property_readonly("fes", [](ContactForm & self) { return self.U().fes; })
      .def_property_readonly("offset", [](ContactForm & self) { return self.U().offset; })
      .def_property_readonly("lamoffset", [](ContactForm & self) { return self.Lambda().offset; })
      .def_property_readonly("component", [](ContactForm & self) { return self.U().component; })
      .def_property_readonly("paired", &ContactForm::IsPaired)
      .def_property_readonly("current", &ContactForm::IsCurrent)
      .def_property_readonly(
          "mat", [](ContactForm & self) -> shared_ptr<BaseMatrix> { return self.Mat(); });
}
} // namespace

PYBIND11_MODULE(_ngslac, m) {
  py::module_::import("ngsolve"); // its types must be registered first
  ExportSpace(m);
  ExportContact(m);
  ExportMeshTools(m);
  ExportPolygon(m);
  ExportCondense(m);
  m.def(
      "EquilibrationScale",
      [](const BaseMatrix & bulk, std::vector<shared_ptr<ContactForm>> contacts) {
        auto scale = EquilibrationScale(bulk);
        for (auto & contact : contacts)
          if (!contact)
            throw Exception("EquilibrationScale: None is no contact");
          else
            contact->AddScale(FlatVector<>(scale.Size(), scale.Data()));
        return ToNumPy(scale);
      },
      py::arg("bulk"), py::arg("contacts"));
  m.def(
      "MergeMatrices",
      [](const BaseMatrix & bulk,
         const std::vector<std::variant<shared_ptr<ContactForm>, shared_ptr<BaseMatrix>>> &
             contacts,
         py::array_t<double, py::array::c_style | py::array::forcecast> scale,
         shared_ptr<BaseMatrix> former) -> shared_ptr<BaseMatrix> {
        Array<shared_ptr<SparseMatrix<double>>> mats;
        for (auto & contact : contacts)
          if (auto form = std::get_if<shared_ptr<ContactForm>>(&contact))
            mats.Append(*form ? (*form)->Mat() : nullptr);
          else
            mats.Append(dynamic_pointer_cast<SparseMatrix<double>>(std::get<1>(contact)));
        if (mats.Contains(nullptr))
          throw Exception("MergeMatrices: a contact matrix must be sparse, real and scalar");
        FlatVector<> values(scale.size(), const_cast<double *>(scale.data()));
        py::gil_scoped_release release;
        return MergeMatrices(bulk, mats, values,
                             dynamic_pointer_cast<SparseMatrix<double>>(former));
      },
      py::arg("bulk"), py::arg("contacts"), py::arg("scale"), py::arg("former") = nullptr,
      "diag(scale) (bulk + contacts) diag(scale). Of `former`, merged from the same bulk with the\n"
      "same scale, only rows with contact are written anew, where the graph is the same.");
}
