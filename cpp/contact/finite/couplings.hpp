// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include "macromotion.hpp"

namespace ngslac {
/// Dofs and faces that a macro-element couples in finite sliding, each list sorted.
struct Coupling {
  bool pushes = false; // are there forces?
  Array<int> dofs;     // that gap and slip depend on
  Array<int> turning;  // that the normal depends on
  Array<int> masters;  // faces of the master that forces act on
  Array<int> key;      // what all this follows from
};

/// The couplings of all macro-elements, and matrices with their entries: the graph is made anew
/// where one of them has changed.
class Couplings {
  Array<Coupling> couplings;
  shared_ptr<SparseMatrix<double>> last;

public:
  const Coupling & operator[](size_t m) const { return couplings[m]; }

  /// A zero matrix of size n. `start`: the points from which the slip of a macro-element counts,
  /// null if it does not slide.
  template <int D>
  shared_ptr<SparseMatrix<double>>
  Matrix(const Scene<D> & scene, FlatArray<const MacroPoints<D> *> start,
         FlatArray<Vec<D>> tractions, FlatArray<int> lamdof, size_t n);
};
} // namespace ngslac
