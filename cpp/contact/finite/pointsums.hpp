// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include "collectedshapes.hpp"
#include "ray.hpp"

namespace ngslac {
/// A point between two faces.
template <int D>
struct FacingPoint {
  Ray<D> ray;
  double weight;
  Vec<D> force;           // on it
  Vec<D> master_normal;   // where the ray meets the master
  Mat<D - 1, D - 1> bend; // second derivatives of the master along that
};

/// What the points between two faces add to the derivatives of gap, normals and forces, by their
/// scalar functions.
///
/// Each function i enters by its value and its derivatives at the points, and component k of it by
/// factors that are the same for all functions: points are collected, and sums over them are
/// products of matrices.
template <int D>
class PointSums {
  static constexpr int R = D - 1, most_points = CollectedShapes<D>::most_points;
  // Rows of the sums, for each component k: of both normals D rows, of the force the same for all.
  static constexpr int normal = 0, gap = D * D, tilt = gap + D, squeeze = tilt + D * D;
  static constexpr int force = squeeze + D, all = force + 1;

  CollectedShapes<D> slave, master;
  FlatMatrix<> of_slave, of_master; // sums
  bool loaded;
  int n1, n; // functions of the slave, of both
  FlatArray<FacingPoint<D>> points;
  FlatMatrix<> by_value;         // factors, from `gap` on; of the master their negatives
  FlatMatrix<> by_derivative;    // of the slave, up to `squeeze`
  FlatMatrix<> of_master_normal; // by derivatives of the master: of `tilt`
  // Of the points, a row each: how normals turn with the functions of the slave ...
  FlatMatrix<> turns;
  // ... and, R rows each: how points move along the master, times their force
  FlatMatrix<> shifts;
  FlatMatrix<> gradients, shift_of; // of one point
  // Forces on function j by those of the slave, since pressure turns with its normals, and on the
  // master by all, which move along it.
  FlatMatrix<> pressed, moved;

public:
  /// `loaded`: are there forces?
  PointSums(CollectedShapes<D> aslave, CollectedShapes<D> amaster, bool aloaded, LocalHeap & lh);

  void Add(Vec<R> on_slave, const FacingPoint<D> & point);
  /// Adds rows of the derivatives: D of the slave normal, D of the force, gap, squeeze and D of the
  /// master normal; columns by function and component.
  void AddTo(FlatMatrix<> columns);
  /// Adds the derivative of the forces at this pressure.
  void AddTo(double pressure, FlatMatrix<> block);

private:
  void SetPoint(int i);
  void SetFactors(int i, const Mat<D, R> & dual, const Mat<D, R> & turning);
  void SetTurns(int i, const Mat<D, R> & dual);
  void SetShifts(int i, const Mat<D, R> & turning);
  /// Takes in the collected points.
  void Multiply();
};
} // namespace ngslac
