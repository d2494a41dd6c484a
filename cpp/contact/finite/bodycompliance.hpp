#pragma once
#include "contact/faceshapes.hpp"

namespace ngslac {
/// How the body behind a surface gives way, up to a factor that does not depend on the mesh: from
/// the diagonal of its matrix. What is prescribed does not give way.
template <int D>
double BodyCompliance(const ProxyInfo & u, const FaceShapes<D> & shapes, const Surface<D> & surface,
                      FlatVector<> diagonal);
} // namespace ngslac
