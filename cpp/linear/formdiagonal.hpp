// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <comp.hpp>

namespace ngslac {
using namespace ngcomp;

/// Diagonal of the derivative of a form at zero, by element matrices of the volume: what is
/// condensed has a part in it as everything else. Scalar entries, those of other dofs than `wanted`
/// are not complete.
Vector<> FormDiagonal(const BilinearForm & form, const BitArray & wanted);
} // namespace ngslac
