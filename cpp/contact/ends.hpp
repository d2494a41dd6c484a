// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include "jump.hpp"

namespace ngslac {
/// How far contact ends inside of each macro-element of the slave, 0 to 1.
///
/// 1 where the master ends inside of it, or at its border with faces of the slave beyond, or where
/// the slave ends on a master that goes on. 0 elsewhere, and where both surfaces end at the same
/// place, or where they part before they end, as round ones do. It changes continuously with the
/// places of the ends: it falls while an end of the master goes on through the neighbour.
template <int D>
Array<double> EndShares(const LACSpace & space, const Surface<D> & slave, const Surface<D> & master,
                        const Pairing<D> & pairing, const MacroJump<D> & jump);
} // namespace ngslac
