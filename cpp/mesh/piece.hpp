// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <comp.hpp>

namespace ngslac {
using namespace ngcomp;

/// The part of a distributed mesh on one process, in global numbers, as tables with a row each.
///
/// Points count from 0. Columns of integers: number in the whole mesh (of points, surface and
/// volume elements), type, region, number of points, points; of surface elements and segments also
/// the triangle of the geometry for each point. Columns of reals: coordinates of points; parameters
/// of the geometry (u, v, and along segments the distance) for each point.
struct MeshPiece {
  Matrix<int> point_numbers, segments, surfaces, volumes;
  Matrix<double> points, segment_parameters, surface_parameters;
};

MeshPiece PieceOf(const MeshAccess & mesh);

/// The whole mesh on one process, with regions, names and geometry of a process that has no
/// elements; rows that are there twice count once. Not curved.
shared_ptr<MeshAccess> WholeMesh(const MeshAccess & empty, const MeshPiece & all);
} // namespace ngslac
