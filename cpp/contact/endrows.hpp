// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include "endlaw.hpp"
#include "faceshapes.hpp"
#include "linear/blocksum.hpp"

namespace ngslac {
template <int D>
Array<int> DofsOf(FlatArray<int> segments, const Pairing<D> & pairing, const FaceShapes<D> & slave,
                  const FaceShapes<D> & master) {
  Array<int> dofs;
  for (int s : segments) {
    dofs += slave.Dofs(pairing.segments[s].slave);
    dofs += master.Dofs(pairing.segments[s].master);
  }
  SortUnique(dofs);
  return dofs;
}

/// Gaps at the points of a macro-element inside of which contact ends, as linear functions of the
/// dofs.
///
/// They differ from their mean by the share of the end in it, and forces spread in the same way.
template <int D>
class EndRows {
  Matrix<> closing;        // how much each dof (columns) closes the gaps (rows)
  Vector<> start;          // gaps without displacements
  Array<Vec<D>> positions; // where the forces of the points act

public:
  Array<int> dofs; // sorted
  EndPoints points;

  EndRows() = default;
  /// `segments`: of the macro-element; `direction`: of its pressure.
  EndRows(FlatArray<int> segments, const Pairing<D> & pairing, const FaceShapes<D> & slave,
          const FaceShapes<D> & master, const Surface<D> & surface, const Vec<D> & direction)
      : dofs(DofsOf(segments, pairing, slave, master)) {
    size_t n = 0;
    for (int s : segments)
      n += pairing.Points(s).Size();
    closing.SetSize(n, dofs.Size()), start.SetSize(n);
    closing = 0.0;
    LocalHeap lh(1000 * 1000, "ngslac-ends");
    for (int s : segments)
      for (auto & p : pairing.points.Range(pairing.Points(s))) {
        int k = points.area.Size();
        auto & segment = pairing.segments[s];
        AddShapes(slave, segment.slave, p.slave, 1, direction, k, lh);
        AddShapes(master, segment.master, p.master, -1, direction, k, lh);
        start(k) = p.gap * InnerProduct(p.normal, direction);
        points.area.Append(p.weight);
        positions.Append(surface.Origin() + surface.Point(segment.slave, p.slave));
      }
    points.gap.SetSize(n);
  }

  /// Brings all nearer to their mean; areas get this sum.
  void Blend(double share, double area) {
    Vector<> mean(dofs.Size());
    Vec<D> center = 0.0;
    double gap = 0, sum = 0;
    mean = 0.0;
    for (double w : points.area)
      sum += w;
    for (size_t k : Range(points.area)) {
      double & w = points.area[k];
      w *= area / sum;
      gap += w * start(k), center += w * positions[k];
      mean += w * closing.Row(k);
    }
    mean *= 1 / area;
    for (size_t k : Range(points.area)) {
      start(k) = share * start(k) + (1 - share) * gap / area;
      positions[k] = share * positions[k] + (1 - share) / area * center;
      for (size_t j : Range(dofs))
        closing(k, j) = share * closing(k, j) + (1 - share) * mean(j);
    }
  }

  /// Gaps are counted from there.
  void CountFrom(FlatVector<> x) { start += closing * Vector<>(x(dofs)); }
  void Look(FlatVector<> x, double clearance, double pressure) {
    points.pressure = pressure;
    for (size_t k : Range(points.gap)) {
      points.gap[k] = start(k) + clearance;
      for (size_t j : Range(dofs))
        points.gap[k] -= closing(k, j) * x(dofs[j]);
    }
  }

  size_t PositionOf(int dof) const {
    return std::lower_bound(dofs.begin(), dofs.end(), dof) - dofs.begin();
  }

  /// Derivative of the forces by the pressure: integral over what is pressed.
  Vector<> Pressed(const EndPressure & pressure) const {
    Vector<> sum(dofs.Size());
    sum = 0.0;
    for (size_t k : Range(points.area))
      if (pressure.Presses(points.gap[k]))
        sum += points.area[k] * closing.Row(k);
    return sum;
  }

  Vector<> Forces(const EndPressure & pressure) const {
    Vector<> sum(dofs.Size());
    sum = 0.0;
    for (size_t k : Range(points.area))
      sum += points.area[k] * pressure.At(points.gap[k]) * closing.Row(k);
    return sum;
  }

  /// Derivative of the forces by the dofs, at the same base pressure.
  Matrix<> Stiffness(const EndPressure & pressure) const {
    Matrix<> sum(dofs.Size());
    sum = 0.0;
    for (size_t k : Range(points.area))
      if (pressure.Presses(points.gap[k]))
        sum += pressure.c * points.area[k] * closing.Row(k) * Trans(closing.Row(k));
    return sum;
  }

  /// Integral of position times pressure.
  Vec<D> MomentOf(const EndPressure & pressure) const {
    Vec<D> sum = 0.0;
    for (size_t k : Range(points.area))
      sum += points.area[k] * pressure.At(points.gap[k]) * positions[k];
    return sum;
  }

private:
  void AddShapes(const FaceShapes<D> & shapes, int face, Vec<D - 1> xi, double sign,
                 const Vec<D> & direction, int point, LocalHeap & lh) {
    HeapReset hr(lh);
    FlatVector<> value(shapes.Size(face), lh);
    value = 0.0;
    shapes.AddValues(face, xi, sign, value, lh);
    auto own = shapes.Dofs(face);
    for (int j : Range(own)) {
      double & sum = closing(point, PositionOf(own[j]));
      if (shapes.IsPlain(face))
        sum += direction(j % D) * value(j / D);
      else
        for (int i : Range(value))
          for (int k : Range(D))
            sum += direction(k) * value(i) * shapes.Conversion(face)(D * i + k, j);
    }
  }
};
} // namespace ngslac
