// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include "surface/surface.hpp"

namespace ngslac {
/// A nearly flat part of a face, by which overlaps are found: a triangle or quadrilateral with
/// straight sides in space and in the reference coordinates of its face.
struct Facet {
  int face;
  bool whole;    // all of its face
  int n;         // 3 or 4 corners, in the order of the reference orientation
  Vec<2> xi[4];  // reference coordinates of the corners
  Vec<3> x[4];   // and their positions
  Vec<3> normal; // out of the body
  double size;   // largest distance of two corners

  Vec<3> Center() const;
  /// Reference coordinates for barycentric (n = 3) or square coordinates of the facet.
  Vec<2> Reference(Vec<2> local) const;
};

/// The facets of all faces: a face as it is if it is (nearly) straight, else divided evenly. Facets
/// of one face tile its reference element, so that no part of the surface is lost.
class Facets {
  Array<size_t> first;
  Array<Facet> facets;

public:
  explicit Facets(const Surface<3> & surface);
  FlatArray<Facet> Of(size_t face) const { return facets.Range(first[face], first[face + 1]); }
};
} // namespace ngslac
