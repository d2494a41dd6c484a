// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include "contact/faceshapes.hpp"

namespace ngslac {
/// The scalar functions of a face at points that are collected, to be evaluated by one product of
/// matrices.
template <int D>
class CollectedShapes {
  static constexpr int R = D - 1;
  const FaceShapes<D> & shapes;
  int face, npoints = 0;
  FlatMatrix<> basis, functions; // values at all points, then R rows of derivatives for each

public:
  static constexpr int most_points = 16;

  CollectedShapes(const FaceShapes<D> & ashapes, int aface, LocalHeap & lh)
      : shapes(ashapes), face(aface), basis(D * most_points, shapes.Functions(face).Height(), lh),
        functions(D * most_points, Size(), lh) {}

  /// number of functions
  int Size() const { return shapes.Size(face); }
  int NPoints() const { return npoints; }
  bool IsFull() const { return npoints == most_points; }
  void Add(Vec<R> xi) {
    auto derivative = basis.Rows(RowOf(npoints), RowOf(npoints + 1));
    shapes.CalcBasis(face, xi, basis.Row(npoints++), derivative);
  }
  /// To be called before the functions are asked for.
  void Evaluate() {
    auto & e = shapes.Functions(face);
    functions.Rows(0, npoints) = basis.Rows(0, npoints) * e;
    functions.Rows(RowOf(0), RowOf(npoints)) = basis.Rows(RowOf(0), RowOf(npoints)) * e;
  }
  void Clear() { npoints = 0; }

  FlatMatrix<> Values() const { return functions.Rows(0, npoints); }
  FlatMatrix<> Derivatives() const { return functions.Rows(RowOf(0), RowOf(npoints)); }
  const double * Value(int point) const { return &functions(point, 0); }
  /// by reference coordinate c
  const double * Derivative(int point, int c) const { return &functions(RowOf(point) + c, 0); }

private:
  static int RowOf(int point) { return most_points + R * point; }
};
} // namespace ngslac
