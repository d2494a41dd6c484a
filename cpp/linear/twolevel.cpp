#include "twolevel.hpp"

namespace ngslac {
TwoLevel::TwoLevel(const Condensation & system, shared_ptr<BaseMatrix> acoarse,
                   const SparseRows & rows, FlatArray<int> dofs)
    : SquareOperator(system), order(system), coarse(acoarse),
      prolongation(rows, dofs, order.slot, acoarse->VHeight()) {
  static Timer timer("ngslac::TwoLevel - setup");
  RegionTimer reg(timer);
  AllocateTriangles();
  std::atomic<bool> singular = false;
  ParallelForRange(order.Size(), [&](IntRange range) {
    IndexMap places;
    for (size_t row : range) {
      FillRow(system, row, places);
      for (int k : Range(width))
        if (!(diagonal[row][width * k + k] > 0))
          singular = true;
    }
  });
  if (singular)
    throw Exception("ngslac: the matrix has a diagonal entry that is not positive");
  ParallelFor(order.Size(), [&](size_t row) {
    Mat<width, width> block;
    for (int k : Range(width))
      for (int l : Range(width))
        block(k, l) = diagonal[row][width * l + k];
    block = Inv(block);
    for (int k : Range(width))
      for (int l : Range(width))
        diagonal[row][width * l + k] = float(block(k, l));
  });
}

void TwoLevel::AllocateTriangles() {
  size_t n = order.Size();
  diagonal.SetSize(n);
  for (auto triangle : {&lower, &upper}) {
    triangle->first.SetSize(n + 1);
    triangle->first[0] = 0;
  }
  for (size_t row : Range(n)) {
    size_t below = 0;
    for (size_t column : order.coupled[row])
      below += column < row;
    lower.first[row + 1] = lower.first[row] + below;
    upper.first[row + 1] = upper.first[row] + order.coupled[row].Size() - below;
  }
  for (auto triangle : {&lower, &upper}) {
    triangle->columns.SetSize(triangle->first[n]);
    triangle->blocks.SetSize(triangle->first[n]);
  }
}

void TwoLevel::FillRow(const Condensation & system, size_t row, IndexMap & places) {
  ArrayMem<Block *, 100> blocks{&diagonal[row]};
  places.Clear();
  places.Position(row);
  size_t below = lower.first[row], above = upper.first[row];
  for (size_t column : order.coupled[row]) {
    auto & triangle = column < row ? lower : upper;
    size_t j = (column < row ? below : above)++;
    triangle.columns[j] = column;
    triangle.blocks[j] = {};
    places.Position(column);
    blocks.Append(&triangle.blocks[j]);
  }
  diagonal[row] = {};
  auto entries = [&](int column, auto set) {
    if (int s = order.slot[column]; s >= 0)
      set(blocks[places.Find(s / width)]->data() + width * (s % width));
  };
  auto dofs = order.dofs.Range(width * row, width * (row + 1));
  auto columns = system.Columns(dofs[0]);
  bool equal = dofs.Last() >= 0;
  for (int k : Range(1, width))
    equal = equal && system.Columns(dofs[k]) == columns;
  if (equal) {
    FlatVector<> values[] = {system.Values(dofs[0]), system.Values(dofs[1]),
                             system.Values(dofs[2])};
    for (int j : Range(columns))
      entries(columns[j], [&](float * entry) {
        for (int k : Range(width))
          entry[k] = float(values[k](j));
      });
    return;
  }
  for (int k : Range(width)) {
    if (dofs[k] < 0) {
      diagonal[row][width * k + k] = 1;
      continue;
    }
    auto columns = system.Columns(dofs[k]);
    auto values = system.Values(dofs[k]);
    for (int j : Range(columns))
      entries(columns[j], [&](float * entry) { entry[k] = float(values(j)); });
  }
}

auto TwoLevel::Triangle::Times(size_t row, FlatArray<Node> z) const -> Node {
  float sum[width][width] = {}; // one for each column: none waits for the others
  for (size_t j : Range(first[row], first[row + 1])) {
    const Block & block = blocks[j];
    const Node & value = z[columns[j]];
    for (int l : Range(width))
      for (int k : Range(width))
        sum[l][k] += block[width * l + k] * value[l];
  }
  Node total{};
  for (int l : Range(width))
    for (int k : Range(width))
      total[k] += sum[l][k];
  return total;
}

/// D^-1 (right - product)
auto TwoLevel::Solved(size_t row, Node right, const Node & product) const -> Node {
  Node solution{};
  for (int l : Range(width)) {
    right[l] -= product[l];
    for (int k : Range(width))
      solution[k] += diagonal[row][width * l + k] * right[l];
  }
  return solution;
}

/// After a sweep  (L + D) z = b  what is left is  - U z.
void TwoLevel::Correct(FlatArray<Node> z) const {
  auto slots = prolongation.Slots();
  Array<float> left(slots.Size());
  ParallelFor(slots.Size(), [&](size_t i) {
    bool repeated = i && slots[i] / width == slots[i - 1] / width;
    if (repeated)
      return;
    Node product = upper.Times(slots[i] / width, z);
    for (size_t j = i; j < slots.Size() && slots[j] / width == slots[i] / width; j++)
      left[j] = -product[slots[j] % width];
  });
  auto rhs = coarse->CreateColVector(), solution = coarse->CreateRowVector();
  prolongation.Restrict(left, rhs.FV<double>());
  coarse->Mult(rhs, solution);
  prolongation.Add(solution.FV<double>(), [&](int slot, float value) {
    z[slot / width][slot % width] += value;
  });
}

void TwoLevel::Apply(const BaseVector & x, BaseVector & y, BaseVector * image) const {
  static Timer timer("ngslac::TwoLevel");
  RegionTimer reg(timer);
  auto from = x.FV<double>(), to = y.FV<double>();
  Array<Node> b(order.Size()), z(order.Size());
  ParallelFor(order.Size(), [&](size_t row) {
    for (int k : Range(width))
      if (int dof = order.dofs[width * row + k]; dof >= 0)
        b[row][k] = float(from(dof));
      else
        b[row][k] = 0;
  });
  auto sweep = [&](int colour, auto && f) {
    auto & chunks = order.chunks[colour];
    ParallelJob([&](TaskInfo info) { f(chunks[info.task_nr]); }, chunks.Size());
  };
  for (int colour : {0, 1})
    sweep(colour, [&](IntRange chunk) {
      for (size_t row : chunk)
        z[row] = Solved(row, b[row], lower.Times(row, z));
    });
  Correct(z);
  Array<Node> before;
  if (image)
    before = z;
  for (int colour : {1, 0})
    sweep(colour, [&](IntRange chunk) {
      for (size_t row = chunk.end(); row-- > chunk.begin();) {
        Node product = lower.Times(row, z), above = upper.Times(row, z);
        for (int k : Range(width))
          product[k] += above[k];
        z[row] = Solved(row, b[row], product);
      }
    });
  auto scatter = [&](FlatArray<Node> nodes, FlatVector<> values) {
    ParallelFor(values.Size(), [&](size_t i) {
      int s = order.slot[i];
      values(i) = s >= 0 ? nodes[s / width][s % width] : 0;
    });
  };
  scatter(z, to);
  if (!image)
    return;
  // (D + U) z = b - L (z before the sweep)
  auto subtract = [](Node value, const Node & other) {
    for (int k : Range(width))
      value[k] -= other[k];
    return value;
  };
  ParallelFor(z.Size(), [&](size_t row) { before[row] = subtract(before[row], z[row]); });
  ParallelFor(z.Size(), [&](size_t row) { z[row] = subtract(b[row], lower.Times(row, before)); });
  scatter(z, image->FV<double>());
}

void TwoLevelProduct::Mult(const BaseVector & x, BaseVector & y) const {
  auto z = CreateRowVector();
  pre->Apply(x, z, &y);
  system->ToImage(z.FV<double>(), y.FV<double>());
}
} // namespace ngslac
