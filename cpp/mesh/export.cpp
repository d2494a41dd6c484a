#include "boundaries.hpp"
#include "split.hpp"

namespace ngslac {
void ExportMesh(py::module & m) {
  m.def(
      "RegionWithFaces",
      [](shared_ptr<MeshAccess> mesh, const string & name, py::object given, bool any) {
        return RegionWithFaces(mesh, name, given, any);
      },
      py::arg("mesh"), py::arg("name"), py::arg("given"), py::arg("any") = false,
      "The boundary region that a pattern or a Region stands for; raises where it has no faces. "
      "any: a Region may be of any dimension");
  m.def(
      "SplitSlaveFaces",
      [](shared_ptr<MeshAccess> mesh, const Region & slave, const string & hexes) {
        return SplitSlaveFaces(mesh, slave, hexes);
      },
      py::arg("mesh"), py::arg("slave"), py::arg("hexes") = "pyramids",
      "New mesh with the slave faces split; see ngslac.SplitSlaveFaces");
}
} // namespace ngslac
