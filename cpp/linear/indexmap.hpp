// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <bla.hpp>

namespace ngslac {
using namespace ngbla;

/// Positions 0, 1, 2, ... of indices in the order in which they first appear.
///
/// What sums up a row needs the place of each of its columns. An array as long as the matrix, one
/// for each thread, would answer at once, but it costs more than all rows of a small contact.
/// Linear probing in a table at most half full; Clear costs nothing.
class IndexMap {
  struct Slot {
    unsigned round = 0; // in use if it is the current one
    int position = 0;
  };
  Array<Slot> slots;
  Array<int> indices;
  unsigned round = 1;
  int shift = 0;

public:
  IndexMap() { Allocate(6); }

  FlatArray<int> Indices() const { return indices; }
  /// -1 if the index did not appear.
  int Find(int index) const {
    auto & slot = slots[SlotOf(index)];
    return slot.round == round ? slot.position : -1;
  }
  /// Appends the index unless it is there.
  int Position(int index) {
    size_t s = SlotOf(index);
    if (IsUsed(s))
      return slots[s].position;
    indices.Append(index);
    slots[s] = {round, int(indices.Size()) - 1};
    if (2 * indices.Size() > slots.Size())
      Grow();
    return indices.Size() - 1;
  }
  void Clear() {
    indices.SetSize0();
    if (++round == 0) // after 4e9 times
      Allocate(32 - shift);
  }

private:
  bool IsUsed(size_t slot) const { return slots[slot].round == round; }

  /// Where the index is, or belongs.
  size_t SlotOf(int index) const {
    size_t slot = (unsigned(index) * 2654435769u) >> shift;
    while (IsUsed(slot) && indices[slots[slot].position] != index)
      slot = (slot + 1) & (slots.Size() - 1);
    return slot;
  }

  void Allocate(int bits) {
    shift = 32 - bits;
    round = 1;
    slots.SetSize(size_t(1) << bits);
    slots = Slot();
  }

  void Grow() {
    Allocate(33 - shift);
    for (int i : Range(indices))
      slots[SlotOf(indices[i])] = {round, i};
  }
};

/// A sparse row that is summed up.
class RowSum {
  IndexMap positions;
  Array<double> values;

public:
  void Add(int column, double value) {
    size_t position = positions.Position(column);
    if (position == values.Size())
      values.Append(value);
    else
      values[position] += value;
  }
  double operator[](int column) const {
    int position = positions.Find(column);
    return position >= 0 ? values[position] : 0;
  }
  FlatArray<int> Columns() const { return positions.Indices(); }
  FlatArray<double> Values() const { return values; }
  void Clear() {
    positions.Clear();
    values.SetSize0();
  }
};

/// Columns and values.
struct SparseRow {
  Array<int> columns;
  Array<double> values;

  void SetEntries(FlatArray<std::pair<int, double>> entries) {
    columns.SetSize(entries.Size());
    values.SetSize(entries.Size());
    for (size_t j : Range(entries))
      std::tie(columns[j], values[j]) = entries[j];
  }
};

/// Calls f(i, sum) for all i, in parallel, with one RowSum per range.
template <typename F>
void ForEachSum(size_t count, F f) {
  ParallelForRange(count, [&](IntRange range) {
    RowSum sum;
    for (auto i : range)
      f(i, sum);
  });
}
} // namespace ngslac
