// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <la.hpp>

namespace ngslac {
using namespace ngla;

/// The matrix of the displacements alone when the traction of each macro-element is the projection
/// itself: the product of its columns, a penalty (c over area) and its rows is added.
///
/// There are d multipliers to a penalty. `mat` has rows R_m = (P - lambda) / penalty and columns of
/// the forces. Rows of the multipliers stay empty.
shared_ptr<SparseMatrix<double>> EliminateMultipliers(const SparseMatrix<double> & mat,
                                                      FlatArray<int> multipliers, int d,
                                                      FlatArray<double> penalties);
} // namespace ngslac
