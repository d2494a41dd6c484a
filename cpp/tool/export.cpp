// SPDX-License-Identifier: LGPL-2.1-or-later
#include "expression.hpp"
#include "facets.hpp"
#include "motion.hpp"
#include "shapes.hpp"
#include "surface/surface.hpp"
#include <python_comp.hpp>

namespace ngslac {
namespace py = pybind11;

namespace {
using Numbers = std::vector<double>;
using Shape = shared_ptr<ToolShape>;

template <int D>
Vec<D> AsVec(const Numbers & x) {
  Vec<D> result;
  for (int k : Range(D))
    result(k) = x.at(k);
  return result;
}

template <int D>
SomeTool<D> Of(const Shape & shape) {
  return dynamic_pointer_cast<SignedDistance<D>>(shape);
}

/// Reference coordinates of the corners of the parts of a face.
Array<Vec<1>> Parts(const Surface<2> &, size_t, int divisions) {
  Array<Vec<1>> parts;
  for (int i : Range(divisions))
    for (int j : {i, i + 1})
      parts.Append(Vec<1>(double(j) / divisions));
  return parts;
}

Array<Vec<2>> Parts(const Surface<3> & surface, size_t face, int divisions) {
  Array<Vec<2>> parts;
  bool quad = surface.Type(face) == ET_QUAD;
  auto add = [&](int i, int j) {
    parts.Append(Vec<2>(double(i) / divisions, double(j) / divisions));
  };
  for (int i : Range(divisions))
    for (int j : Range(quad ? divisions : divisions - i)) {
      add(i, j), add(i + 1, j), add(i, j + 1);
      if (quad || i + j + 1 < divisions)
        add(i + 1, j), add(i + 1, j + 1), add(i, j + 1);
    }
  return parts;
}

/// Corners of plane facets that the faces of a surface are divided into, D for each facet, with
/// normals out of the body. Triangles and quadrilaterals are divided along each side.
template <int D>
Array<Vec<D>> FacetCorners(const Surface<D> & surface, int divisions) {
  Array<Vec<D>> corners;
  for (size_t face : Range(surface.Size())) {
    auto parts = Parts(surface, face, divisions);
    for (size_t i = 0; i < parts.Size(); i += D) {
      Vec<D> x;
      Mat<D, D - 1> dx;
      surface.Evaluate(face, parts[i], x, dx);
      bool outward = InnerProduct(surface.Normal(face, dx), AreaVector(dx)) > 0;
      for (int k : Range(D))
        corners.Append(surface.Origin() + surface.Point(face, parts[i + k]));
      if (!outward)
        std::swap(corners[corners.Size() - 2], corners.Last());
    }
  }
  return corners;
}

/// f.template operator()<D>() for the dimension.
template <typename F>
Shape InDimension(int dim, F f) {
  return dim == 2 ? f.template operator()<2>() : f.template operator()<3>();
}

template <int D>
Shape MakeFacets(const Numbers & points, const std::vector<int> & corners, bool closed) {
  FacetList<D> list;
  for (size_t i = 0; i < points.size(); i += D)
    list.points.Append(AsVec<D>(Numbers(points.begin() + i, points.begin() + i + D)));
  for (size_t i = 0; i < corners.size(); i += D) {
    std::array<int, D> facet;
    std::copy(corners.begin() + i, corners.begin() + i + D, facet.begin());
    list.corners.Append(facet);
  }
  return make_shared<Facets<D>>(std::move(list), closed);
}

/// Values (n), gradients (n, d) and Hessians (n, d, d) at points (n, d), as flat numbers.
template <int D>
std::tuple<Numbers, Numbers, Numbers> Evaluate(const SignedDistance<D> & tool,
                                               const Numbers & points) {
  std::tuple<Numbers, Numbers, Numbers> result;
  auto & [values, gradients, hessians] = result;
  for (size_t i = 0; i < points.size(); i += D) {
    Vec<D> x = AsVec<D>(Numbers(points.begin() + i, points.begin() + i + D));
    auto near = tool.At(x);
    auto second = tool.Hessian(x);
    values.push_back(near.distance);
    for (int k : Range(D)) {
      gradients.push_back(near.gradient(k));
      for (int l : Range(D))
        hessians.push_back(second(k, l));
    }
  }
  return result;
}
template <int D>
Numbers FacetNumbers(const Region & region, int divisions) {
  Numbers result;
  for (auto & x : FacetCorners<D>(Surface<D>(region, nullptr, 1), divisions))
    result.insert(result.end(), x.Data(), x.Data() + D);
  return result;
}

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

void ExportMotion(py::module & m) {
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
} // namespace

void ExportTool(py::module & m) {
  m.def("FacetCorners", [](const Region & region, int divisions) {
    return region.Mesh()->GetDimension() == 2 ? FacetNumbers<2>(region, divisions)
                                              : FacetNumbers<3>(region, divisions);
  });
  py::class_<ToolShape, Shape>(m, "ToolShape")
      .def_property_readonly("dim", &ToolShape::Dim)
      .def("Evaluate",
           [](const Shape & self, const Numbers & points) {
             return self->Dim() == 2 ? Evaluate(*Of<2>(self), points)
                                     : Evaluate(*Of<3>(self), points);
           })
      .def_static("HalfSpace",
                  [](const Numbers & point, const Numbers & normal) {
                    return InDimension(point.size(), [&]<int D>() -> Shape {
                      return make_shared<HalfSpace<D>>(AsVec<D>(point), AsVec<D>(normal));
                    });
                  })
      .def_static("Ball",
                  [](const Numbers & center, double radius, const Numbers & axis) {
                    return InDimension(center.size(), [&]<int D>() -> Shape {
                      return make_shared<Ball<D>>(AsVec<D>(center), radius, AsVec<D>(axis));
                    });
                  })
      .def_static("Wedge", [](double angle) -> Shape { return make_shared<Wedge>(angle); })
      .def_static("Revolution",
                  [](const Shape & profile, const Numbers & point, const Numbers & axis) -> Shape {
                    return make_shared<Revolution>(Of<2>(profile), AsVec<3>(point), AsVec<3>(axis));
                  })
      .def_static(
          "Facets",
          [](const Numbers & points, const std::vector<int> & corners, int dim, bool closed) {
            return InDimension(
                dim, [&]<int D>() -> Shape { return MakeFacets<D>(points, corners, closed); });
          })
      .def_static("Expression",
                  [](shared_ptr<CoefficientFunction> function, int dim) {
                    return InDimension(dim, [&]<int D>() -> Shape {
                      return make_shared<Expression<D>>(function);
                    });
                  })
      .def("Grown",
           [](const Shape & self, double by) {
             return InDimension(self->Dim(), [&]<int D>() -> Shape {
               return make_shared<Grown<D>>(Of<D>(self), by);
             });
           })
      .def("Complement",
           [](const Shape & self) {
             return InDimension(self->Dim(), [&]<int D>() -> Shape {
               return make_shared<Complement<D>>(Of<D>(self));
             });
           })
      .def("Together", [](const Shape & self, const Shape & other) {
        return InDimension(self->Dim(), [&]<int D>() -> Shape {
          return make_shared<Together<D>>(Of<D>(self), Of<D>(other));
        });
      });
  ExportMotion(m);
}
} // namespace ngslac
