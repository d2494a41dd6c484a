// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include "contact/finite/macromotion.hpp"
#include "toolposition.hpp"

namespace ngslac {
/// A slave surface and a tool in one configuration.
template <int D>
struct ToolScene {
  const FaceShapes<D> & shapes;
  Surface<D> slave;
  ToolPosition<D> tool;

  /// Positions in the space, whatever the origin of the surface is.
  Vec<D> InSpace(const Vec<D> & x) const { return slave.Origin() + x; }
};

/// Points of the slave and of the tool that faced each other, of which slip counts.
template <int D>
struct ToolPartners {
  Array<Vec<D>> at, normal; // in the coordinates of the tool: the partner, and the tool's normal
  Array<double> gap;        // along the slave normal
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
shared_ptr<Pairing<D>> FacingPoints(const Pairing<D> & all, const Surface<D> & slave,
                                    const ToolPosition<D> & tool);

/// Throws where the slave lies behind the surface of a tool, as if that were turned inside out:
/// where nothing faces it, unless it is farther away than `maxdist` (0: whatever that is), or
/// where all that faces it is deep inside.
template <int D>
void CheckSideOfTool(const ToolScene<D> & now, const Pairing<D> & all, double maxdist);

/// Where points that face the tool would meet it along the slave normals.
template <int D>
ToolPartners<D> PartnersOf(const Pairing<D> & points, const Surface<D> & slave,
                           const ToolPosition<D> & tool);

/// Mean distance and normals of a macro-element; the tool dictates the contact direction.
template <int D>
MacroGap<D> MeanDistance(const ToolScene<D> & now, const MacroPoints<D> & points, size_t macro);

/// Derivatives of distance, normals and forces at this mean; of the forces only if there are any.
/// `moving`: the share of points that face the tool changes, which the value at fixed weights does
/// not see.
template <int D>
void AddToolDerivatives(const ToolScene<D> & now, const MacroPoints<D> & points, size_t macro,
                        const MacroGap<D> & mean, const MacroTraction<D> & traction, bool moving,
                        MacroRows<D> & rows, LocalHeap & lh);

/// Subtracts the virtual work of a traction.
template <int D>
void AddToolTraction(const ToolScene<D> & now, const MacroPoints<D> & points, size_t macro,
                     const MacroTraction<D> & traction, Scatter & y, LocalHeap & lh);

/// How far the slave slid along the tool since there were these partners: the mean of how far they
/// are apart now, across the tool's normal.
template <int D>
Vec<D> ToolSlip(const ToolScene<D> & now, const MacroPoints<D> & points,
                const ToolPartners<D> & partners, size_t macro);
/// Adds its derivative to that of the slip.
template <int D>
void AddToolSlip(const ToolScene<D> & now, const MacroPoints<D> & points,
                 const ToolPartners<D> & partners, size_t macro, MacroRows<D> & rows,
                 LocalHeap & lh);
} // namespace ngslac
