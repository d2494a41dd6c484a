// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <la.hpp>

namespace ngslac {
using namespace ngla;

/// Factors s that give  s_i A_ij s_j  a unit diagonal; rows with a zero diagonal get unit maximum.
///
/// Entries count the scalars of block matrices. Makes what is solved independent of units.
Array<double> EquilibrationScale(const BaseMatrix & bulk);

/// diag(scale) (bulk + sum of contacts) diag(scale)  as a scalar matrix with its exact graph.
///
/// `former` was merged from the same bulk with the same scale: where it has the same graph, only
/// its rows with contact are written anew, and it is returned.
shared_ptr<SparseMatrix<double>> MergeMatrices(const BaseMatrix & bulk,
                                               FlatArray<shared_ptr<SparseMatrix<double>>> contacts,
                                               FlatVector<> scale,
                                               shared_ptr<SparseMatrix<double>> former = nullptr);

/// Scalar diagonal of a sparse matrix with scalar or block entries.
Array<double> ScalarDiagonal(const BaseMatrix & mat);
} // namespace ngslac
