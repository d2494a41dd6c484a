// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include "partition.hpp"

namespace ngslac {
/// Piecewise constants on macro-elements of the slave surface.
///
/// One d-vector per macro-element (the contact traction in Cartesian components), or `components`
/// numbers. Over a displacement space with blocks (H1(dim=d)) the space has the same blocks, so
/// that the product of both spaces exists.
class LACSpace : public FESpace {
public:
  /// flags: "slave" (see NumbersOf), "macros" (optional partition of the first mesh),
  /// "components" (default: the space dimension), "axisymmetric"
  LACSpace(shared_ptr<FESpace> displacement, const Flags & flags);

  string GetClassName() const override { return "LACSpace"; }

  void Update() override;
  void UpdateCouplingDofArray() override;
  using FESpace::GetDofNrs;
  void GetDofNrs(ElementId ei, Array<DofId> & dnums) const override;
  FiniteElement & GetFE(ElementId ei, Allocator & alloc) const override;

  /// A space on the same macro-elements with another number of components.
  shared_ptr<LACSpace> WithComponents(int n) const;
  /// On a mesh of which this process has a part only, the macro-elements come from elsewhere.
  void Take(MacroPartition other) { taken = std::move(other); }

  shared_ptr<FESpace> Displacement() const { return displacement; }
  size_t NMacros() const { return partition.nmacros; }
  /// macro-element of each boundary element of the mesh, -1 off the slave surface
  FlatArray<int> MacroOfFace() const { return partition.macro_of_face; }
  /// displacement dofs whose trace lives in the macro-element alone
  FlatArray<int> CoreDofs(size_t macro) const { return partition.cores[macro]; }
  /// Projection on the directions in which free displacements inside of the macro-element move the
  /// mean; 0 where they do not reach the normal.
  const Mat<3, 3> & ReachOf(size_t macro) const { return partition.reach[macro]; }
  /// Is the axis of the bodies x = 0?
  bool IsAxisymmetric() const { return flags.GetDefineFlag("axisymmetric"); }
  Region SlaveRegion() const { return Region(ma, BND, slave); }

private:
  shared_ptr<FESpace> displacement;
  BitArray slave;
  Array<int> given_macros;
  int components;
  size_t first_mesh_faces;
  MacroPartition partition;
  optional<MacroPartition> ready; // taken over by the next Update
  optional<MacroPartition> taken; // by each
};
} // namespace ngslac
