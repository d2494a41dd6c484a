// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
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

/// The rows of a system in blocks of nodes, in single precision: what counts is memory traffic.
///
/// Macro-elements are nodes, too, whose values are what their local terms make of the others:
/// they have columns, after those of the bulk, but no rows.
class BlockedRows {
public:
  static constexpr int width = NodeOrder::width;
  /// What is beyond `width` is ignored: 4 numbers make a register.
  using Node = std::array<float, 4>;

  /// The node's number in a local term.
  struct Link {
    int macro, place;
  };

  explicit BlockedRows(size_t count) : rows(count) {}

  size_t Size() const { return rows.Size(); }
  /// Says whether the row differs from before.
  bool Fill(const Condensation & system, const NodeOrder & order, size_t row,
            FlatArray<NodeTerm> terms, FlatArray<Link> links);
  /// The nodes coupled to one, which comes first; Size() + m for macro-elements m.
  FlatArray<int> Columns(size_t row) const { return rows[row].columns; }
  /// How many of them are in the bulk.
  size_t InBulk(size_t row) const { return rows[row].inbulk; }
  /// Column by column.
  const float * Block(size_t row, size_t j) const { return &rows[row].blocks[width * width * j]; }
  /// What the node adds to a macro-element's value; j is the latter's column.
  const float * Right(size_t row, size_t j) const {
    return Block(row, rows[row].columns.Size() + j - rows[row].inbulk);
  }
  /// Product with the values of nodes and macro-elements.
  Node Times(size_t row, FlatArray<Node> z) const { return Sum(row, z, Columns(row).Size()); }
  /// Product of the bulk alone.
  Node TimesBulk(size_t row, FlatArray<Node> z) const { return Sum(row, z, InBulk(row)); }
  /// Adds a step of the node to its own value and those of its macro-elements.
  void Step(size_t row, const Node & step, FlatArray<Node> z) const;

private:
  struct Row {
    size_t inbulk = 0;
    Array<int> columns;
    Array<float> blocks; // and one number more, which is read but not used
  };
  Node Sum(size_t row, FlatArray<Node> z, size_t end) const;

  Array<Row> rows;
};
} // namespace ngslac
