// SPDX-License-Identifier: LGPL-2.1-or-later
#include "nodeorder.hpp"
#include "indexmap.hpp"

namespace ngslac {
namespace {
constexpr size_t most_chunks = 64;

/// Appends the nodes that hang together with `start`, and where each level begins.
void Search(FlatArray<Array<int>> neighbours, int start, Array<int> & level, Array<int> & nodes,
            Array<int> & begins) {
  size_t next = nodes.Size();
  level[start] = 0;
  nodes.Append(start);
  for (int current = -1; next < nodes.Size(); next++) {
    int node = nodes[next];
    if (level[node] != current) {
      begins.Append(next);
      current = level[node];
    }
    for (int other : neighbours[node])
      if (level[other] < 0) {
        level[other] = current + 1;
        nodes.Append(other);
      }
  }
}

/// The nodes in the order of a breadth-first search, and where each level begins.
std::pair<Array<int>, Array<int>> SearchAll(FlatArray<Array<int>> neighbours) {
  Array<int> level(neighbours.Size()), nodes, begins, ignored;
  level = -1;
  for (int i : Range(neighbours))
    if (level[i] < 0) {
      // The last node found lies at the rim: from there the levels are smaller.
      size_t before = nodes.Size();
      Search(neighbours, i, level, nodes, ignored);
      int start = nodes.Last();
      for (int k : Range(before, nodes.Size()))
        level[nodes[k]] = -1;
      nodes.SetSize(before);
      Search(neighbours, start, level, nodes, begins);
    }
  begins.Append(neighbours.Size());
  return {std::move(nodes), std::move(begins)};
}

/// Levels, or several of them where they are small; one where chunks are coupled across others, as
/// they may be where a node has a neighbour that does not have it.
Array<IntRange> Chunks(FlatArray<Array<int>> neighbours, FlatArray<int> nodes,
                       FlatArray<int> begins) {
  size_t count = nodes.Size();
  Array<IntRange> chunks;
  Array<int> number(count);
  size_t begin = 0;
  for (size_t end : begins)
    if (end > begin && ((end - begin) * most_chunks >= count || end == count)) {
      for (size_t k : Range(begin, end))
        number[nodes[k]] = chunks.Size();
      chunks.Append(IntRange(begin, end));
      begin = end;
    }
  std::atomic<bool> far = false;
  ParallelFor(count, [&](size_t i) {
    for (int j : neighbours[i])
      if (std::abs(number[i] - number[j]) > 1)
        far = true;
  });
  if (far) {
    chunks.SetSize0();
    chunks.Append(IntRange(0, count));
  }
  return chunks;
}
} // namespace

Levels::Levels(FlatArray<Array<int>> neighbours) {
  auto [found, begins] = SearchAll(neighbours);
  chunks = Chunks(neighbours, found, begins);
  nodes = std::move(found);
}

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
