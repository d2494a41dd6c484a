// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include "condense.hpp"
#include "nodeorder.hpp"

namespace ngslac {
/// The local term of a macro-element by nodes, in single precision:  left right.
///
/// The products  right z  make a node of their own: at most `width` numbers.
struct NodeTerm {
  static constexpr int width = NodeOrder::width;

  Array<int> nodes;
  Array<float> left, right; // a block for each node, column by column

  NodeTerm() = default;
  NodeTerm(const LocalTerm & term, const NodeOrder & order);
};

/// Of all macro-elements.
Array<NodeTerm> NodeTerms(const Condensation & system, const NodeOrder & order);
} // namespace ngslac
