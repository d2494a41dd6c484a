// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include "pairing/pairing.hpp"
#include "space/lacspace.hpp"

namespace ngslac {
/// Numbers of things that belong to slave faces, macro-element by macro-element.
template <int D, typename FACE>
Table<int> OfMacros(size_t n, FACE face, const Surface<D> & slave, const LACSpace & space) {
  TableCreator<int> creator(space.NMacros());
  for (; !creator.Done(); creator++)
    for (int i : Range(n))
      creator.Add(space.MacroOfFace()[slave.Element(face(i))], i);
  return creator.MoveTable();
}

template <int D>
Table<int> SegmentsOfMacros(const LACSpace & space, const Surface<D> & slave,
                            const Pairing<D> & pairing) {
  auto face = [&](int i) { return pairing.segments[i].slave; };
  return OfMacros<D>(pairing.Size(), face, slave, space);
}
} // namespace ngslac
