// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include "surface/surface.hpp"

namespace ngslac {
/// Corners of plane facets that the faces of a surface are divided into, D for each facet, with
/// normals out of the body. Triangles and quadrilaterals are divided along each side.
template <int D>
Array<Vec<D>> FacetCorners(const Surface<D> & surface, int divisions);
} // namespace ngslac
