// SPDX-License-Identifier: LGPL-2.1-or-later
#include "nodeorder.hpp"
#include "indexmap.hpp"
#include "levels.hpp"

namespace ngslac {
namespace {
constexpr int width = NodeOrder::width;

using Node = std::array<int, width>; // its dofs, or -1

/// Node of each dof, -1 for others, and the nodes.
std::pair<Array<int>, Array<Node>> Nodes(const Condensation & system, const BitArray & which) {
  auto & graph = system.Whole();
  size_t n = graph.Height();
  if (which.Size() != n)
    throw Exception("NodeOrder: " + ToString(which.Size()) + " bits for " + ToString(n) + " rows");
  Array<std::pair<size_t, int>> keys(n); // hash of the row without multipliers, dof
  ParallelFor(n, [&](size_t i) {
    size_t hash = 0;
    if (which.Test(i))
      for (int j : graph.GetRowIndices(i))
        if (which.Test(j))
          hash = 31 * hash + j + 1;
    keys[i] = {hash, which.Test(i) ? int(i) : -1};
  });
  std::sort(keys.begin(), keys.end());
  Array<int> node(n);
  node = -1;
  Array<Node> nodes;
  int members = width;
  size_t last = 0;
  for (auto [hash, i] : keys)
    if (i >= 0) {
      if (members == width || hash != last) {
        Node empty;
        empty.fill(-1);
        nodes.Append(empty);
        members = 0;
      }
      nodes.Last()[members++] = i;
      node[i] = nodes.Size() - 1;
      last = hash;
    }
  return {std::move(node), std::move(nodes)};
}

/// The other nodes in the rows of each node.
Array<Array<int>> Neighbours(const Condensation & system, FlatArray<int> node,
                             FlatArray<Node> nodes) {
  Array<Array<int>> neighbours(nodes.Size());
  ParallelForRange(nodes.Size(), [&](IntRange range) {
    IndexMap found;
    for (int m : range) {
      found.Clear();
      FlatArray<int> before(0, nullptr);
      for (int i : nodes[m])
        if (i >= 0) {
          auto columns = system.Whole().GetRowIndices(i);
          if (columns != before)
            for (int j : columns)
              if (int other = node[j]; other >= 0 && other != m)
                found.Position(other);
          before.Assign(columns);
        }
      neighbours[m] = found.Indices();
    }
  });
  return neighbours;
}
} // namespace

NodeOrder::NodeOrder(const Condensation & system, const BitArray & which) {
  auto [node, nodes] = Nodes(system, which);
  Levels levels(Neighbours(system, node, nodes));
  slot.SetSize(node.Size());
  slot = -1;
  dofs.SetSize(width * nodes.Size());
  ParallelFor(nodes.Size(), [&](size_t p) {
    for (int k : Range(width)) {
      int dof = dofs[width * p + k] = nodes[levels.nodes[p]][k];
      if (dof >= 0)
        slot[dof] = width * p + k;
    }
  });
}
} // namespace ngslac
