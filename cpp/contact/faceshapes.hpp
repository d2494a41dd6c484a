// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include "jump.hpp"
#include "linear/scatter.hpp"

namespace ngslac {
/// The trace of a displacement on the faces of a surface, by polynomials of reference coordinates.
///
/// Turns a vector of dofs into a deformed surface, and gives shape functions with their derivatives
/// along the face without another evaluation of finite elements. Where all components have the same
/// scalar functions a face keeps only those, and its dof number  D i + k  is component k of
/// function i. Other faces keep Bernstein polynomials, and a matrix from them to the dofs. A scalar
/// field counts as such a displacement: all D components of function i have the same dof.
template <int D>
class FaceShapes {
public:
  /// `degree`: the highest of the displacement on the faces; `wanted`: null for all
  FaceShapes(const ProxyInfo & u, const Surface<D> & surface, int degree,
             const BitArray * wanted = nullptr);

  /// numbers in a vector on the product space
  FlatArray<int> Dofs(size_t face) const { return dofs[face]; }
  /// number of scalar functions
  int Size(size_t face) const { return functions[face].Width(); }
  /// Is it zero there, whatever the dofs are?
  bool HasNone(size_t face) const { return dofs[face].Size() == 0; }
  /// Is dof  D i + k  component k of function i?
  bool IsPlain(size_t face) const { return conversion[face].Height() == 0; }
  /// From function i times unit vector k (row D i + k) to the dofs of a face that is not plain.
  const Matrix<> & Conversion(size_t face) const { return conversion[face]; }
  /// Appends the first faces once more, which have the same dofs.
  void Repeat(size_t first);
  /// The surface, of this degree at least, displaced by the entries of a vector.
  Surface<D> Displaced(const Surface<D> & reference, FlatVector<> x) const;

  /// Adds the displacement by the entries of a vector to the control points of a face.
  void AddDisplacement(size_t face, FlatVector<> x, FlatArray<Vec<D>> control) const;

  /// Values of the scalar functions of a face at a point, and a row of derivatives per direction.
  struct Values {
    FlatVector<> value;
    FlatMatrix<> derivative;
  };
  Values Calc(size_t face, Vec<D - 1> xi, LocalHeap & lh) const;
  /// The same of the Bernstein polynomials, which are as many as rows of Functions.
  void CalcBasis(size_t face, Vec<D - 1> xi, FlatVector<> value, FlatMatrix<> derivative) const;
  void CalcBasis(size_t face, Vec<D - 1> xi, FlatVector<> value) const;
  /// The scalar functions of a face, a column each, by Bernstein polynomials.
  const Matrix<> & Functions(size_t face) const { return functions[face]; }
  /// Adds a factor times the values of the scalar functions.
  void AddValues(size_t face, Vec<D - 1> xi, double factor, FlatVector<> sum, LocalHeap & lh) const;
  /// Adds forces on the Bernstein polynomials of a face to those on its dofs.
  void AddForces(size_t face, FlatMatrixFixWidth<D> forces, Scatter & y, LocalHeap & lh) const;

private:
  void SetFace(size_t face, FlatMatrix<> values, FlatArray<int> numbers, const Matrix<> & control);

  int degree;
  Array<ELEMENT_TYPE> types;
  Array<Array<int>> dofs;     // of each face
  Array<Matrix<>> functions;  // of each face: control points of each scalar function
  Array<Matrix<>> conversion; // empty for plain faces
};

/// A displacement on the selected faces of a surface.
template <int D>
class FaceDisplacement {
  FaceShapes<D> shapes;
  Array<Array<Vec<D>>> control;

public:
  FaceDisplacement(const ProxyInfo & u, const Surface<D> & surface, const BitArray & wanted,
                   FlatVector<> x);
  Vec<D> At(size_t face, Vec<D - 1> xi) const;
};
} // namespace ngslac
