// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include "endrows.hpp"
#include "kinematics.hpp"

namespace ngslac {
/// The macro-elements of small sliding that contact ends in.
template <int D>
class MacroEnds {
  Array<EndRows<D>> rows;
  Array<size_t> numbers; // of their macro-elements
  Array<int> place;      // of each macro-element in `rows`, or -1
  Array<double> shares;  // see EndShares

public:
  MacroEnds() = default;
  /// `points`: pairs the slave faces that are set; gaps are counted from the displacements `x`.
  MacroEnds(const LACSpace & space, const ProxyInfo & u, const Paired<D> & surfaces,
            std::function<Pairing<D>(const BitArray &)> points, FlatArray<Vec<D>> direction,
            FlatVector<> x);

  bool Empty() const { return rows.Size() == 0; }
  double ShareOf(size_t m) const { return shares.Size() ? shares[m] : 0; }
  const EndPoints * PointsOf(size_t m) const {
    return place.Size() && place[m] >= 0 ? &rows[place[m]].points : nullptr;
  }
  /// Of each macro-element the dofs that couple by the points.
  Array<FlatArray<int>> Dofs(size_t nmacros) const;
  void Look(const MacroLaw<D> & law, FlatArray<Vec<D>> direction, FlatVector<> x);
  /// Adds the virtual work of the pressure.
  void AddForces(size_t m, const MacroLaw<D> & law, Scatter & y) const;
  Vec<D> MomentOf(size_t m, const MacroLaw<D> & law) const;

  /// How one of them moves with the dofs; adds the stiffness of its points.
  PlaceRows<D> RowsOf(size_t m, const MacroLaw<D> & law, const MacroJump<D> & jump,
                      const Vec<D> & direction, BlockSum & stiffness) const;

  /// What was looked at, as numbers.
  Array<double> Save() const;
  void Load(FlatArray<double> saved);
};
} // namespace ngslac
