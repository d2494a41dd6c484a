#include "nodeblocks.hpp"
#include "indexmap.hpp"

namespace ngslac {
namespace {
/// Place of each free dof among the nodes, or -1.
Array<int> Places(const Condensation & system, FlatArray<int> nodes) {
  Array<int> place(system.VHeight());
  place = -1;
  for (int i : Range(nodes))
    if (int dof = nodes[i]; dof >= 0) {
      if (dof >= int(place.Size()) || place[dof] >= 0)
        throw Exception("NodeBlocks: dof " + ToString(dof) + " is not there, or in two nodes");
      if (system.Free()->Test(dof))
        place[dof] = i;
    }
  return place;
}

/// The nodes that are coupled to each one, itself among them.
Array<Array<int>> Coupled(const Condensation & system, FlatArray<int> nodes, FlatArray<int> place,
                          int width) {
  Array<Array<int>> coupled(nodes.Size() / width);
  ParallelForRange(coupled.Size(), [&](IntRange range) {
    IndexMap found;
    for (int node : range) {
      found.Clear();
      found.Position(node);
      for (int dof : nodes.Range(width * node, width * (node + 1)))
        if (dof >= 0 && place[dof] >= 0)
          for (int j : system.Columns(dof))
            if (place[j] >= 0)
              found.Position(place[j] / width);
      coupled[node] = found.Indices();
      QuickSort(coupled[node]);
    }
  });
  return coupled;
}
} // namespace

BlockRows NodeBlocks(const Condensation & system, FlatArray<int> nodes, int width) {
  static Timer timer("ngslac::NodeBlocks");
  RegionTimer reg(timer);
  auto place = Places(system, nodes);
  auto coupled = Coupled(system, nodes, place, width);
  BlockRows rows;
  rows.width = width;
  rows.starts.Append(0);
  for (auto & columns : coupled)
    rows.starts.Append(rows.starts.Last() + columns.Size());
  rows.columns.SetSize(rows.starts.Last());
  rows.values.SetSize(width * width * rows.columns.Size());
  ParallelForRange(coupled.Size(), [&](IntRange range) {
    IndexMap found;
    for (int node : range) {
      found.Clear();
      auto columns = rows.columns.Range(rows.starts[node], rows.starts[node + 1]);
      columns = coupled[node];
      for (int column : columns)
        found.Position(column);
      double * blocks = &rows.values[size_t(width * width) * rows.starts[node]];
      std::fill_n(blocks, width * width * columns.Size(), 0.0);
      for (int k : Range(width)) {
        int dof = nodes[width * node + k];
        if (dof < 0 || place[dof] < 0) {
          blocks[width * (width * found.Find(node) + k) + k] = 1;
          continue;
        }
        auto others = system.Columns(dof);
        auto values = system.Values(dof);
        for (int j : Range(others))
          if (int at = place[others[j]]; at >= 0)
            blocks[width * (width * found.Find(at / width) + k) + at % width] += values(j);
      }
    }
  });
  return rows;
}
} // namespace ngslac
