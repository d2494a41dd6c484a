#pragma once
#include <comp.hpp>
#include <gprim/geom3d.hpp>
#include <gprim/geomobjects.hpp>

namespace ngslac {
using namespace ngcomp;

/// The faces of a boundary region as Bernstein polynomials of the reference coordinates.
///
/// The control polygon bounds a face, so that boxes for the search are safe for curved faces too,
/// and evaluating a face needs neither the mesh nor a heap. Knows no finite elements: a deformed
/// configuration is the reference one plus a displacement given as a CoefficientFunction.
template <int D>
class Surface {
public:
  /// `displacement` may be null (reference configuration); `order` is its polynomial order.
  Surface(const Region & region, shared_ptr<CoefficientFunction> displacement, int order);

  size_t Size() const { return elements.Size(); }
  /// number of the boundary element of the mesh
  int Element(size_t face) const { return elements[face]; }
  int Degree() const { return degree; }
  /// distance of the end points, the local size of everything that needs a tolerance
  double Diameter(size_t face) const;
  netgen::Box<D> Bounds(size_t face) const;
  Vec<D> Point(size_t face, Vec<D - 1> xi) const;
  /// point and derivative with respect to the reference coordinates
  void Evaluate(size_t face, Vec<D - 1> xi, Vec<D> & x, Mat<D, D - 1> & dx) const;
  /// unit normal out of the body, for a derivative that Evaluate gave
  Vec<D> Normal(size_t face, const Mat<D, D - 1> & dx) const;

private:
  FlatArray<Vec<D>> Control(size_t face) const {
    return control.Range(face * (degree + 1), (face + 1) * (degree + 1));
  }

  Array<int> elements;
  Array<signed char> orientation; // +1: the rotated derivative points out of the body
  int degree;
  Array<Vec<D>> control;
};
} // namespace ngslac
