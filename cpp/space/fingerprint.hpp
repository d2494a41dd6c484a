// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <comp.hpp>

namespace ngslac {
using namespace ngcomp;

/// A number that differs, all but surely, for spaces that number the dofs of their elements, volume
/// and boundary, in different ways.
size_t DofFingerprint(const FESpace & space);
} // namespace ngslac
