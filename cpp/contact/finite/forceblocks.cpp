// SPDX-License-Identifier: LGPL-2.1-or-later
#include "forceblocks.hpp"

namespace ngslac {
void AddBlock(FlatArray<int> masters, FlatMatrix<> block, BlockSum & forces) {
  int n = masters.Size();
  ArrayMem<int, 100> order(n), sorted(n);
  for (int i : Range(n))
    order[i] = i;
  std::sort(order.begin(), order.end(), [&](int i, int j) { return masters[i] < masters[j]; });
  Matrix<> values(n, n);
  for (int j : Range(n)) {
    sorted[j] = masters[order[j]];
    values.Col(j) = block.Col(order[j]);
  }
  forces.Add(masters, sorted, std::move(values));
}

template <int D>
void AddStiffness(const Vec<D> & normal, const Vec<D> & traction, double pressure,
                  MacroRows<D> & rows, BlockSum & forces) {
  for (int j : Range(rows.turning)) {
    Vec<D> turn = rows.normal.Col(rows.Position(rows.turning[j]));
    double pressing = -InnerProduct(traction, turn);
    Vec<D> tilt = rows.tilt.Col(rows.Position(rows.turning[j]));
    Vec<D> even = pressing * normal + pressure * (turn + tilt);
    for (int i : Range(rows.dofs))
      rows.stiffness(i, j) += pressing * rows.squeeze(i) - InnerProduct(even, rows.force.Col(i));
  }
  forces.Add(rows.dofs, rows.turning, std::move(rows.stiffness));
}

template void AddStiffness(const Vec<2> &, const Vec<2> &, double, MacroRows<2> &, BlockSum &);
template void AddStiffness(const Vec<3> &, const Vec<3> &, double, MacroRows<3> &, BlockSum &);
} // namespace ngslac
