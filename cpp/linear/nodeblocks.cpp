// SPDX-License-Identifier: LGPL-2.1-or-later
#include "condense.hpp"

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

/// Of each local term the positions of dofs among the nodes on which it depends.
Array<Array<int>> Positions(const Condensation & system, FlatArray<int> place) {
  auto terms = system.Terms();
  Array<Array<int>> positions(terms.Size());
  ParallelFor(terms.Size(), [&](size_t m) {
    for (int j : Range(terms[m].dofs))
      if (place[terms[m].dofs[j]] >= 0 && L2Norm2(terms[m].right.Col(j)) > 0)
        positions[m].Append(j);
  });
  return positions;
}

/// Blocks of one row of nodes, summed up.
class NodeRow {
  int width;
  IndexMap columns;
  Array<double> blocks;

public:
  explicit NodeRow(int awidth) : width(awidth) {}
  void Start(int node) {
    columns.Clear();
    columns.Position(node);
    blocks.SetSize(width * width);
    blocks = 0.0;
  }
  /// An entry of the k-th row, at a place among the nodes.
  void Add(int k, int at, double value) {
    size_t first = width * width * columns.Position(at / width);
    while (blocks.Size() < first + width * width)
      blocks.Append(0.0);
    blocks[first + width * k + at % width] += value;
  }
  /// Columns in ascending order, and their blocks.
  SparseRow Sorted() const {
    SparseRow row{Array<int>(columns.Indices()), Array<double>(blocks.Size())};
    QuickSort(row.columns);
    for (int j : Range(row.columns))
      std::copy_n(&blocks[width * width * columns.Find(row.columns[j])], width * width,
                  &row.values[width * width * j]);
    return row;
  }
};
} // namespace

BlockRows NodeBlocks(const Condensation & system, FlatArray<int> nodes, int width) {
  static Timer timer("ngslac::NodeBlocks");
  RegionTimer reg(timer);
  auto place = Places(system, nodes);
  auto positions = Positions(system, place);
  auto fill = [&](NodeRow & row, int dof, int k) {
    auto columns = system.Whole().GetRowIndices(dof);
    auto values = system.Whole().GetRowValues(dof);
    for (int j : Range(columns))
      if (int at = place[columns[j]]; at >= 0)
        row.Add(k, at, values(j));
    for (int m : system.Touching()[dof]) {
      auto & term = system.Terms()[m];
      auto left = term.left.Row(term.Position(dof));
      if (L2Norm2(left) > 0)
        for (int j : positions[m])
          row.Add(k, place[term.dofs[j]], InnerProduct(left, term.right.Col(j)));
    }
  };
  Array<SparseRow> found(nodes.Size() / width);
  ParallelForRange(found.Size(), [&](IntRange range) {
    NodeRow row(width);
    for (int node : range) {
      row.Start(node);
      for (int k : Range(width))
        if (int dof = nodes[width * node + k]; dof >= 0 && place[dof] >= 0)
          fill(row, dof, k);
        else
          row.Add(k, width * node + k, 1);
      found[node] = row.Sorted();
    }
  });
  BlockRows rows;
  rows.width = width;
  rows.starts.Append(0);
  for (auto & row : found)
    rows.starts.Append(rows.starts.Last() + row.columns.Size());
  rows.columns.SetSize(rows.starts.Last());
  rows.values.SetSize(width * width * rows.columns.Size());
  ParallelFor(found.Size(), [&](size_t i) {
    rows.columns.Range(rows.starts[i], rows.starts[i + 1]) = found[i].columns;
    std::copy(found[i].values.begin(), found[i].values.end(),
              rows.values.begin() + size_t(width * width) * rows.starts[i]);
  });
  return rows;
}
} // namespace ngslac
