// SPDX-License-Identifier: LGPL-2.1-or-later
#include "ray.hpp"

namespace ngslac {
namespace {
// How far beyond its face the polynomial of a master face is trusted, in reference coordinates.
constexpr double farthest_outside = 1;
// Steps that are so short, in reference coordinates and face sizes, have converged.
constexpr double tolerance = 1e-9;
// How many times the rounding errors of positions a step may be that has converged.
constexpr double rounding = 8 * std::numeric_limits<double>::epsilon();
} // namespace

template <int D>
Ray<D>::Ray(const Surface<D> & slave, int slave_face, const Surface<D> & master, int master_face,
            const PairPoint<D> & start)
    : eta(start.master), gap(start.gap), miss(0.0) {
  slave.Evaluate(slave_face, start.slave, x, dx);
  normal = slave.Normal(slave_face, dx);
  if (Shoot(master, master_face, L2Norm(dx)))
    return;
  // Far away, where rays spread, the partner of the pairing stays.
  eta = start.master;
  master.Evaluate(master_face, eta, y, dy);
  gap = InnerProduct(normal, y - x);
  Miss();
}

template <int D>
Ray<D>::Ray(const Surface<D> & slave, int slave_face, const Surface<D> & master, int master_face,
            const PairPoint<D> & start, const RayHit<D> & hit)
    : normal(hit.normal), eta(hit.eta), gap(hit.gap), miss(0.0) {
  slave.Evaluate(slave_face, start.slave, x, dx);
  master.Evaluate(master_face, eta, y, dy);
  if (hit.missed)
    Miss();
  else
    response = Inv(Moves());
}

template <int D>
void Ray<D>::Miss() {
  missed = true;
  miss = y - x - gap * normal;
  response = 0.0;
  response.Row(D - 1) = -normal;
}

template <int D>
Mat<D, D> Ray<D>::Moves() const {
  Mat<D, D> derivative;
  for (int i : Range(D)) {
    for (int k : Range(D - 1))
      derivative(i, k) = dy(i, k);
    derivative(i, D - 1) = -normal(i);
  }
  return derivative;
}

template <int D>
bool Ray<D>::Shoot(const Surface<D> & master, int face, double size) {
  for (int it = 0; it < 20; it++) {
    master.Evaluate(face, eta, y, dy);
    response = Inv(Moves());
    Vec<D> step = response * Vec<D>(y - x - gap * normal);
    double length = 0;
    for (int k : Range(D - 1)) {
      eta(k) -= step(k);
      length = max(length, fabs(step(k)));
      if (!(fabs(eta(k) - 0.5) < 0.5 + farthest_outside))
        return false;
    }
    gap -= step(D - 1);
    // Far from the origin positions, and with them the steps, are known to so many digits only.
    double known = max(tolerance, rounding * (L2Norm(x) + L2Norm(y)) / size);
    if (length < 1e-14) // y and dy are those of this point
      return true;
    if (length < known && fabs(step(D - 1)) < known * size) {
      master.Evaluate(face, eta, y, dy);
      return true;
    }
  }
  return false;
}

template <int D>
Mat<D, D - 1> DualBasis(const Mat<D, D - 1> & dx) {
  Mat<D - 1, D - 1> metric = Trans(dx) * dx;
  return dx * Inv(metric);
}

template struct Ray<2>;
template struct Ray<3>;
template Mat<2, 1> DualBasis(const Mat<2, 1> &);
template Mat<3, 2> DualBasis(const Mat<3, 2> &);
} // namespace ngslac
