#pragma once
#include "contactform.hpp"

namespace ngslac {
/// The states that `AppendState` has written; throws if that was not all.
Array<MacroState> StatesFrom(FlatArray<double> flat);
} // namespace ngslac
