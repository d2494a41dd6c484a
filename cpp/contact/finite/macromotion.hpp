// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include "contact/direction.hpp"
#include "contact/faceshapes.hpp"
#include "contact/place.hpp"
#include "linear/blocksum.hpp"
#include "linear/scatter.hpp"
#include "ray.hpp"

namespace ngslac {
/// Quadrature points on the slave surface with the master faces they see: of one pairing, fixed in
/// the coordinates of the slave faces.
template <int D>
struct MacroPoints {
  shared_ptr<const Pairing<D>> pairing;
  Table<int> segments;       // of each macro-element
  Table<int> rim;            // of each macro-element, points of the pairing's rim
  Array<double> area;        // of each macro-element, 0 where too little is paired
  Array<Mat<D, D - 1>> dual; // of the tangents at the first point of each macro-element
};

template <int D>
shared_ptr<MacroPoints<D>> MakePoints(shared_ptr<const Pairing<D>> pairing,
                                      const Surface<D> & slave, const LACSpace & space,
                                      FlatArray<double> area);

/// Points that faced each other once: slip counts from there.
template <int D>
struct SlipPairs {
  shared_ptr<const MacroPoints<D>> points;
  // Of a tool, point by point: the partner and the normal there in the coordinates of the tool, and
  // the gap along the normal of the slave.
  Array<Vec<D>> at, normal;
  Array<double> gap;

  explicit SlipPairs(shared_ptr<const MacroPoints<D>> some_points) : points(some_points) {}
};

/// The mean of value(segment, point) over the points of a macro-element.
template <int D, typename F>
Vec<D> MeanOf(const MacroPoints<D> & points, size_t m, F value) {
  Vec<D> sum = 0.0;
  for (int s : points.segments[m])
    for (size_t i : points.pairing->Points(s))
      if (double weight = points.pairing->points[i].weight; weight != 0)
        sum += weight * value(points.pairing->segments[s], i);
  return 1 / points.area[m] * sum;
}

template <int D>
struct MacroGap;
template <int D>
class FacePair;

/// Derivatives of what moves with a macro-element, a column for each dof.
template <int D>
struct MacroRows {
  FlatArray<int> dofs;    // sorted
  FlatArray<int> turning; // those of them that the normal depends on, sorted
  Matrix<> data;          // of all that follows
  FlatMatrix<> normal;
  FlatMatrix<> force; // integral of slave minus master shape functions
  FlatVector<> gap;
  FlatVector<> squeeze; // the force along the directions of the pressure
  FlatMatrix<> tilt;    // of the pressure against the slave normals
  FlatMatrix<> slip;
  Matrix<> stiffness; // of the contact forces, a column for each turning dof

  MacroRows(FlatArray<int> adofs, FlatArray<int> aturning);
  /// Turns integrals of gap and normals (that of the master in place of `tilt`) into the means.
  void MakeMeans(const MacroGap<D> & mean, double area, double share);
  /// Rows of the place on which the law depends, at this normal, slip and gap; the slip may have a
  /// part along the normal.
  PlaceRows<D> OfPlace(const Vec<D> & n, const Vec<D> & slipped, double opened) const;
  int Position(int dof) const { return PositionIn(dofs, dof); }
  int TurningPosition(int dof) const { return PositionIn(turning, dof); }

private:
  static int PositionIn(FlatArray<int> sorted, int dof) {
    return std::lower_bound(sorted.begin(), sorted.end(), dof) - sorted.begin();
  }
};

/// Is any component not zero? Squares of tiny ones would underflow.
template <int D>
bool IsTraction(const Vec<D> & traction) {
  for (int k : Range(D))
    if (traction(k) != 0)
      return true;
  return false;
}

/// Where the slave normals meet the master: mean gap and contact direction of a macro-element.
///
/// From a point x of the slave with normal n the ray  x + g n  meets the master at y(eta); both eta
/// and g follow the displacement. Weights are areas of the reference configuration. The direction
/// lies between the means of both normals.
template <int D>
struct MacroGap {
  double gap;
  Vec<D> slave, master; // mean normals
  Vec<D> normal, tilt;  // the contact direction; what turns the slave normals to it
  double length;        // of what the direction is the unit vector of

  MacroGap() = default;
  MacroGap(double agap, const Vec<D> & aslave, const Vec<D> & amaster, double share)
      : gap(agap), slave(aslave), master(amaster), tilt(share * (slave + master)) {
    Vec<D> mean = slave - tilt;
    length = L2Norm(mean);
    normal = (1 / length) * mean;
  }
};

/// The traction on the slave: the pressure acts along the normal of each point, so that the
/// constant directions of macro-elements do not show on curved surfaces, and so that it follows
/// what the means do not hold; but the same tilt everywhere turns its mean to that of the contact.
template <int D>
struct MacroTraction {
  double pressure;
  Vec<D> even; // what is the same at all points

  MacroTraction(const Vec<D> & traction, const MacroGap<D> & mean)
      : pressure(-InnerProduct(traction, mean.normal)),
        even(traction + pressure * (mean.normal + mean.tilt)) {}
  Vec<D> At(const Vec<D> & normal) const { return even - pressure * normal; }
  bool IsZero() const { return pressure == 0 && !IsTraction(even); }
};

/// A slave and what it faces in one configuration, at the points of one pairing; macro-elements
/// without a partner are left out.
template <int D>
class Scene {
public:
  const FaceShapes<D> & slave_shapes;
  const FaceShapes<D> * master_shapes; // null: a tool
  Array<int> unknowns;                 // dofs of a tool's motion
  Surface<D> slave;
  shared_ptr<const MacroPoints<D>> points;
  Array<MacroGap<D>> mean;
  Array<Vec<D>> slip; // since the last Commit, of macro-elements that slide

  /// The reference surface displaced by x.
  Scene(const FaceShapes<D> & shapes, const FaceShapes<D> * amaster_shapes,
        const Surface<D> & reference, FlatVector<> x, shared_ptr<const MacroPoints<D>> some_points)
      : slave_shapes(shapes), master_shapes(amaster_shapes), slave(shapes.Displaced(reference, x)),
        points(some_points) {}
  virtual ~Scene() = default;
  /// Is the other one the same configuration?
  virtual bool IsLike(const Scene & other) const = 0;
  virtual MacroGap<D> MeanOf(size_t m) = 0;
  /// At a point of the pairing; NaN if it faces nothing.
  virtual double GapAt(const Segment & segment, const PairPoint<D> & p) const = 0;
  /// Subtracts the virtual work of a traction.
  virtual void AddForces(size_t m, const MacroTraction<D> & traction, Scatter & y,
                         LocalHeap & lh) const = 0;
  /// Derivatives of gap, normal and forces; of the forces only if there are any.
  virtual void AddDerivatives(size_t m, const MacroTraction<D> & traction, Rim rim,
                              MacroRows<D> & rows, BlockSum & stiffness, LocalHeap & lh) const = 0;
  /// Coordinates on the master face that a point of the pairing faces.
  virtual Vec<D - 1> Partner(size_t point) const { return points->pairing->points[point].master; }
  /// How they move, a column for each dof of both faces; without columns: they stay.
  virtual FlatMatrix<> PartnerMoves(const FacePair<D> &, size_t, LocalHeap & lh) const {
    return FlatMatrix<>(D - 1, 0, lh);
  }
  virtual shared_ptr<const SlipPairs<D>> Pairs() const = 0;
  /// How far the slave slid along its partners since they faced each other: the mean of the part of
  /// x + g n - y  across the contact direction, with the gap g and the partner y of then. Rigid
  /// motions of both bodies do not change it, and what comes nearer in that direction does not
  /// slip.
  virtual Vec<D> SlipOf(const SlipPairs<D> & pairs, size_t m) const = 0;
  /// Adds its derivative to that of the slip.
  virtual void AddSlip(const SlipPairs<D> & pairs, size_t m, MacroRows<D> & rows,
                       LocalHeap & lh) const = 0;
  /// Resultant of a traction on the slave, and its moment about the origin (2D: the last
  /// component).
  virtual pair<Vec<D>, Vec<3>> Resultant(size_t m, const MacroTraction<D> & traction) const;
};

/// Two surfaces, where the normals of the slave meet the master.
template <int D>
class MeshScene : public Scene<D> {
  using Base = Scene<D>;
  Array<RayHit<D>> hits; // of the points

public:
  Surface<D> master;
  double share; // of the master in the stiffness of both

  MeshScene(const FaceShapes<D> & slave_shapes, const FaceShapes<D> & shapes,
            const Surface<D> & slave_reference, const Surface<D> & reference, double ashare,
            FlatVector<> x, shared_ptr<const MacroPoints<D>> points)
      : Base(slave_shapes, &shapes, slave_reference, x, points),
        hits(points ? points->pairing->points.Size() : 0), master(shapes.Displaced(reference, x)),
        share(ashare) {}
  bool IsLike(const Scene<D> & other) const override {
    auto & as_this = static_cast<const MeshScene &>(other);
    return share == as_this.share && this->slave.HasShapeOf(other.slave) &&
           master.HasShapeOf(as_this.master);
  }
  MacroGap<D> MeanOf(size_t m) override;
  double GapAt(const Segment &, const PairPoint<D> & p) const override { return p.gap; }
  Vec<D - 1> Partner(size_t point) const override { return hits[point].eta; }
  FlatMatrix<> PartnerMoves(const FacePair<D> & faces, size_t point, LocalHeap & lh) const override;
  void AddForces(size_t m, const MacroTraction<D> & traction, Scatter & y,
                 LocalHeap & lh) const override;
  void AddDerivatives(size_t m, const MacroTraction<D> & traction, Rim rim, MacroRows<D> & rows,
                      BlockSum & stiffness, LocalHeap & lh) const override;
  shared_ptr<const SlipPairs<D>> Pairs() const override {
    return make_shared<SlipPairs<D>>(this->points);
  }
  Vec<D> SlipOf(const SlipPairs<D> & pairs, size_t m) const override;
  void AddSlip(const SlipPairs<D> & pairs, size_t m, MacroRows<D> & rows,
               LocalHeap & lh) const override;
};

/// A tangential vector of the paired configuration, turned and stretched with the slave surface.
template <int D>
Vec<D> Carried(const Surface<D> & slave, const MacroPoints<D> & points, size_t macro,
               const Vec<D> & vector);
/// The same from one configuration to another one.
template <int D>
Vec<D> Carried(const Surface<D> & before, const Surface<D> & slave, const MacroPoints<D> & points,
               size_t macro, const Vec<D> & vector);
/// Subtracts its derivative from that of the slip.
template <int D>
void SubtractCarried(const FaceShapes<D> & slave, const MacroPoints<D> & points, size_t macro,
                     const Vec<D> & vector, MacroRows<D> & rows, LocalHeap & lh);
} // namespace ngslac
