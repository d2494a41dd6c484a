// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include "collectedshapes.hpp"
#include "linear/addscaled.hpp"
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
  PointSums(CollectedShapes<D> aslave, CollectedShapes<D> amaster, bool aloaded, LocalHeap & lh)
      : slave(aslave), master(amaster), of_slave(all, slave.Size(), lh),
        of_master(all, master.Size(), lh), loaded(aloaded), n1(slave.Size()), n(n1 + master.Size()),
        points(most_points, lh), by_value(most_points, all - gap, lh),
        by_derivative(R * most_points, squeeze, lh), of_master_normal(R * most_points, D * D, lh),
        turns(0, 0, lh), shifts(0, 0, lh), gradients(D, n1, lh), shift_of(D, n, lh),
        pressed(0, 0, lh), moved(0, 0, lh) {
    of_slave = 0.0, of_master = 0.0;
    if (!loaded)
      return;
    turns.AssignMemory(most_points, D * D * n1, lh);
    shifts.AssignMemory(R * most_points, D * D * n, lh);
    pressed.AssignMemory(n, D * D * n1, lh);
    moved.AssignMemory(n - n1, D * D * n, lh);
    pressed = 0.0, moved = 0.0;
  }

  void Add(Vec<R> on_slave, const FacingPoint<D> & point) {
    points[slave.NPoints()] = point;
    slave.Add(on_slave);
    master.Add(point.ray.eta);
    if (slave.IsFull())
      Multiply();
  }

  /// Adds rows of the derivatives: D of the slave normal, D of the force, gap, squeeze and D of the
  /// master normal; columns by function and component.
  void AddTo(FlatMatrix<> columns) {
    Multiply();
    for (int i : Range(n)) {
      auto & sums = i < n1 ? of_slave : of_master;
      int own = i < n1 ? i : i - n1;
      for (int k : Range(D)) {
        auto column = columns.Col(D * i + k);
        column(D + k) += sums(force, own);
        column(2 * D) += sums(gap + k, own);
        column(2 * D + 1) += sums(squeeze + k, own);
        for (int l : Range(D)) {
          column(l) += sums(normal + D * l + k, own);
          column(2 * D + 2 + l) += sums(tilt + D * l + k, own);
        }
      }
    }
  }

  /// Adds the derivative of the forces at this pressure.
  void AddTo(double pressure, FlatMatrix<> block) {
    Multiply();
    for (int k : Range(D))
      for (int l : Range(D)) {
        int turn = (k * D + l) * n1, move = (l * D + k) * n;
        for (int j : Range(n))
          for (int i : Range(n1))
            block(D * j + l, D * i + k) += pressure * pressed(j, turn + i);
        for (int j : Range(n - n1))
          for (int i : Range(n))
            block(D * (n1 + j) + l, D * i + k) += moved(j, move + i);
      }
  }

private:
  void SetPoint(int i) {
    auto & ray = points[i].ray;
    Mat<D, R> dual = DualBasis<D>(ray.dx);
    Mat<D, R> turning; // of (eta, gap), along the normal, by derivatives of the slave's functions
    for (int a : Range(D)) {
      Vec<D> by_turn = ray.gap * ray.response.Row(a);
      if (a == R)
        by_turn += ray.miss;
      turning.Row(a) = Trans(dual) * by_turn;
    }
    SetFactors(i, dual, turning);
    if (!loaded)
      return;
    SetTurns(i, dual);
    SetShifts(i, turning);
  }

  void SetFactors(int i, const Mat<D, R> & dual, const Mat<D, R> & turning) {
    auto & [ray, w, pushed, master_normal, bend] = points[i];
    auto & r = ray.response;
    Mat<D, R> master_dual = DualBasis<D>(ray.dy);
    Mat<D, R> by_eta = master_dual * bend; // along the master its normal turns with the curvature
    Mat<D, D> moves = by_eta * r.Rows(0, R);
    Mat<D, R> turns_too = by_eta * turning.Rows(0, R);
    auto value = by_value.Row(i);
    for (int k : Range(D)) {
      value(k) = w * r(R, k);
      value(squeeze - gap + k) = w * ray.normal(k);
      for (int l : Range(D))
        value(tilt - gap + D * l + k) = -w * moves(l, k);
    }
    value(force - gap) = w;
    for (int c : Range(R)) {
      auto derivative = by_derivative.Row(R * i + c), of_normal = of_master_normal.Row(R * i + c);
      for (int k : Range(D)) {
        double along = -w * ray.normal(k), along_master = -w * master_normal(k);
        derivative(gap + k) = along * turning(R, c);
        for (int l : Range(D)) {
          derivative(normal + D * l + k) = along * dual(l, c);
          derivative(tilt + D * l + k) = -along * turns_too(l, c);
          of_normal(D * l + k) = along_master * master_dual(l, c);
        }
      }
    }
  }

  void SetTurns(int i, const Mat<D, R> & dual) {
    for (int l : Range(D)) {
      Set(dual(l, 0), slave.Derivative(i, 0), &gradients(l, 0), n1);
      for (int c = 1; c < R; c++)
        AddScaled(dual(l, c), slave.Derivative(i, c), &gradients(l, 0), n1);
    }
    for (int k : Range(D))
      Set(-points[i].weight * points[i].ray.normal(k), gradients.Data(), &turns(i, k * D * n1),
          D * n1);
  }

  void SetShifts(int i, const Mat<D, R> & turning) {
    auto & ray = points[i].ray;
    for (int a : Range(R)) {
      for (int k : Range(D)) {
        double * shift = &shift_of(k, 0);
        Set(ray.response(a, k), slave.Value(i), shift, n1);
        for (int c : Range(R))
          AddScaled(-ray.normal(k) * turning(a, c), slave.Derivative(i, c), shift, n1);
        Set(-ray.response(a, k), master.Value(i), shift + n1, n - n1);
      }
      for (int k : Range(D))
        Set(points[i].force(k), shift_of.Data(), &shifts(R * i + a, k * D * n), D * n);
    }
  }

  /// Takes in the collected points.
  void Multiply() {
    int npoints = slave.NPoints();
    if (npoints == 0)
      return;
    slave.Evaluate();
    master.Evaluate();
    for (int i : Range(npoints))
      SetPoint(i);
    auto rows = Range(npoints), directions = Range(R * npoints);
    of_slave.Rows(gap, all) += Trans(by_value.Rows(rows)) * slave.Values();
    of_slave.Rows(0, squeeze) += Trans(by_derivative.Rows(directions)) * slave.Derivatives();
    of_master.Rows(gap, all) -= Trans(by_value.Rows(rows)) * master.Values();
    of_master.Rows(tilt, squeeze) +=
        Trans(of_master_normal.Rows(directions)) * master.Derivatives();
    if (loaded) {
      pressed.Rows(0, n1) += Trans(slave.Values()) * turns.Rows(rows);
      pressed.Rows(n1, n) -= Trans(master.Values()) * turns.Rows(rows);
      moved += Trans(master.Derivatives()) * shifts.Rows(directions);
    }
    slave.Clear();
    master.Clear();
  }
  static void Set(double factor, const double * __restrict x, double * __restrict y, int n) {
    for (int i = 0; i < n; i++)
      y[i] = factor * x[i];
  }
};
} // namespace ngslac
