// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include "faceshapes.hpp"

namespace ngslac {
/// The images of a master surface where the displacement is periodic: translations of it that the
/// slave meets beyond the seam, the same in each configuration.
template <int D>
class Periods {
  Array<Vec<D>> periods;             // none: nothing is periodic
  Array<std::array<int, D>> numbers; // of each image, how many periods it is away
  Array<Vec<D>> shifts;              // of each image

public:
  Periods() = default;
  /// Of the identifications of the mesh on which the displacement has the same dofs; those of the
  /// master count, and where it has none those of the slave. `strict`: throws where they are no
  /// translations.
  Periods(const ProxyInfo & u, const Surface<D> & slave, const Surface<D> & master, bool strict);

  /// Finds the images that the slave is near in this configuration, besides those that are known.
  /// Says whether there are new ones.
  bool Find(const Surface<D> & slave, const Surface<D> & master);
  /// Appends the images that a surface lacks; its shapes, if there are any, get them, too.
  void Complete(Surface<D> & master, FaceShapes<D> * shapes = nullptr) const;
};
} // namespace ngslac
