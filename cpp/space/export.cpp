// SPDX-License-Identifier: LGPL-2.1-or-later
#include "arguments.hpp"
#include "mesh/boundaries.hpp"

namespace ngslac {
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
    VectorValued, a component of a product space. Dofs with Dirichlet conditions do not count. A
    scalar one, such as H1 of a temperature, gets one number per macro-element: what flows into the
    slave per area, by which `LACContact` ties it.
slave : str or Region
    Pattern of boundary names, or a boundary region: the side that carries the multipliers.
macros : list[int], optional
    Macro-element of each slave face in the order of the mesh, numbered densely from 0, in place of
    the automatic choice; refused if one holds no inner basis function. Not for refined meshes.
components : int, optional
    Numbers per macro-element; default: as many as V has, as `LACContact` needs it.
autoupdate : bool
    Update with `mesh.Refine()`. Default: as V does.
axisymmetric : bool
    The mesh in 2D is half of a section through bodies of revolution, x the distance from the axis,
    y along it. Means, areas and forces are those of the whole circumference, so that the bulk form
    has the factor ``2*pi*x``, as `AxisymmetricGrad` shows.

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
} // namespace

void ExportSpace(py::module & m) {
  py::class_<LACSpace, shared_ptr<LACSpace>, FESpace> space(m, "LACSpace", space_doc);
  space.attr("__signature__") = py::module_::import("inspect").attr("signature")(
      py::eval("lambda V, *, slave, macros=None, components=None, autoupdate=False, "
               "axisymmetric=False: None"));
  space
      .def(py::init([](const Argument<shared_ptr<FESpace>> & V, const py::args & more,
                       const Argument<std::variant<Region, string>> & slave,
                       const Argument<std::vector<int>> & macros, const Argument<int> & components,
                       const Argument<bool> & autoupdate, const Argument<bool> & axisymmetric,
                       const py::kwargs & others) {
             CheckNoMore("LACSpace", more, others,
                         "V, slave=, macros=, components=, autoupdate=, axisymmetric=");
             return SpaceArguments{V, slave, macros, components, autoupdate, axisymmetric}.Make();
           }),
           py::arg("V") = py::none(), py::arg("slave") = py::none(), py::arg("macros") = py::none(),
           py::arg("components") = py::none(), py::arg("autoupdate") = false,
           py::arg("axisymmetric") = false)
      .def(py::pickle(
          [](const LACSpace & self) {
            return py::make_tuple(self.Displacement(), self.GetFlags());
          },
          [](py::tuple state) {
            return MakeSpace(state[0].cast<shared_ptr<FESpace>>(), state[1].cast<Flags>());
          }))
      .def("__repr__",
           [](const LACSpace & self) {
             return "<LACSpace: " + ToString(self.NMacros()) + " macro-elements of " +
                    BoundaryNames(self.SlaveRegion()) + ">";
           })
      .def_property_readonly(
          "displacement", &LACSpace::Displacement,
          "The displacement space (FESpace) that the macro-elements are made for.")
      .def_property_readonly("nmacros", &LACSpace::NMacros, "Number of macro-elements.")
      .def_property_readonly(
          "macros", [](const LACSpace & self) { return Array<int>(self.MacroOfFace()); },
          "Macro-element of each boundary element of the mesh, -1 off the slave surface.")
      .def_property_readonly("axisymmetric", &LACSpace::IsAxisymmetric,
                             "Are areas those of the whole circumference about the axis x = 0?")
      .def_property_readonly("slave", &LACSpace::SlaveRegion, "The slave surface (Region).")
      .def(
          "WithComponents",
          [](const LACSpace & self, const Argument<int> & components) {
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
          [](const LACSpace & self, const Argument<long> & number) {
            long macro = number.As("LACSpace.CoreDofs: macro", "the number of a macro-element");
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
} // namespace ngslac
