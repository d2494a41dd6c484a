#pragma once
#include "nodeorder.hpp"

namespace ngslac {
/// The rows of a system in blocks of nodes, in single precision: what counts is memory traffic.
class BlockedRows {
public:
  static constexpr int width = NodeOrder::width;
  /// What is beyond `width` is ignored: 4 numbers make a register.
  using Node = std::array<float, 4>;

  explicit BlockedRows(size_t count) : rows(count) {}

  /// Says whether the row differs from before.
  bool Fill(const Condensation & system, const NodeOrder & order, size_t row);
  /// The nodes coupled to one, which comes first.
  FlatArray<int> Columns(size_t row) const { return rows[row].columns; }
  /// Column by column.
  const float * Block(size_t row, size_t j) const { return &rows[row].blocks[width * width * j]; }
  Node Times(size_t row, FlatArray<Node> z) const;

private:
  struct Row {
    Array<int> columns;
    Array<float> blocks; // and one number more, which is read but not used
  };
  Array<Row> rows;
};
} // namespace ngslac
