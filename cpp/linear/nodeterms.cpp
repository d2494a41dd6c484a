// SPDX-License-Identifier: LGPL-2.1-or-later
#include "nodeterms.hpp"
#include "indexmap.hpp"

namespace ngslac {
NodeTerm::NodeTerm(const LocalTerm & term, const NodeOrder & order) {
  if (term.left.Width() > width)
    throw Exception("StarSweeps: a macro-element has more than " + ToString(width) +
                    " multipliers");
  IndexMap places;
  auto each = [&](auto f) {
    for (int j : Range(term.dofs))
      if (int s = order.slot[term.dofs[j]]; s >= 0)
        for (int k : Range(term.left.Width()))
          if (term.left(j, k) != 0 || term.right(k, j) != 0)
            f(j, k, s);
  };
  each([&](int, int, int s) { places.Position(s / width); });
  nodes = places.Indices();
  left.SetSize(width * width * nodes.Size());
  right.SetSize(left.Size());
  left = right = 0.0f;
  each([&](int j, int k, int s) {
    int first = width * width * places.Find(s / width), i = s % width;
    left[first + width * k + i] = float(term.left(j, k));
    right[first + width * i + k] = float(term.right(k, j));
  });
}

Array<NodeTerm> NodeTerms(const Condensation & system, const NodeOrder & order) {
  auto given = system.Terms();
  Array<NodeTerm> terms(given.Size());
  ParallelFor(terms.Size(), [&](size_t m) { terms[m] = NodeTerm(given[m], order); });
  return terms;
}
} // namespace ngslac
