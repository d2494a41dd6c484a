// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include "pairing/pairing.hpp"

namespace ngslac {
/// Makes the weights of a pairing in the current configuration those of areas in the reference one.
template <int D>
void CountReferenceAreas(const Surface<D> & reference, const Surface<D> & current,
                         Pairing<D> & pairing);
} // namespace ngslac
