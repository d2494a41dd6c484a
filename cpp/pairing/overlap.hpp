// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include "pairing.hpp"

namespace ngslac {
/// A part of a slave face that lies behind a master face, at most by `depth`.
struct DeepPart {
  int slave, master;
  double depth; // against the slave normal
};

/// Where slave faces lie behind the master deeper than a limit: the nearest of all master faces
/// behind them looks their way, and none is much nearer in another direction. Searched without
/// limit, for faces that may pair; a limit for each slave face.
template <int D>
Array<DeepPart> DeepParts(const Surface<D> & slave, const Surface<D> & master,
                          std::function<bool(int slave, int master)> maypair,
                          FlatArray<double> limits);

/// How thick the body behind each face is at most, against its normal: up to the nearest of other
/// faces that may count; infinite where there is none.
template <int D>
Array<double> ThicknessesBehind(const Surface<D> & surface, const Surface<D> & others,
                                std::function<bool(int face, int other)> maycount);
} // namespace ngslac
