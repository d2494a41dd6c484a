// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include "given.hpp"
#include "lacspace.hpp"

namespace ngslac {
/// The arguments of LACSpace as they were given.
struct SpaceArguments {
  Given<shared_ptr<FESpace>> displacement;
  Given<std::variant<Region, string>> slave;
  Given<std::vector<int>> macros;
  Given<int> components;
  Given<bool> autoupdate;

  shared_ptr<LACSpace> Make() const;
};

/// A number of components, checked.
int CheckedComponents(const Given<int> & components);

/// An up to date space.
shared_ptr<LACSpace> MakeSpace(shared_ptr<FESpace> displacement, const Flags & flags,
                               optional<MacroPartition> taken = nullopt);
} // namespace ngslac
