// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <fem.hpp>

namespace ngslac {
using namespace ngfem;

/// Polynomials on a reference face (segment, triangle, square) by their control points.
///
/// Triangles: row after row of equal power of the second coordinate. Squares: tensor product.
int NControlPoints(ELEMENT_TYPE type, int degree);

/// Reference coordinates of the control points: the values of a linear function there are its
/// control values.
template <int R>
Array<Vec<R>> ControlSites(ELEMENT_TYPE type, int degree);

/// Well placed interpolation points, as many as control points.
template <int R>
Array<Vec<R>> InterpolationPoints(ELEMENT_TYPE type, int degree);

/// The matrix that turns values at the interpolation points into control points.
template <int R>
Matrix<> ControlFromValues(ELEMENT_TYPE type, int degree);

/// The polynomials that belong to the control points.
template <int R>
void CalcBernstein(ELEMENT_TYPE type, int degree, Vec<R> xi, FlatVector<> basis);

/// The same with their derivatives (a row each).
template <int R>
void CalcBernstein(ELEMENT_TYPE type, int degree, Vec<R> xi, FlatVector<> basis,
                   FlatMatrixFixWidth<R> derivative);

/// Value and derivative, by de Casteljau's algorithm.
template <int D>
void EvaluateBernstein(ELEMENT_TYPE type, int degree, FlatArray<Vec<D>> control, Vec<D - 1> xi,
                       Vec<D> & x, Mat<D, D - 1> & dx);

/// Second derivatives of the polynomial with these control values.
template <int R>
Mat<R, R> BernsteinHessian(ELEMENT_TYPE type, int degree, FlatVector<> control, Vec<R> xi);
} // namespace ngslac
