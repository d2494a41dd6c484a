// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <la.hpp>

namespace ngslac {
using namespace ngla;

/// Elimination of dofs inside of elements from a matrix, exactly, as static condensation does it.
///
/// With inner dofs I, which come in groups that are not coupled to each other, and all others B:
/// what is left is  K_BB - K_BI K_II^-1 K_IB.
class InnerElimination {
public:
  /// Throws where the matrix of a group is singular.
  InnerElimination(shared_ptr<SparseMatrix<double>> mat, const BitArray & inner);

  /// What is left; inner rows and columns have their diagonal alone.
  shared_ptr<SparseMatrix<double>> Left() const { return left; }
  /// The right hand side of the others, zero on inner dofs.
  void Reduce(FlatVector<> rhs, FlatVector<> reduced) const;
  /// Fills in the inner dofs of a solution.
  void Expand(FlatVector<> rhs, FlatVector<> x) const;

private:
  struct Group {
    Array<int> inner, outer; // its dofs, and those they are coupled to, in ascending order
    Matrix<> inverse;        // of its own matrix
  };

  void FindGroups();
  Group GroupOf(int first, Array<bool> & found) const;
  Matrix<> Block(FlatArray<int> rows, FlatArray<int> columns) const;
  void AllocateLeft();
  void Subtract(const Group & group);
  /// x += K_II^-1 r
  void AddInner(FlatVector<> r, FlatVector<> x) const;

  shared_ptr<SparseMatrix<double>> mat, left;
  BitArray isinner;
  Array<Group> groups;
};
} // namespace ngslac
