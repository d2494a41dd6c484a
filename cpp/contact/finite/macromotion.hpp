// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include "contact/direction.hpp"
#include "contact/faceshapes.hpp"
#include "contact/place.hpp"
#include "linear/scatter.hpp"
#include "ray.hpp"

namespace ngslac {
/// Both surfaces in one configuration, and how they move with the dofs.
template <int D>
struct MovingSurfaces {
  const FaceShapes<D> & slave_shapes;
  const FaceShapes<D> & master_shapes;
  Surface<D> slave, master;
  double share; // of the master in the stiffness of both
};

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

template <int D>
struct MacroGap;

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
  /// Of all that the law looks at, at this normal, slip and gap; the slip may have a part along the
  /// normal.
  PlaceRows<D> OfPlace(const Vec<D> & n, const Vec<D> & slipped, double opened) const;
  int Position(int dof) const { return PositionIn(dofs, dof); }
  int TurningPosition(int dof) const { return PositionIn(turning, dof); }

private:
  static int PositionIn(FlatArray<int> sorted, int dof) {
    return std::lower_bound(sorted.begin(), sorted.end(), dof) - sorted.begin();
  }
};

/// Is there any? Squares of what is tiny would say no.
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

/// A block of the derivative of the contact forces at fixed pressure and tangential traction, for
/// the dofs of a master face.
using MasterBlock = std::function<void(FlatArray<int> master, FlatMatrix<> block)>;

/// The hits of all points of the pairing that belong to the macro-element are set, too.
template <int D>
MacroGap<D> MeanGap(const MovingSurfaces<D> & now, const MacroPoints<D> & points, size_t macro,
                    FlatArray<RayHit<D>> hits);

/// Derivatives of gap, normal and forces at this mean; of the forces only if there are any.
/// `moving_rim`: the overlap changes where the master ends, which the value at fixed points does
/// not see.
template <int D>
void AddDerivatives(const MovingSurfaces<D> & now, const MacroPoints<D> & points, size_t macro,
                    FlatArray<RayHit<D>> hits, const MacroGap<D> & mean,
                    const MacroTraction<D> & traction, bool moving_rim, MacroRows<D> & rows,
                    const MasterBlock & add, LocalHeap & lh);

/// Subtracts the virtual work of a traction.
template <int D>
void AddTraction(const MovingSurfaces<D> & now, const MacroPoints<D> & points, size_t macro,
                 FlatArray<RayHit<D>> hits, const MacroTraction<D> & traction, Scatter & y,
                 LocalHeap & lh);

/// Resultant of a traction on the slave, and its moment about the origin (2D: the last component).
template <int D>
pair<Vec<D>, Vec<3>> Resultant(const Surface<D> & slave, const MacroPoints<D> & points,
                               size_t macro, const MacroTraction<D> & traction);

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

/// How far the slave slid along the master since the points were paired: the mean of the part of
/// x + g n - y  across the contact direction, with the gap g and the partner y of the pairing.
/// Rigid motions of both bodies do not change it, and what comes nearer in that direction does not
/// slip.
template <int D>
Vec<D> MeanSlip(const MovingSurfaces<D> & now, const MacroPoints<D> & points, size_t macro);
/// Adds its derivative to that of the slip.
template <int D>
void AddSlip(const MovingSurfaces<D> & now, const MacroPoints<D> & points, size_t macro,
             MacroRows<D> & rows, LocalHeap & lh);
} // namespace ngslac
