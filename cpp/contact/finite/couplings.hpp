#pragma once
#include "macromotion.hpp"

namespace ngslac {
/// Dofs and faces that a macro-element couples in finite sliding, each list sorted.
struct Coupling {
  Array<int> dofs;    // that gap and slip depend on
  Array<int> turning; // that the normal depends on
  Array<int> masters; // faces that its forces act on; empty without forces
};

/// `start`: the points from which slip counts, null if it does not slide.
template <int D>
Coupling CouplingOf(const FaceShapes<D> & slave, const FaceShapes<D> & master,
                    const MacroPoints<D> & points, const MacroPoints<D> * start, size_t macro,
                    bool pushes);

/// A zero matrix of size n with the entries for all macro-elements.
template <int D>
shared_ptr<SparseMatrix<double>> MatrixOf(FlatArray<Coupling> couplings,
                                          const FaceShapes<D> & master, FlatArray<int> lamdof,
                                          size_t n);
} // namespace ngslac
