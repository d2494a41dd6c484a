// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include "macromotion.hpp"

namespace ngslac {
/// Two surfaces that are tied, whose slip may have a part along the normal.
///
/// The mean of  x + g n - y  has to vanish: arms g n from the slave to the partners turn with
/// the slave's normals n. Rigid motions of both bodies only turn it, and the tractions do the work
/// of its change: the matrix is symmetric, and where it vanishes moments balance as forces do.
template <int D>
class TieScene : public MeshScene<D> {
public:
  using MeshScene<D>::MeshScene;
  MacroGap<D> MeanOf(size_t m) override;
  void AddForces(size_t m, const MacroTraction<D> & traction, Scatter & y,
                 LocalHeap & lh) const override;
  void AddDerivatives(size_t m, const MacroTraction<D> & traction, Rim rim, MacroRows<D> & rows,
                      BlockSum & stiffness, LocalHeap & lh) const override;
  Vec<D> SlipOf(const SlipPairs<D> & pairs, size_t m) const override;
  void AddSlip(const SlipPairs<D> & pairs, size_t m, MacroRows<D> & rows,
               LocalHeap & lh) const override;
  /// Of a traction at the ends of the arms.
  pair<Vec<D>, Vec<3>> Resultant(size_t m, const MacroTraction<D> & traction) const override;
};
} // namespace ngslac
