// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <comp.hpp>
#include <h1hofespace.hpp>

namespace ngslac {
using namespace ngcomp;

// Scalar H1 with a basis function inside every face of the slave boundary: an edge bubble in 2D, a
// face bubble in 3D. It adds nothing where the order alone gives one.
class BubbleH1FESpace : public H1HighOrderFESpace {
  BitArray slave; // boundary regions

public:
  BubbleH1FESpace(shared_ptr<MeshAccess> ama, const Flags & flags, bool checkflags = false);

  string GetClassName() const override { return "BubbleH1FESpace"; }
  static DocInfo GetDocu();
  Region SlaveRegion() const { return Region(ma, BND, slave); }

  // Every update passes here before it counts the dofs, so a refined mesh gets its bubbles, too.
  void UpdateDofTables() override;
};

// VectorH1 with these scalar spaces as its components.
class BubbleVectorH1FESpace : public VectorH1FESpace {
public:
  BubbleVectorH1FESpace(shared_ptr<MeshAccess> ama, const Flags & flags, bool checkflags = false);

  string GetClassName() const override { return "BubbleVectorH1FESpace"; }
  static DocInfo GetDocu();
  Region SlaveRegion() const { return static_cast<BubbleH1FESpace &>(*spaces[0]).SlaveRegion(); }
};
} // namespace ngslac
