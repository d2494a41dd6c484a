// SPDX-License-Identifier: LGPL-2.1-or-later
#include "facetsof.hpp"

namespace ngslac {
namespace {
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
} // namespace

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

template Array<Vec<2>> FacetCorners(const Surface<2> &, int);
template Array<Vec<3>> FacetCorners(const Surface<3> &, int);
} // namespace ngslac
