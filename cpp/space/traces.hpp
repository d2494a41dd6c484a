// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include "mesh/faces.hpp"

namespace ngslac {
using namespace ngcomp;

/// The directions in which means of basis functions reach.
class Reach {
  Mat<3, 3> gram = 0.0;

public:
  /// `mean`: relative to the largest value of the function; those that nearly vanish do not count.
  void Add(const Vec<3> & mean);
  void Add(const Reach & other) { gram += other.gram; }
  int Rank() const;
  /// Orthogonal projection on them.
  Mat<3, 3> Projector() const;
  /// Are all directions of the other among them?
  bool Covers(const Reach & other) const;
  /// Do they have a fair part in a unit normal?
  bool Reaches(const Vec<3> & normal) const;
};

/// The slave surface, and the traces of the displacement's basis functions on it. Scalar dofs.
struct Traces {
  explicit Traces(Faces && slave) : faces(std::move(slave)) {}

  int dim, components; // of the mesh, of the displacement
  Faces faces;
  Array<int> slave_of_face; // of each boundary element of the mesh, -1 elsewhere
  Array<Vec<3>> normals;    // of each slave face, outward
  Table<int> neighbours;    // slave faces that share a vertex
  Table<int> dof_faces;     // slave faces on which the trace of a dof lives
  Array<Vec<3>> dof_mean;   // integral of the trace over (area times its maximum)
  BitArray inner_dofs;      // free, and without a trace on other boundaries
  Array<bool> bare;         // faces on which the space has no dofs
  Array<bool> movable;      // faces on which a free dof moves something along the normal
  Array<Reach> reach;       // of the inner dofs on each face
  Array<Reach> moves;       // of all free dofs on each face
};

Traces CollectTraces(const FESpace & displacement, const BitArray & boundaries);
} // namespace ngslac
