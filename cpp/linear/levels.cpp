// SPDX-License-Identifier: LGPL-2.1-or-later
#include "levels.hpp"

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
} // namespace ngslac
