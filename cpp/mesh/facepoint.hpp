// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <meshing.hpp>
#include <vector>

namespace ngslac {
// A point on a surface element, with its parameters on the surface of the geometry.
struct FacePoint {
  netgen::Point<3> p;
  netgen::PointGeomInfo gi;
};

// The mean of the corners, projected to the geometry of the mesh. It stays where it is if the mesh
// has no geometry, or if its points do not lie on it.
FacePoint PointOnFace(const netgen::Mesh & mesh, const netgen::Element2d & el,
                      const std::vector<double> & weights);
} // namespace ngslac
