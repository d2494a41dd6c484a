// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include "contact/kinematics.hpp"
#include "couplings.hpp"

namespace ngslac {
/// A slave in the current configuration, and the slip along what it faces.
///
/// Areas, and with them the multipliers, count in the reference configuration. Between two calls of
/// Follow the points on the slave faces and their partners stay; the derivative is exact for that.
/// Moving the points, too, would change nothing but errors of quadrature, since what is integrated
/// is continuous across the edges of segments, except at the rim of the master. Tied surfaces keep
/// their partners, and what counts as their slip may have a part along the normal.
template <int D>
class MovingSliding : public Kinematics<D> {
  using Base = Kinematics<D>;

public:
  using Base::Base;

  void Start(shared_ptr<GridFunction>, FlatVector<> x, Meeting meeting) override;
  void Follow(FlatVector<> x) override;
  /// Finds means, unless the configuration is still the same.
  void At(FlatVector<> x) override;
  MacroPlace<D> Place(size_t m) const override;
  Array<GapRange<D>> GapRanges(FlatVector<>) const override;
  void AddForces(size_t m, const Vec<D> & traction, Scatter & y, LocalHeap & lh) const override;
  pair<Vec<D>, Vec<3>> ResultantOf(size_t m, const Vec<D> & traction) const override;
  shared_ptr<SparseMatrix<double>> ZeroMatrix(FlatArray<Vec<D>> tractions, size_t n) override;
  PlaceRows<D> RowsOf(size_t m, const Vec<D> & traction, Rim rim, BlockSum & sum,
                      LocalHeap & lh) const override;
  MacroJump<D> & JumpWithRows() const override;
  void Commit(FlatVector<> x, FlatArray<MacroState>, FlatArray<MacroState> states) override;
  void Restore() override;
  void Save(NamedNumbers & history) const override;
  void Load(const NamedNumbers & history) override;

protected:
  using Base::law, Base::reference, Base::setup, Base::Size, Base::space, Base::surfaces, Base::u;

  /// Makes what never changes; the slave's reference configuration exists already.
  virtual void Begin(FlatVector<> x, Meeting meeting) = 0;
  /// Pairs at x; nothing if that is as it was.
  virtual optional<Paired<D>> PairAt(FlatVector<> x) = 0;
  /// The configuration of x with the points of the last Follow.
  virtual shared_ptr<Scene<D>> SceneAt(FlatVector<> x) = 0;

  unique_ptr<Surface<D>> slave_reference;
  unique_ptr<FaceShapes<D>> slave_shapes;
  Array<double> fullarea;                  // in the reference configuration
  shared_ptr<const MacroPoints<D>> points; // of the last Follow
  shared_ptr<Scene<D>> now;                // of the last At
  struct {
    Paired<D> surfaces;
    shared_ptr<Scene<D>> scene;
  } accepted; // at the last Commit

private:
  void Accept();
  void FindSlip();
  /// How far those that have met the partner were from it at the last Commit.
  void LookBack(FlatVector<> x);
  /// Nothing has slipped yet before the first Commit.
  bool Slides(size_t m) const {
    return start && points->area[m] > 0 && (setup.tied || law->Slides(m));
  }
  /// Did the partner come over it from the side?
  bool HasMet(size_t m) const { return start->points->area[m] == 0 && points->area[m] > 0; }
  /// That slip counts of: pairs that faced each other at the last Commit, or do so now.
  const SlipPairs<D> & PairsOf(size_t m) const { return HasMet(m) ? *facing : *start; }
  const Vec<D> & Offset(size_t m) const { return HasMet(m) ? met[m] : reference[m]; }
  /// Of this step; what an approaching macro-element moves until it touches is no slip.
  Vec<D> Slip(size_t m) const;
  /// The contact direction; without a partner that of the slave.
  const Vec<D> & Normal(size_t m) const {
    return points->area[m] > 0 ? now->mean[m].normal : surfaces.jump->normal[m];
  }
  MacroTraction<D> Parts(size_t m, const Vec<D> & traction) const;

  shared_ptr<const SlipPairs<D>> start;  // of the last Commit
  shared_ptr<const SlipPairs<D>> facing; // of the last Follow, if LookBack needs it
  Array<Vec<D>> met;                     // see LookBack
  Array<double> last_gap;                // at the last Commit
  Couplings couplings;                   // of the last ZeroMatrix
  mutable shared_ptr<Scene<D>> counted;  // that the rows of the jump are of
};
} // namespace ngslac
