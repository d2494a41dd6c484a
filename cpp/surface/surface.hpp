// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include "mesh/areavector.hpp"
#include "mesh/faces.hpp"
#include <gprim/geom3d.hpp>
#include <gprim/geomobjects.hpp>

namespace ngslac {
using namespace ngcomp;

/// The faces of a boundary region as Bernstein polynomials of the reference coordinates.
///
/// The control net bounds a face, so that boxes for the search are safe for curved faces too, and
/// evaluating a face needs neither the mesh nor a heap. Knows no finite elements: a deformed
/// configuration is the reference one plus a displacement given as a CoefficientFunction.
template <int D>
class Surface {
public:
  /// `displacement` may be null (reference configuration); faces are polynomials of degree `order`
  /// at least.
  Surface(const Region & region, shared_ptr<CoefficientFunction> displacement, int order);

  size_t Size() const { return faces.Size(); }
  /// Number of faces of the mesh; the faces after these are images.
  size_t BaseSize() const { return base; }
  /// Appends the faces of the mesh once more, moved.
  void Repeat(const Vec<D> & shift);
  /// Areas are from now on those that faces sweep as they turn about the axis x = 0.
  void Turn() { turns = true; }
  /// How far a point turns, a factor of areas; 1 for what is no body of revolution.
  double Way(const Vec<D> & x) const { return turns ? 2 * M_PI * fabs(origin(0) + x(0)) : 1; }
  /// the faces of the mesh that these are
  const Faces & MeshFaces() const { return faces; }
  /// Positions count from there: near 0 unless the mesh is far away, where displacements that are
  /// small would be lost among the digits of its coordinates. The same for all surfaces of a mesh.
  Vec<D> Origin() const { return origin; }
  /// number of the boundary element of the mesh
  int Element(size_t face) const { return faces[face]; }
  ELEMENT_TYPE Type(size_t face) const { return types[face]; }
  int Degree() const { return degree; }
  /// control points of a face, which may be moved
  FlatArray<Vec<D>> Control(size_t face) const {
    return control.Range(first[face], first[face + 1]);
  }
  /// Are all control points those of another surface of the same region?
  bool HasShapeOf(const Surface & other) const {
    return control.Size() == other.control.Size() &&
           std::equal(control.begin(), control.end(), other.control.begin(),
                      [](auto & a, auto & b) { return L2Norm2(a - b) == 0; });
  }
  /// Throws where control points are NaN or infinite.
  void CheckFinite() const;
  /// reference coordinates of the control points
  FlatArray<Vec<D - 1>> Sites(size_t face) const {
    return types[face] == ET_QUAD ? quad_sites : simplex_sites;
  }
  /// largest distance of two corners, the local size of everything that needs a tolerance
  double Diameter(size_t face) const;
  /// The precision of positions on a face: far from the origin of the coordinates smaller distances
  /// cannot be resolved.
  double Rounding(size_t face) const;
  /// farthest that the face is from the (bi)linear one with its corners, relative to the diameter
  double Bulge(size_t face) const;
  /// Straight, and in 3D plane: the normal does not change.
  bool IsFlat(size_t face) const;
  netgen::Box<D> Bounds(size_t face) const;
  Vec<D> Point(size_t face, Vec<D - 1> xi) const;
  /// point and derivative with respect to the reference coordinates
  void Evaluate(size_t face, Vec<D - 1> xi, Vec<D> & x, Mat<D, D - 1> & dx) const;
  /// Factor of the area element, for a point and derivative that Evaluate gave.
  double AreaElement(const Vec<D> & x, const Mat<D, D - 1> & dx) const {
    return Measure(dx) * Way(x);
  }
  /// second derivatives of the component of the point in a direction
  Mat<D - 1, D - 1> Hessian(size_t face, Vec<D - 1> xi, Vec<D> direction) const;
  /// unit normal out of the body, for a derivative that Evaluate gave
  Vec<D> Normal(size_t face, const Mat<D, D - 1> & dx) const;

private:
  void AddFace(size_t face, MeshAccess & ma, CoefficientFunction * displacement, LocalHeap & lh);

  Vec<D> origin;
  bool turns = false; // about the axis of an axisymmetric problem
  Faces faces;
  size_t base;
  Array<ELEMENT_TYPE> types;
  Array<signed char> orientation; // +1: the normal of the reference orientation is the outward one
  int degree;
  Array<size_t> first;                         // control point of each face
  Array<Vec<D - 1>> simplex_sites, quad_sites; // of the control points
  Array<Vec<D>> control;
};

/// Reference coordinates of the corners of a face.
template <int R>
FlatArray<Vec<R>> Corners(ELEMENT_TYPE type);

/// Reference coordinates as NGSolve's integration points have them, and back.
template <int R>
IntegrationPoint ToIntegrationPoint(Vec<R> xi) {
  return IntegrationPoint(xi(0), R == 2 ? xi(R - 1) : 0, 0, 0);
}
template <int R>
Vec<R> ReferencePoint(const IntegrationPoint & ip) {
  Vec<R> xi;
  for (int k : Range(R))
    xi(k) = ip(k);
  return xi;
}

} // namespace ngslac
