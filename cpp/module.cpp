// SPDX-License-Identifier: LGPL-2.1-or-later
#include <python_comp.hpp>

namespace ngslac {
namespace py = pybind11;

void ExportMesh(py::module & m);
void ExportPairing(py::module & m);
void ExportSpace(py::module & m);
void ExportBubble(py::module & m);
void ExportQueries(py::module & m);
void ExportInner(py::module & m);
void ExportLinear(py::module & m);
void ExportSchur(py::module & m);
void ExportTwoLevel(py::module & m);
void ExportTool(py::module & m);
void ExportContact(py::module & m);
} // namespace ngslac

PYBIND11_MODULE(_ngslac, m) {
  using namespace ngslac;
  py::module_::import("ngsolve"); // its types must be registered first
  ExportMesh(m);
  ExportPairing(m);
  ExportSpace(m);
  ExportBubble(m);
  ExportQueries(m);
  ExportInner(m);
  ExportLinear(m);
  ExportSchur(m);
  ExportTwoLevel(m);
  ExportTool(m);
  ExportContact(m);
}
