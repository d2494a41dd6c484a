#pragma once
#include <la.hpp>

namespace ngslac {
using namespace ngla;

/// Factors s that give  s_i A_ij s_j  a unit diagonal; rows with a zero diagonal get unit maximum.
///
/// Entries count the scalars of block matrices. Makes what is solved independent of units.
Array<double> EquilibrationScale(const BaseMatrix & bulk);

/// diag(scale) (bulk + sum of contacts) diag(scale)  as a new scalar matrix with its exact graph.
shared_ptr<SparseMatrix<double>> MergeMatrices(const BaseMatrix & bulk,
                                               FlatArray<shared_ptr<SparseMatrix<double>>> contacts,
                                               FlatVector<> scale);

/// Scalar diagonal of a sparse matrix with scalar or block entries.
Array<double> ScalarDiagonal(const BaseMatrix & mat);
} // namespace ngslac
