#include "bubble.hpp"
#include "bubblearguments.hpp"
#include "fingerprint.hpp"
#include "split.hpp"

#include <python_comp.hpp>

namespace ngslac {
// NGSolve turns only keyword arguments of basic types into flags.
static void SetSlaveFlag(py::object slave, Flags * flags, py::list /* info */) {
  if (py::isinstance<py::str>(slave)) {
    flags->SetFlag("slave", py::cast<string>(slave));
    return;
  }
  auto region = py::cast<Region>(slave);
  Array<double> numbers;
  for (auto i : Range(region.Mask().Size()))
    if (region.Mask().Test(i))
      numbers.Append(i + 1);
  flags->SetFlag("slave", numbers);
}

static bool HoldsProxy(CoefficientFunction & function) {
  bool holds = false;
  function.TraverseTree(
      [&](CoefficientFunction & part) { holds = holds || dynamic_cast<ProxyFunction *>(&part); });
  return holds;
}

void ExportMeshTools(py::module & m) {
  m.def(
      "SplitSlaveFaces",
      [](shared_ptr<MeshAccess> mesh, const Region & slave, const string & hexes) {
        return SplitSlaveFaces(mesh, slave, hexes);
      },
      py::arg("mesh"), py::arg("slave"), py::arg("hexes") = "pyramids",
      "New mesh with the slave faces split; see ngslac.SplitSlaveFaces");

  m.def("DofFingerprint", &DofFingerprint, py::arg("fes"),
        "A number that differs for spaces that number the dofs of their elements in different "
        "ways.");

  m.def(
      "IsAssembled", [](LinearForm & form) { return form.IsAssembled(); }, py::arg("form"),
      "Was a LinearForm ever assembled?");

  m.def("HoldsProxy", &HoldsProxy, py::arg("function"),
        "Does a function hold a trial or test function, which has no values?");

  auto space = ExportFESpace<BubbleVectorH1FESpace, VectorH1FESpace>(m, "BubbleVectorH1");
  space.def_static("__special_treated_flags__", [] {
    py::dict special = py::type::of<FESpace>().attr("__special_treated_flags__")();
    special["slave"] = py::cpp_function(&SetSlaveFlag);
    return special;
  });
  py::object make = space.attr("__init__");
  space.attr("__init__") = py::cpp_function(
      [make](py::object self, Given<shared_ptr<MeshAccess>> mesh, py::kwargs flags) {
        CheckBubbleArguments(mesh, flags);
        make(self, mesh.value, **flags);
      },
      py::name("__init__"), py::is_method(space), py::arg("mesh"));
}
} // namespace ngslac
