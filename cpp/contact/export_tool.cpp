// SPDX-License-Identifier: LGPL-2.1-or-later
#include "rigidtool.hpp"
#include <python_comp.hpp>

namespace ngslac {
namespace py = pybind11;

namespace {
Vec<3> AsVec3(const std::array<double, 3> & x) {
  return {x[0], x[1], x[2]};
}

/// The rotation row by row, and the shift.
template <int D>
std::vector<double> RowByRow(const Placement<D> & place) {
  std::vector<double> result;
  for (int k : Range(D))
    for (int l : Range(D))
      result.push_back(place.turn(k, l));
  for (int k : Range(D))
    result.push_back(place.shift(k));
  return result;
}
} // namespace

void ExportRigidTool(py::module & m) {
  using Point = std::array<double, 3>;
  using Function = shared_ptr<CoefficientFunction>;
  py::class_<ToolMotion>(m, "ToolMotion")
      .def(py::init([](Function shift, Function angle, Point center, Point axis) {
             for (auto & [function, name] : {pair(shift, "shift"), pair(angle, "angle")})
               if (function)
                 CheckParametric(*function, name);
             return ToolMotion{shift, angle, AsVec3(center), AsVec3(axis)};
           }),
           py::arg("shift"), py::arg("angle"), py::arg("center"), py::arg("axis"));
  py::class_<ToolDrive>(m, "ToolDrive")
      .def(py::init([](Function travel, Function load, int component, Point center, Point axis) {
             if (load)
               CheckParametric(*load, component < 0 ? "moment" : "force");
             return ToolDrive{travel, load, component, AsVec3(center), AsVec3(axis)};
           }),
           py::arg("travel").none(false), py::arg("load"), py::arg("component"), py::arg("center"),
           py::arg("axis"));
  m.def("PlacementOf", [](const std::vector<ToolMotion> & motions, int dim) {
    return dim == 2 ? RowByRow<2>(Follow<2>(motions)) : RowByRow<3>(Follow<3>(motions));
  });
  py::class_<RigidTool, shared_ptr<RigidTool>>(m, "RigidTool")
      .def(py::init([](shared_ptr<ToolShape> shape, std::vector<ToolMotion> motions,
                       std::vector<ToolDrive> drives) {
             return make_shared<RigidTool>(RigidTool{shape, motions, drives});
           }),
           py::arg("shape").none(false), py::arg("motions"), py::arg("drives"));
}
} // namespace ngslac
