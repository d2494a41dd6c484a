// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include "indexmap.hpp"
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
  NodeTerm(const LocalTerm & term, const NodeOrder & order) {
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
};

/// The rows of a system in blocks of nodes, in single precision: what counts is memory traffic.
///
/// Macro-elements are nodes, too. Their values are products of their local terms with the values of
/// the others; they have columns, after those of the bulk, but no rows.
class BlockedRows {
public:
  static constexpr int width = NodeOrder::width;
  /// Numbers beyond `width` are ignored: 4 of them make a register.
  using Node = std::array<float, 4>;

  /// The node's number in a local term.
  struct Link {
    int macro, place;
  };

  explicit BlockedRows(size_t count) : rows(count) {}

  size_t Size() const { return rows.Size(); }
  /// Says whether the row differs from before.
  bool Fill(const Condensation & system, const NodeOrder & order, size_t row,
            FlatArray<NodeTerm> terms, FlatArray<Link> links) {
    auto & bulk = system.Whole();
    IndexMap places;
    places.Position(row);
    auto dofs = order.dofs.Range(width * row, width * (row + 1));
    auto each = [&](auto f) {
      for (int k : Range(width))
        if (dofs[k] >= 0) {
          auto columns = bulk.GetRowIndices(dofs[k]);
          for (int j : Range(columns))
            if (int s = order.slot[columns[j]]; s >= 0)
              f(k, j, s);
        }
    };
    each([&](int, int, int s) { places.Position(s / width); });
    Array<int> columns(places.Indices());
    size_t inbulk = columns.Size(), all = inbulk + links.Size();
    Array<float> blocks(width * width * (all + links.Size()) + 1);
    blocks = 0.0f;
    each([&](int k, int j, int s) {
      size_t first = width * width * places.Find(s / width);
      blocks[first + width * (s % width) + k] = float(bulk.GetRowValues(dofs[k])(j));
    });
    for (int k : Range(width))
      if (dofs[k] < 0)
        blocks[width * k + k] = 1;
    for (size_t l : Range(links)) {
      auto & term = terms[links[l].macro];
      size_t first = width * width * links[l].place, size = width * width;
      columns.Append(rows.Size() + links[l].macro);
      std::copy_n(&term.left[first], size, &blocks[size * (inbulk + l)]);
      std::copy_n(&term.right[first], size, &blocks[size * (all + l)]);
    }
    bool differs = columns != rows[row].columns || blocks != rows[row].blocks;
    rows[row] = {inbulk, std::move(columns), std::move(blocks)};
    return differs;
  }

  /// The nodes coupled to one, which comes first; Size() + m for macro-elements m.
  FlatArray<int> Columns(size_t row) const { return rows[row].columns; }
  /// How many of them are in the bulk.
  size_t InBulk(size_t row) const { return rows[row].inbulk; }
  /// Column by column.
  const float * Block(size_t row, size_t j) const { return &rows[row].blocks[width * width * j]; }
  /// The node's contribution to a macro-element's value; j is the column of the macro-element.
  const float * Right(size_t row, size_t j) const {
    return Block(row, rows[row].columns.Size() + j - rows[row].inbulk);
  }

  /// Product with the values of nodes and macro-elements.
  Node Times(size_t row, FlatArray<Node> z) const { return Sum(row, z, Columns(row).Size()); }
  /// Product of the bulk alone.
  Node TimesBulk(size_t row, FlatArray<Node> z) const { return Sum(row, z, InBulk(row)); }
  /// Adds a step of the node to its own value and those of its macro-elements.
  void Step(size_t row, const Node & step, FlatArray<Node> z) const {
    auto columns = Columns(row);
    for (int k : Range(width))
      z[row][k] += step[k];
    for (size_t j = InBulk(row); j < columns.Size(); j++) {
      const float * block = Right(row, j);
      Node & value = z[columns[j]];
      for (int l : Range(width))
        for (int k : Range(value.size())) // the last block is followed by one number more
          value[k] += block[width * l + k] * step[l];
    }
  }

private:
  /// Rows are short: the processor's own prefetcher starts anew with each and comes too late. The
  /// block that lies this many numbers `ahead` is fetched in time.
  static constexpr size_t ahead = 1024;
  static void Prefetch([[maybe_unused]] const float * address) {
#ifdef __GNUC__ // and clang
    __builtin_prefetch(address);
#endif
  }

  struct Row {
    size_t inbulk = 0;
    Array<int> columns;
    Array<float> blocks; // and one number more, which is read but not used
  };
  // Inlined it is slower by a tenth: registers are few.
  [[gnu::noinline]] Node Sum(size_t row, FlatArray<Node> z, size_t end) const {
    constexpr int lanes = std::tuple_size<Node>();
    auto & [inbulk, columns, blocks] = rows[row];
    float sum[2 * width][lanes] = {}; // for each column, by turns: none waits for the others
    auto add = [&](size_t j, auto * sum) {
      const float * block = blocks.Data() + width * width * j;
      Prefetch(block + ahead);
      const Node & value = z[columns[j]];
      for (int l : Range(width))
        for (int k : Range(lanes))
          sum[l][k] += block[width * l + k] * value[l];
    };
    size_t j = 0;
    for (; j + 1 < end; j += 2) {
      add(j, sum);
      add(j + 1, sum + width);
    }
    if (j < end)
      add(j, sum);
    Node total;
    static_assert(width == 3);
    for (int k : Range(lanes))
      total[k] = (sum[0][k] + sum[3][k]) + (sum[1][k] + sum[4][k]) + (sum[2][k] + sum[5][k]);
    return total;
  }

  Array<Row> rows;
};
} // namespace ngslac
