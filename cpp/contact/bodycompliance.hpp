// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include "faceshapes.hpp"

namespace ngslac {
/// A surface with the traces of the displacement on it.
template <int D>
struct SurfaceShapes {
  const FaceShapes<D> & shapes;
  const Surface<D> & surface;
};

/// The mean of the diagonal over the components of each node, which no rotation changes.
template <int D>
Vector<> DiagonalOfNodes(const FaceShapes<D> & shapes, const Surface<D> & surface,
                         FlatVector<> diagonal);

/// The share of the master in the stiffness of both bodies, from the diagonal of their matrix: 1
/// where it is rigid, half where nothing is known. The size of elements has no part in it.
template <int D>
double MasterShare(const ProxyInfo & u, SurfaceShapes<D> slave, SurfaceShapes<D> master,
                   FlatVector<> diagonal);
} // namespace ngslac
