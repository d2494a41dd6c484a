#pragma once
#include "pairing/pairing.hpp"
#include "space/lacspace.hpp"

namespace ngslac {
/// Means of a function over the macro-elements; throws where it is negative or not finite.
Array<double> MacroMeans(const CoefficientFunction & function, const LACSpace & space,
                         const string & name);

/// Fills the gaps of a pairing with an obstacle from a function on the slave surface.
template <int D>
void SetObstacleGaps(const CoefficientFunction & gap, const MeshAccess & ma,
                     const Surface<D> & slave, Pairing<D> & pairing);
} // namespace ngslac
