// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include "linear/blocksum.hpp"
#include "macromotion.hpp"

namespace ngslac {
/// Of the forces on a master face by its own dofs.
void AddBlock(FlatArray<int> masters, FlatMatrix<> block, BlockSum & forces);

/// The split of the multiplier into pressure and tangential traction turns with the normal.
template <int D>
void AddStiffness(const Vec<D> & normal, const Vec<D> & traction, double pressure,
                  MacroRows<D> & rows, BlockSum & forces);
} // namespace ngslac
