// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include "distance.hpp"
#include "pairing/boxtree.hpp"

namespace ngslac {
/// Triangles, in 2D edges, around a tool: their corners are numbers of points, ordered so that
/// normals point out of it (2D: counterclockwise around the tool).
template <int D>
struct FacetList {
  Array<Vec<D>> points;
  Array<std::array<int, D>> corners;
};

/// A tool whose surface consists of plane facets, with the exact signed distance.
///
/// The sign follows from the normal at the nearest point: of a facet, and on edges and at
/// vertices the sum of those around, at vertices weighted by the angles (Baerentzen and Aanaes
/// 2005).
template <int D>
class Facets final : public SignedDistance<D> {
  /// Where the nearest point lies: inside of a facet, at one of its vertices, on one of its edges.
  enum class On { facet, vertex, edge };
  struct Foot {
    Vec<D> point;
    int facet;
    On on;
    int number;    // of the vertex, or of the edge opposite to it, in the facet
    double square; // of the distance
  };

  FacetList<D> list;
  double size;                                         // of all
  Array<Vec<D>> normals, vertex_normals, edge_normals; // edges: D for each facet
  BoxTree<D> tree;

public:
  /// Throws where the surface is open (unless that is allowed), turned inside out, or no surface.
  Facets(FacetList<D> alist, bool closed);
  Nearness<D> At(const Vec<D> & x) const override;
  Mat<D, D> Hessian(const Vec<D> & x) const override;

private:
  void SetNormals();
  void SetEdgeNormals();
  double VolumeInside() const;
  double AngleAt(int facet, int corner) const;
  Vec<D> Corner(int facet, int i) const { return list.points[list.corners[facet][i]]; }
  Foot Nearest(const Vec<D> & x) const;
  Foot FootOn(int facet, const Vec<D> & x) const;
  /// Out of the tool where the nearest point lies.
  const Vec<D> & NormalAt(const Foot & foot) const;
};
} // namespace ngslac
