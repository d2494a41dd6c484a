// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include "surface/surface.hpp"

namespace ngslac {
/// The direction in which two points push each other, out of the slave: between the normals of both
/// surfaces, nearer to that of the stiffer body.
///
/// It is the normal of the surface that lies between the two where they would meet as springs in
/// series. Neither body is preferred, and a rigid one dictates its own normal.
template <int D>
struct ContactDirection {
  Vec<D> normal;
  double of_slave, of_master; // the factors of both normals, divided by the length of their sum

  ContactDirection() = default;
  /// `share`: of the master in the stiffness of both, 0 to 1
  ContactDirection(const Vec<D> & slave, const Vec<D> & master, double share) {
    if (InnerProduct(slave, master) > 0) // which turned away from each other
      share = 0;
    normal = (1 - share) * slave - share * master;
    double length = L2Norm(normal);
    normal *= 1 / length;
    of_slave = (1 - share) / length, of_master = -share / length;
  }

  Mat<D, D> Across() const { return Id<D>() - normal * Trans(normal); }
};
} // namespace ngslac
