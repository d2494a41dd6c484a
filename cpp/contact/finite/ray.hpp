// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include "pairing/pairing.hpp"

namespace ngslac {
/// What has to be kept of a ray to build it again without searching.
template <int D>
struct RayHit {
  Vec<D - 1> eta;
  double gap;
  Vec<D> normal;
  bool missed;
};

/// A point of the slave and the point of a master face that its normal meets.
template <int D>
struct Ray {
  Vec<D> x, y, normal;
  Mat<D, D - 1> dx, dy;
  Vec<D - 1> eta;
  double gap;
  /// Turns  d(x) + gap d(normal) - d(y at fixed eta)  into  (d eta, d gap).
  Mat<D, D> response;
  Vec<D> miss; // y - x - gap normal, 0 unless the ray misses

  Ray(const Surface<D> & slave, int slave_face, const Surface<D> & master, int master_face,
      const PairPoint<D> & start);
  /// of a hit in the same configuration
  Ray(const Surface<D> & slave, int slave_face, const Surface<D> & master, int master_face,
      const PairPoint<D> & start, const RayHit<D> & hit);

  RayHit<D> Hit() const { return {eta, gap, normal, missed}; }

private:
  void Miss();
  /// of y - gap normal, by (eta, gap)
  Mat<D, D> Moves() const;
  bool missed = false;
  bool Shoot(const Surface<D> & master, int face, double size);
};

/// Columns a^1 (and a^2) with  a^i . a_j = delta_ij  in the tangent plane.
template <int D>
Mat<D, D - 1> DualBasis(const Mat<D, D - 1> & dx);
} // namespace ngslac
