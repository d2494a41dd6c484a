// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include "pairing/pairing.hpp"
#include "space/lacspace.hpp"

namespace ngslac {
/// Do both regions share faces?
bool Overlap(const Region & slave, const Region & master);

/// Faces that share a node do not touch each other: the filter of the search.
template <int D>
std::function<bool(int, int)> NotNeighbours(const Surface<D> & slave, const Surface<D> & master,
                                            const MeshAccess & ma);

/// How thick the element behind each face is, in the configuration of the mesh.
template <int D>
Array<double> Thicknesses(const Surface<D> & surface, const MeshAccess & ma);

/// Macro-elements in the order in which they are reached along the surface.
Array<int> AlongSurface(const LACSpace & space);

/// Where two parts of one surface face each other only one of them is the slave.
///
/// Of two macro-elements that see each other within reach of their size the one that comes first
/// keeps its segments: those in `closed`, then the others along the surface, so that slaves make up
/// connected parts.
template <int D>
void KeepOneSide(Pairing<D> & pairing, const Surface<D> & slave, const Surface<D> & master,
                 const LACSpace & space, FlatArray<int> along, const BitArray & closed);
} // namespace ngslac
