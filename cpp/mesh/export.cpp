#include "split.hpp"

#include <python_comp.hpp>

namespace ngslac {
void ExportMesh(py::module & m) {
  m.def(
      "SplitSlaveFaces",
      [](shared_ptr<MeshAccess> mesh, const Region & slave, const string & hexes) {
        return SplitSlaveFaces(mesh, slave, hexes);
      },
      py::arg("mesh"), py::arg("slave"), py::arg("hexes") = "pyramids",
      "New mesh with the slave faces split; see ngslac.SplitSlaveFaces");
}
} // namespace ngslac
