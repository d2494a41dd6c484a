// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include "macromotion.hpp"

namespace ngslac {
/// Dofs and faces that a macro-element couples in finite sliding, each list sorted.
struct Coupling {
  bool pushes = false; // are there forces?
  Array<int> dofs;     // dofs that gap and slip depend on
  Array<int> turning;  // dofs that the normal depends on
  Array<int> masters;  // faces of the master that forces act on
  Array<int> key;      // the numbers that decide on the other members
};

template <int D>
Array<int> DofsOf(const FaceShapes<D> & shapes, Array<int> & faces) {
  SortUnique(faces);
  Array<int> dofs;
  for (int face : faces)
    dofs += shapes.Dofs(face);
  return dofs;
}

/// Numbers that decide on a coupling: whether forces act, and which faces face each other, now and
/// in the configuration from which slip counts.
template <int D>
Array<int> KeyOf(const MacroPoints<D> & points, const MacroPoints<D> * start, size_t macro,
                 bool pushes) {
  Array<int> key;
  key.Append(pushes);
  for (auto * from : {&points, start})
    if (from) {
      key.Append(from->segments[macro].Size());
      for (int s : from->segments[macro]) {
        key.Append(from->pairing->segments[s].slave);
        key.Append(from->pairing->segments[s].master);
      }
    }
  return key;
}

/// Updates the coupling of a macro-element; returns whether it has changed.
template <int D>
bool UpdateCoupling(const Scene<D> & scene, const MacroPoints<D> * start, size_t macro, bool pushes,
                    Coupling & coupling) {
  // Unknowns of a tool always have a diagonal entry, by which the solver may hold them.
  auto & unknowns = scene.unknowns;
  bool exists = scene.points->area[macro] > 0 || unknowns.Size();
  pushes = pushes || unknowns.Size();
  auto key = exists ? KeyOf(*scene.points, start, macro, pushes) : Array<int>();
  if (key == coupling.key)
    return false;
  coupling = Coupling();
  coupling.key = std::move(key);
  if (!exists)
    return true;
  coupling.pushes = pushes;
  Array<int> slaves, masters;
  auto add = [&](const MacroPoints<D> & from) {
    for (int s : from.segments[macro]) {
      slaves.Append(from.pairing->segments[s].slave);
      if (scene.master_shapes)
        masters.Append(from.pairing->segments[s].master);
    }
  };
  auto dofs = [&] {
    auto result = DofsOf(scene.slave_shapes, slaves);
    if (scene.master_shapes)
      result += DofsOf(*scene.master_shapes, masters);
    result += unknowns;
    SortUnique(result);
    return result;
  };
  add(*scene.points);
  coupling.turning = dofs();
  if (pushes)
    coupling.masters = masters;
  if (start)
    add(*start);
  coupling.dofs = dofs();
  return true;
}

/// The multipliers of a macro-element couple with its dofs. Where forces act, these dofs couple
/// with those that turn the normal, and the dofs of each face of the master couple with each other.
template <int D>
Array<GraphBlock> GraphOf(FlatArray<Coupling> couplings, const FaceShapes<D> * master,
                          FlatArray<int> lamdof) {
  Array<GraphBlock> blocks(2 * couplings.Size());
  Array<int> masters;
  for (size_t m : Range(couplings)) {
    auto & coupling = couplings[m];
    auto own = lamdof.Range(D * m, D * (m + 1));
    auto &lines = blocks[2 * m], &forces = blocks[2 * m + 1];
    lines.rows = lines.columns = own;
    lines.columns += coupling.dofs;
    forces.rows = coupling.dofs;
    forces.columns = own;
    if (coupling.pushes)
      forces.columns += coupling.turning;
    masters += coupling.masters;
  }
  SortUnique(masters);
  for (int face : masters) {
    Array<int> dofs(master->Dofs(face));
    SortUnique(dofs);
    blocks.Append(GraphBlock{Array<int>(dofs), Array<int>(dofs)});
  }
  return blocks;
}

/// The couplings of all macro-elements, and matrices with entries for them. A coupling that changes
/// makes the graph anew.
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
         FlatArray<Vec<D>> tractions, FlatArray<int> lamdof, size_t n) {
    couplings.SetSize(start.Size());
    std::atomic<bool> same = last && last->Height() == n;
    ParallelFor(start.Size(), [&](size_t m) {
      if (UpdateCoupling(scene, start[m], m, IsTraction(tractions[m]), couplings[m]))
        same = false;
    });
    if (same) {
      last = make_shared<SparseMatrix<double>>(static_cast<const MatrixGraph &>(*last));
      last->SetZero();
    } else
      last = ZeroMatrix(n, GraphOf<D>(couplings, scene.master_shapes, lamdof));
    return last;
  }
};
} // namespace ngslac
