// SPDX-License-Identifier: LGPL-2.1-or-later
#include "bubble.hpp"
#include "given.hpp"
#include "mesh/boundaries.hpp"
#include "mesh/names.hpp"
#include <python_comp.hpp>

namespace ngslac {
namespace {
string Named(const string & name) {
  return "BubbleVectorH1: " + name;
}

void CheckOrder(py::handle order) {
  constexpr long most = 50; // far above what anyone can solve
  string text = Named("order") + " = " + Given<int>::Text(order) +
                " must be an integer from 1 to " + ToString(most);
  if (!PyLong_Check(order.ptr()) || PyBool_Check(order.ptr()))
    throw py::type_error(text);
  int overflow = 0;
  long number = PyLong_AsLongAndOverflow(order.ptr(), &overflow);
  if (overflow || number < 1 || number > most)
    throw py::value_error(text);
}

bool HoldsIntegers(py::handle value) {
  if (!py::isinstance<py::list>(value) && !py::isinstance<py::tuple>(value))
    return false;
  for (auto item : value)
    if (!PyLong_Check(item.ptr()) || PyBool_Check(item.ptr()))
      return false;
  return true;
}

VorB KindOf(const string & flag) {
  return flag.find("bbbnd") != string::npos  ? BBBND
         : flag.find("bbnd") != string::npos ? BBND
                                             : BND;
}

/// The flags of BubbleVectorH1, where names of boundaries stand for themselves. Throws for those
/// that NGSolve falls over, or takes without a word.
py::dict CheckedBubbleArguments(const Given<shared_ptr<MeshAccess>> & mesh,
                                const py::kwargs & flags) {
  auto on = mesh.As(Named("mesh"), "an ngsolve.Mesh");
  py::dict checked;
  for (auto [key, value] : flags) {
    auto name = py::cast<string>(key);
    if (name == "order")
      CheckOrder(value);
    else if (name == "slave")
      RegionWithFaces(on, Named(name), value);
    else if (name.rfind("dirichlet", 0) == 0 && name.find("bbnd") == string::npos)
      if (!value.is_none() && !HoldsIntegers(value)) // numbers of boundaries: NGSolve's own flags
        BoundaryRegion(on, Named(name), value);
    bool pattern = name == "slave" || name.rfind("dirichlet", 0) == 0;
    checked[key] = pattern && py::isinstance<py::str>(value)
                       ? py::cast(LiteralNames(*on, KindOf(name), py::cast<string>(value)))
                       : py::reinterpret_borrow<py::object>(value);
  }
  return checked;
}

/// NGSolve turns only keyword arguments of basic types into flags.
void SetSlaveFlag(py::object slave, Flags * flags, py::list /* info */) {
  if (py::isinstance<py::str>(slave)) {
    flags->SetFlag("slave", py::cast<string>(slave));
    return;
  }
  flags->SetFlag("slave", NumbersOf(py::cast<Region>(slave)));
}
} // namespace

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
