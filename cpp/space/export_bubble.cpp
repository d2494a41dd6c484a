// SPDX-License-Identifier: LGPL-2.1-or-later
#include "bubble.hpp"
#include "bubblearguments.hpp"
#include "mesh/boundaries.hpp"

#include <python_comp.hpp>

namespace ngslac {
// NGSolve turns only keyword arguments of basic types into flags.
static void SetSlaveFlag(py::object slave, Flags * flags, py::list /* info */) {
  if (py::isinstance<py::str>(slave)) {
    flags->SetFlag("slave", py::cast<string>(slave));
    return;
  }
  flags->SetFlag("slave", NumbersOf(py::cast<Region>(slave)));
}

void ExportBubble(py::module & m) {
  auto space = ExportFESpace<BubbleVectorH1FESpace, VectorH1FESpace>(m, "BubbleVectorH1");
  space.def_static("__special_treated_flags__", [] {
    py::dict special = py::type::of<FESpace>().attr("__special_treated_flags__")();
    special["slave"] = py::cpp_function(&SetSlaveFlag);
    return special;
  });
  space.def("__repr__", [](const BubbleVectorH1FESpace & self) {
    return "<BubbleVectorH1: " + ToString(self.GetNDof()) + " dofs, with bubbles on " +
           BoundaryNames(self.SlaveRegion()) + ">";
  });
  py::object make = space.attr("__init__");
  space.attr("__init__") = py::cpp_function(
      [make](py::object self, Given<shared_ptr<MeshAccess>> mesh, py::kwargs flags) {
        make(self, mesh.value, **CheckedBubbleArguments(mesh, flags));
      },
      py::name("__init__"), py::is_method(space), py::arg("mesh"));
}
} // namespace ngslac
