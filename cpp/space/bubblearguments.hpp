// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include "given.hpp"

namespace ngslac {
/// The flags of BubbleVectorH1, where names of boundaries stand for themselves. Throws for those
/// that NGSolve falls over, or takes without a word.
py::dict CheckedBubbleArguments(const Given<shared_ptr<MeshAccess>> & mesh,
                                const py::kwargs & flags);
} // namespace ngslac
