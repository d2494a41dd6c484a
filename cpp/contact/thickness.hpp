// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include "surface/surface.hpp"

namespace ngslac {
/// For each boundary element, one vertex that stands for the body that it belongs to.
Array<int> BodiesOfBoundary(const MeshAccess & ma);

/// How thick the body behind some faces of a master is in the reference configuration, up to the
/// other side; infinite where there is none that is no slave, and for other faces.
template <int D>
Array<double> BodyThicknesses(const Region & master, const Region & slave, const BitArray & faces);
} // namespace ngslac
