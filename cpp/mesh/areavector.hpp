// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <bla.hpp>

namespace ngslac {
using namespace ngbla;

/// Perpendicular to the face, as long as the area element is large.
inline Vec<2> AreaVector(const Mat<2, 1> & dx) {
  return Vec<2>(dx(1, 0), -dx(0, 0));
}
inline Vec<3> AreaVector(const Mat<3, 2> & dx) {
  return Cross(Vec<3>(dx.Col(0)), Vec<3>(dx.Col(1)));
}

/// Factor of the area element.
inline double Measure(const Mat<2, 1> & dx) {
  return L2Norm(dx.Col(0));
}
inline double Measure(const Mat<3, 2> & dx) {
  return L2Norm(AreaVector(dx));
}
} // namespace ngslac
