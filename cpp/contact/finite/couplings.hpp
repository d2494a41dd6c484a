// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include "macromotion.hpp"

namespace ngslac {
/// Dofs and faces that a macro-element couples in finite sliding, each list sorted.
struct Coupling {
  Array<int> dofs;    // that gap and slip depend on
  Array<int> turning; // that the normal depends on
  Array<int> masters; // faces that its forces act on; empty without forces
  Array<int> key;     // what all this follows from
};

/// Sets the coupling of a macro-element, unless it is the same as before; says whether it changed.
/// `start`: the points from which slip counts, null if it does not slide.
template <int D>
bool UpdateCoupling(const FaceShapes<D> & slave, const FaceShapes<D> & master,
                    const MacroPoints<D> & points, const MacroPoints<D> * start, size_t macro,
                    bool pushes, Coupling & coupling);

/// A zero matrix of size n with the entries for all macro-elements.
template <int D>
shared_ptr<SparseMatrix<double>> MatrixOf(FlatArray<Coupling> couplings,
                                          const FaceShapes<D> & master, FlatArray<int> lamdof,
                                          size_t n);

/// The couplings of all macro-elements, and matrices with their entries: the graph is made anew
/// where one of them has changed.
template <int D>
class Couplings {
  Array<Coupling> couplings;
  shared_ptr<SparseMatrix<double>> last;

public:
  const Coupling & operator[](size_t m) const { return couplings[m]; }

  /// A zero matrix of size n; `update(m, coupling)` as UpdateCoupling.
  template <typename F>
  shared_ptr<SparseMatrix<double>> Matrix(size_t nmacros, const FaceShapes<D> & master,
                                          FlatArray<int> lamdof, size_t n, F update) {
    couplings.SetSize(nmacros);
    std::atomic<bool> same = last && last->Height() == n;
    ParallelFor(nmacros, [&](size_t m) {
      if (update(m, couplings[m]))
        same = false;
    });
    if (same) {
      last = make_shared<SparseMatrix<double>>(static_cast<const MatrixGraph &>(*last));
      last->SetZero();
    } else
      last = MatrixOf<D>(couplings, master, lamdof, n);
    return last;
  }
};
} // namespace ngslac
