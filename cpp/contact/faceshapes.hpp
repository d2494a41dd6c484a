#pragma once
#include "jump.hpp"

namespace ngslac {
/// The trace of a displacement on the faces of a surface, by the control points of the faces.
///
/// Turns a vector of dofs into a deformed surface, and gives shape functions with their derivatives
/// along the face without another evaluation of finite elements.
template <int D>
class FaceShapes {
public:
  /// `reference`: the surface without displacement, of the displacement's order at least
  FaceShapes(const ProxyInfo & u, const Surface<D> & reference);

  /// numbers in a vector on the product space
  FlatArray<int> Dofs(size_t face) const { return dofs[face]; }
  /// The surface displaced by the entries of a vector.
  Surface<D> Displaced(const Surface<D> & reference, FlatVector<> x) const;

  /// Values of all shape functions of a face at a point, a column each.
  struct Values {
    FlatMatrix<> value;
    FlatMatrix<> derivative[D - 1];
    Values(int n, LocalHeap & lh) : value(D, n, lh) {
      for (auto & d : derivative)
        d.AssignMemory(D, n, lh);
    }
  };
  Values Calc(const Surface<D> & surface, size_t face, Vec<D - 1> xi, LocalHeap & lh) const;

private:
  Array<Array<int>> dofs;       // of each face
  Array<Matrix<>> coefficients; // of each face: control points (D rows each) of each dof
};
} // namespace ngslac
