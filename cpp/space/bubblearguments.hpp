// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include "given.hpp"

namespace ngslac {
/// Throws for arguments of BubbleVectorH1 that NGSolve falls over, or takes without a word.
void CheckBubbleArguments(const Given<shared_ptr<MeshAccess>> & mesh, const py::kwargs & flags);
} // namespace ngslac
