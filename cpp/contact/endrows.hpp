// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include "endlaw.hpp"
#include "faceshapes.hpp"

namespace ngslac {
/// Gaps at the points of a macro-element that contact ends in, as linear functions of the dofs.
///
/// They differ from their mean by the share of the end in it, and forces spread in the same way.
template <int D>
class EndRows {
  Matrix<> closing;        // by what each dof (columns) closes the gaps (rows)
  Vector<> start;          // gaps without displacements
  Array<Vec<D>> positions; // where the forces of the points act

public:
  Array<int> dofs; // sorted
  EndPoints points;

  EndRows() = default;
  /// `segments`: of the macro-element; `direction`: of its pressure.
  EndRows(FlatArray<int> segments, const Pairing<D> & pairing, const FaceShapes<D> & slave,
          const FaceShapes<D> & master, const Surface<D> & surface, const Vec<D> & direction);
  /// Brings all nearer to their mean; areas get this sum.
  void Blend(double share, double area);
  /// Gaps are counted from there.
  void CountFrom(FlatVector<> x);
  void Look(FlatVector<> x, double clearance, double given);
  size_t PositionOf(int dof) const {
    return std::lower_bound(dofs.begin(), dofs.end(), dof) - dofs.begin();
  }

  /// Derivative of the forces by the pressure: integral over what is pressed.
  Vector<> Pressed(const EndPressure & pressure) const;
  Vector<> Forces(const EndPressure & pressure) const;
  /// Derivative of the forces by the dofs, at the same base pressure.
  Matrix<> Stiffness(const EndPressure & pressure) const;
  /// Integral of position times pressure.
  Vec<D> MomentOf(const EndPressure & pressure) const;

private:
  void AddShapes(const FaceShapes<D> & shapes, int face, Vec<D - 1> xi, double sign,
                 const Vec<D> & direction, int point, LocalHeap & lh);
};
} // namespace ngslac
