// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include "linear/blocksum.hpp"
#include "macromotion.hpp"

namespace ngslac {
/// Size of a heap for blocks of the dofs of two faces, which grows with their degree.
template <int D>
size_t BlockHeap(int degree) {
  size_t functions = D * size_t(pow(degree + 1, D - 1));
  return 20 * 1000 * 1000 + 300 * sqr(functions);
}

/// Of the forces on a master face by its own dofs.
void AddBlock(FlatArray<int> masters, FlatMatrix<> block, BlockSum & forces);

/// The split of the multiplier into pressure and tangential traction turns with the normal.
template <int D>
void AddStiffness(const Vec<D> & normal, const Vec<D> & traction, double pressure,
                  MacroRows<D> & rows, BlockSum & forces);
} // namespace ngslac
