#pragma once
#include <la.hpp>

namespace ngslac {
using namespace ngla;

/// The matrix of the displacements alone when the traction of each macro-element is the projection
/// itself: the product of its columns, a penalty (c over area) and its rows is added.
///
/// `mat` has rows R_m = (P - lambda) / penalty and columns of the forces. Rows of the multipliers
/// stay empty.
template <int D>
shared_ptr<SparseMatrix<double>> EliminateMultipliers(const SparseMatrix<double> & mat,
                                                      FlatArray<int> multipliers,
                                                      FlatArray<double> penalties);
} // namespace ngslac
