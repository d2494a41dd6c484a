// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include "surface/surface.hpp"

namespace ngslac {
/// Faces whose normals are less than 100 degrees apart do not touch.
constexpr double facing_cosine = -0.17;

/// A quadrature point of a slave face, and the point of the master face opposite to it.
template <int D>
struct PairPoint {
  Vec<D - 1> slave, master; // reference coordinates on the two faces
  double weight;            // slave area
  double gap;               // along the slave normal, > 0 open
  Vec<D> normal;            // out of the slave body
};

/// A part of a slave face that faces one master face; master -1 stands for an obstacle.
struct Segment {
  int slave, master;
  size_t first;        // number of its first point
  size_t first_corner; // number of its first corner
};

/// A point where a master face ends within a slave face, for integrals over moving segments.
/// The master ends there, or goes on with another normal, or the view of a face behind it begins.
template <int D>
struct RimPoint {
  int segment;
  PairPoint<D> point;
  Vec<D - 1> outwards; // normal in reference coordinates, times length and quadrature weight
  int beyond = -1;     // the master face that follows there; -1: none
  Vec<D - 1> eta = Vec<D - 1>(0.0); // the point there on the same ray
  double step = 0;                  // gap to that face minus the gap to this one
};

struct PairingOptions {
  double maxdist;     // farthest opening, along the slave normal
  double penetration; // deepest interpenetration
  int order;          // total degree of polynomials that the quadrature is for, on one segment
  std::function<bool(int slave, int master)> maypair; // null: all faces
  // deepest interpenetration of each slave face; empty: `penetration` for all
  Array<double> depths = Array<double>();
  bool backs = false; // may the normals of both faces point the same way, too?

  double Penetration(int slave_face) const {
    return depths.Size() ? depths[slave_face] : penetration;
  }
  /// May two faces touch if their normals have this product?
  bool MayFace(double cosine) const {
    return cosine <= facing_cosine || (backs && cosine >= -facing_cosine);
  }
};

/// Options for a search. A distance of 0 is replaced: the limit of openings by the size of both
/// surfaces together, that of interpenetration by a tenth of the slave's, at most `maxdist`.
template <int D>
PairingOptions SearchOptions(const Surface<D> & slave, const Surface<D> & master, double maxdist,
                             double penetration, int order);

/// Segments sorted by slave face (and along it), with their quadrature points.
template <int D>
struct Pairing {
  Array<Segment> segments; // one more at the end marks the end of the points
  Array<PairPoint<D>> points;
  Array<PairPoint<D>> corners; // corners of the overlap, without weights: for pictures
  Array<RimPoint<D>> rim;

  size_t Size() const { return segments.Size() - 1; }
  IntRange Points(size_t segment) const {
    return IntRange(segments[segment].first, segments[segment + 1].first);
  }
  IntRange Corners(size_t segment) const {
    return IntRange(segments[segment].first_corner, segments[segment + 1].first_corner);
  }
  /// Which of the `nfaces` faces of one side have segments?
  BitArray UsedFaces(size_t nfaces, int Segment::* face) const {
    BitArray used(nfaces);
    used.Clear();
    for (size_t s : Range(Size()))
      used.SetBit(segments[s].*face);
    return used;
  }
};

/// Cuts every slave face into segments, each facing the nearest master face along the slave normal.
/// Parts that are farther than the limits are cut off.
///
/// 2D: master end points are projected onto the slave face along its normal, so that each ray from
/// a segment meets exactly one master face and the segments tile the overlap. 3D: slave faces are
/// divided into nearly flat facets, on whose planes the master facets are cut out (Puso and Laursen
/// 2004); the pieces tile the slave face. Faces whose normals point the same way pair only with
/// `backs`. The time is O(n log n) in the number of faces. The number of threads does not change
/// the result.
template <int D>
Pairing<D> Pair(const Surface<D> & slave, const Surface<D> & master,
                const PairingOptions & options);

/// Pairs every slave face as a whole with an obstacle; the caller sets the gaps.
template <int D>
Pairing<D> PairWithObstacle(const Surface<D> & slave, int order);

/// Segments as plain numbers, for pictures.
struct SegmentTable {
  Array<double> values;  // slave and master boundary element (-1: obstacle), area, mean gap
  Array<double> corners; // slave point, master point, slave point, ...
  Array<size_t> first;   // first corner of each segment; one more marks the end
};

/// Quadrature points as plain numbers, a row each: slave and master boundary element (-1:
/// obstacle), reference coordinates on both (2 each), weight, gap, normal, position on the slave.
template <int D>
Array<double> MakePointTable(const Pairing<D> & pairing, const Surface<D> & slave,
                             const Surface<D> * master);

template <int D>
SegmentTable MakeSegmentTable(const Pairing<D> & pairing, const Surface<D> & slave,
                              const Surface<D> * master);
} // namespace ngslac
