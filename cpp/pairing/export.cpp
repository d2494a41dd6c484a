// SPDX-License-Identifier: LGPL-2.1-or-later
#include "polygon.hpp"
#include <python_comp.hpp>

namespace ngslac {
using Points = std::vector<std::array<double, 2>>;

static Polygon ToPolygon(const Points & points) {
  Polygon polygon;
  for (auto & p : points)
    polygon.Append(Vec<2>(p[0], p[1]));
  return polygon;
}

static Points ToPoints(const Polygon & polygon) {
  Points points;
  for (int i : Range(polygon.Size()))
    points.push_back({polygon[i](0), polygon[i](1)});
  return points;
}

/// The plane geometry of the pairing, for its tests. Polygons are lists of corners.
void ExportPairing(py::module & m) {
  m.def(
      "PolygonIntersection",
      [](const Points & p, const Points & q, double tolerance) {
        return ToPoints(Intersection(ToPolygon(p), ToPolygon(q), tolerance));
      },
      py::arg("p"), py::arg("q"), py::arg("tolerance"));
  m.def(
      "PolygonOverlap",
      [](const Points & p, const Points & q, double tolerance) {
        return Overlap(ToPolygon(p), ToPolygon(q), tolerance);
      },
      py::arg("p"), py::arg("q"), py::arg("tolerance"));
  m.def(
      "PolygonDifference",
      [](const Points & p, const Points & q, double tolerance) {
        Array<Polygon> parts;
        Subtract(ToPolygon(p), ToPolygon(q), tolerance, parts);
        std::vector<Points> result;
        for (auto & part : parts)
          result.push_back(ToPoints(part));
        return result;
      },
      py::arg("p"), py::arg("q"), py::arg("tolerance"));
}
} // namespace ngslac
