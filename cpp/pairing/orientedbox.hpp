// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <bla.hpp>
#include <gprim/geomobjects.hpp>

namespace ngslac {
using namespace ngbla;

/// A box with axes of any direction: the query for faces that are oblique to the coordinate axes.
template <int D>
struct OrientedBox {
  Vec<D> center;
  Vec<D> axes[D]; // orthonormal
  double half[D]; // extents from the center along the axes

  /// Grows by a point (around the center as it is).
  void Add(Vec<D> point) {
    for (int i = 0; i < D; i++)
      half[i] = std::max(half[i], fabs(InnerProduct(axes[i], point - center)));
  }

  /// False only if one of the faces of the two boxes separates them.
  bool Intersect(const netgen::Box<D> & box) const {
    Vec<D> distance, extent;
    for (int k = 0; k < D; k++) {
      distance(k) = 0.5 * (box.PMin()(k) + box.PMax()(k)) - center(k);
      extent(k) = 0.5 * (box.PMax()(k) - box.PMin()(k));
    }
    for (int i = 0; i < D; i++) {
      double across = fabs(InnerProduct(distance, axes[i])), along = fabs(distance(i));
      for (int k = 0; k < D; k++) {
        across -= fabs(axes[i](k)) * extent(k);
        along -= fabs(axes[k](i)) * half[k];
      }
      if (across > half[i] || along > extent(i))
        return false;
    }
    return true;
  }
};
} // namespace ngslac
