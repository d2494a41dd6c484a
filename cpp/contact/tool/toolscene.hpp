// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include "contact/finite/macromotion.hpp"
#include "contact/toolpath.hpp"

namespace ngslac {
/// A slave surface and a tool, which dictates the contact direction.
template <int D>
class ToolScene : public Scene<D> {
  int version; // of the tool's path

public:
  ToolPosition<D> tool;

  ToolScene(const FaceShapes<D> & shapes, const Surface<D> & reference, const ToolPath<D> & path,
            FlatVector<> x, shared_ptr<const MacroPoints<D>> points)
      : Scene<D>(shapes, nullptr, reference, x, points), version(path.Version()), tool(path.At(x)) {
    this->unknowns = path.Dofs();
  }
  /// Positions in the space, whatever the origin of the surface is.
  Vec<D> InSpace(const Vec<D> & x) const { return this->slave.Origin() + x; }
  bool IsLike(const Scene<D> & other) const override {
    auto & as_this = static_cast<const ToolScene &>(other);
    return version == as_this.version && this->slave.HasShapeOf(other.slave) &&
           tool.place == as_this.tool.place;
  }
  MacroGap<D> MeanOf(size_t m) override;
  double GapAt(const Segment & segment, const PairPoint<D> & p) const override;
  void AddForces(size_t m, const MacroTraction<D> & traction, Scatter & y,
                 LocalHeap & lh) const override;
  void AddDerivatives(size_t m, const MacroTraction<D> & traction, Rim rim, MacroRows<D> & rows,
                      BlockSum & stiffness, LocalHeap & lh) const override;
  /// Where points that face the tool would meet it along the slave normals.
  shared_ptr<const SlipPairs<D>> Pairs() const override;
  Vec<D> SlipOf(const SlipPairs<D> & pairs, size_t m) const override;
  void AddSlip(const SlipPairs<D> & pairs, size_t m, MacroRows<D> & rows,
               LocalHeap & lh) const override;
};

/// Every face of the slave whole, with weights of areas of the reference configuration.
template <int D>
shared_ptr<Pairing<D>> AllPoints(const Surface<D> & reference, int order);

/// Does a point face the tool, whose normals have this product? Yes (1), no (0), or in between: a
/// point that slides beyond the edge of a tool leaves it smoothly.
double Facing(double cosine);
/// Its derivative, over itself.
double FacingGrowth(double cosine);

/// The share of each point that faces the tool, with weights of `all`; fills gaps and normals.
template <int D>
shared_ptr<Pairing<D>> FacingPoints(const Pairing<D> & all, const ToolScene<D> & now);

/// Throws where the slave lies behind the surface of a tool, as if that were turned inside out:
/// where nothing faces it, unless it is farther away than `maxdist` (0: whatever that is), or
/// where all that faces it is deep inside.
template <int D>
void CheckSideOfTool(const ToolScene<D> & now, const Pairing<D> & all, double maxdist);
} // namespace ngslac
