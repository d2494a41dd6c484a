// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include "linear/blocksum.hpp"
#include "linear/scatter.hpp"
#include "macrolaw.hpp"
#include "macrostate.hpp"
#include "macrotables.hpp"
#include "pairfinder.hpp"

namespace ngslac {
/// The smallest and the largest gap at the points of a macro-element that have a partner.
template <int D>
struct GapRange {
  double least = std::numeric_limits<double>::infinity(), greatest = -least;
  Vec<D> near = Vec<D>(0.0), far = Vec<D>(0.0); // on the slave, where it is these

  /// NaN is none.
  void Add(double gap, const Vec<D> & x) {
    if (gap < least)
      least = gap, near = x;
    if (gap > greatest)
      greatest = gap, far = x;
  }
};

/// At the corners and at the quadrature points of all segments: `gap` of a macro-element, a segment
/// and a point; NaN leaves a point out.
template <int D, typename F>
Array<GapRange<D>> GapRangesOf(const LACSpace & space, const Paired<D> & surfaces, F gap) {
  auto & slave = *surfaces.slave;
  auto & pairing = *surfaces.pairing;
  auto of_macro = SegmentsOfMacros<D>(space, slave, pairing);
  Array<GapRange<D>> ranges(of_macro.Size());
  ParallelFor(ranges.Size(), [&](size_t m) {
    GapRange<D> range;
    for (int s : of_macro[m]) {
      auto & segment = pairing.segments[s];
      auto add = [&](const PairPoint<D> & p) {
        range.Add(gap(m, segment, p), slave.Origin() + slave.Point(segment.slave, p.slave));
      };
      for (auto & p : pairing.corners.Range(pairing.Corners(s)))
        add(p);
      for (auto & p : pairing.points.Range(pairing.Points(s)))
        add(p);
    }
    ranges[m] = range;
  });
  return ranges;
}

/// How coordinates on a master face move, a column for each of these dofs.
struct PartnerMotion {
  FlatArray<int> dofs;
  FlatMatrix<> moves; // without columns: they stay
};

/// The parts that each kinematics needs.
template <int D>
struct KinematicsParts {
  const ContactSetup & setup;
  shared_ptr<LACSpace> space;
  const ProxyInfo & u;
  shared_ptr<MacroLaw<D>> law;
  shared_ptr<ToolPath<D>> path; // null: there is no tool
};

/// How macro-elements move with the dofs, whatever the law is.
///
/// Small sliding: as at the last Start. Finite sliding: in the configuration looked at last.
template <int D>
class Kinematics {
public:
  explicit Kinematics(const KinematicsParts<D> & parts)
      : setup(parts.setup), space(parts.space), u(parts.u), finder(setup, space, u),
        law(parts.law) {}
  virtual ~Kinematics() = default;

  /// Pairs at x, the values of gf (null: in the reference configuration, x is zero); slip counts
  /// from there. What moves may meet later.
  virtual void Start(shared_ptr<GridFunction> gf, FlatVector<> x, Meeting meeting) = 0;
  /// Pairs anew at x what moves.
  virtual void Follow(FlatVector<> x) = 0;
  /// Evaluates the configuration of x, and what Parameters and other functions may have changed;
  /// the functions below refer to it.
  virtual void At(FlatVector<> x) = 0;
  virtual MacroPlace<D> Place(size_t m) const = 0;
  /// Coordinates on the master face that a point of the pairing faces, and how they move.
  virtual Vec<D - 1> Partner(size_t point) const { return surfaces.pairing->points[point].master; }
  virtual PartnerMotion MovesOf(const Segment &, size_t, LocalHeap & lh) const {
    return {FlatArray<int>(0, lh), FlatMatrix<>(D - 1, 0, lh)};
  }
  /// Subtracts the virtual work of a traction on one macro-element.
  virtual void AddForces(size_t m, const Vec<D> & traction, Scatter & y, LocalHeap & lh) const = 0;
  /// The gaps of points at x, where it was evaluated; of macro-elements without a partner they mean
  /// nothing.
  virtual Array<GapRange<D>> GapRanges(FlatVector<> x) const = 0;
  /// Resultant of a traction, and its moment about the origin.
  virtual pair<Vec<D>, Vec<3>> ResultantOf(size_t m, const Vec<D> & traction) const = 0;
  /// A square zero matrix of size n with the entries of all rows under these tractions.
  virtual shared_ptr<SparseMatrix<double>> ZeroMatrix(FlatArray<Vec<D>> tractions, size_t n) = 0;
  /// How a macro-element moves with the dofs; adds the derivative of its forces at a fixed
  /// traction.
  virtual PlaceRows<D> RowsOf(size_t m, const Vec<D> & traction, Rim rim, BlockSum & stiffness,
                              LocalHeap & lh) const = 0;
  /// Determines which body is the stiffer one, from the diagonal of the bulk matrix.
  virtual void LearnStiffness(FlatVector<> diagonal) = 0;
  /// Accepts x as the end of a step, with the states before and after it.
  virtual void Commit(FlatVector<> x, FlatArray<MacroState> before, FlatArray<MacroState> now) = 0;
  /// Restores the state of the last Commit.
  virtual void Restore() = 0;
  /// The numbers of the last commit that a later solve depends on, written or read.
  virtual void Exchange(History & history) = 0;

  size_t Size() const { return surfaces.jump->Size(); }
  const Paired<D> & Surfaces() const { return surfaces; }
  MacroJump<D> & Jump() const { return *surfaces.jump; }
  const PairFinder<D> & Finder() const { return finder; }
  /// The macro-elements with the rows of the jump, which finite sliding seldom needs.
  virtual MacroJump<D> & JumpWithRows() const {
    if (!Jump().HasRows())
      Jump().SetRows(u, *surfaces.slave, surfaces.master.get(), *surfaces.pairing);
    return Jump();
  }
  /// Slip counts from there.
  Array<Vec<D>> & Reference() { return reference; }

protected:
  /// Takes over a pairing, and makes its macro-elements where there are none.
  void Take(Paired<D> paired) {
    if (!paired.jump)
      paired.jump = make_shared<MacroJump<D>>(*space, *paired.slave, *paired.pairing);
    surfaces = std::move(paired);
  }
  /// Takes the gaps at x as those of the start.
  void AdjustStart() {
    for (size_t m : Range(Size()))
      if (auto place = Place(m); place.area > 0)
        law->Adjust(m, place.gap - law->offset[m]);
  }
  /// An open macro-element that goes on as in the last step will touch where its path meets the
  /// master: what it moves until then, counted in such steps, is no slip.
  static double TimeToTouch(const MacroState & state, double approach, double motion) {
    bool touches = state.status == Status::open && state.gap > 0 && approach > 0.1 * motion &&
                   state.gap < 10 * approach;
    return touches ? state.gap / approach : 0;
  }
  /// The part of a step's slip that will be repeated before the touch.
  static Vec<D> SlipBeforeTouch(const MacroState & state, double approach, const Vec<D> & slip) {
    double time = TimeToTouch(state, approach, sqrt(sqr(approach) + L2Norm2(slip)));
    return (time > 1 ? 1 / time : time) * slip; // if it touches earlier, slip must not turn round
  }

  ContactSetup setup;
  shared_ptr<LACSpace> space;
  ProxyInfo u;
  PairFinder<D> finder;
  shared_ptr<MacroLaw<D>> law;
  Paired<D> surfaces;
  Array<Vec<D>> reference;
};

template <int D>
unique_ptr<Kinematics<D>> MakeSmallSliding(const KinematicsParts<D> & parts);
template <int D>
unique_ptr<Kinematics<D>> MakeToolSliding(const KinematicsParts<D> & parts);
template <int D>
unique_ptr<Kinematics<D>> MakeFiniteSliding(const KinematicsParts<D> & parts);
} // namespace ngslac
