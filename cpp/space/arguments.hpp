// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include "argument.hpp"
#include "lacspace.hpp"

namespace ngslac {
/// The arguments of LACSpace as the caller passed them.
struct SpaceArguments {
  Argument<shared_ptr<FESpace>> displacement;
  Argument<std::variant<Region, string>> slave;
  Argument<std::vector<int>> macros;
  Argument<int> components;
  Argument<bool> autoupdate;
  Argument<bool> axisymmetric;

  shared_ptr<LACSpace> Make() const;
};

/// A number of components, checked.
int CheckedComponents(const Argument<int> & components);

/// An up to date space.
shared_ptr<LACSpace> MakeSpace(shared_ptr<FESpace> displacement, const Flags & flags,
                               optional<MacroPartition> taken = nullopt);
} // namespace ngslac
