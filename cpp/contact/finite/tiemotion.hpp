// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include "macromotion.hpp"

namespace ngslac {
/// Where tied surfaces are: means over a macro-element.
template <int D>
struct MacroTie {
  Vec<D> apart;  // x + g n - y  with the gap g of the pairing, which turns with the slave
  Vec<D> normal; // of the slave
  double gap;    // from x to y along the slave normals
};

template <int D>
MacroTie<D> MeanTie(const MovingSurfaces<D> & now, const MacroPoints<D> & points, size_t macro);

/// Adds its derivative to that of the slip; and that of the forces of a traction, which the arms
/// g n turn, if there is any.
template <int D>
void AddTie(const MovingSurfaces<D> & now, const MacroPoints<D> & points, size_t macro,
            const Vec<D> & traction, MacroRows<D> & rows, LocalHeap & lh);

/// Resultant of a traction on the slave at the ends of the arms, and its moment about the origin.
template <int D>
pair<Vec<D>, Vec<3>> TieResultant(const MovingSurfaces<D> & now, const MacroPoints<D> & points,
                                  size_t macro, const Vec<D> & traction);
} // namespace ngslac
