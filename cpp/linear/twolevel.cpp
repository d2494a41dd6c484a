// SPDX-License-Identifier: LGPL-2.1-or-later
#include "twolevel.hpp"

namespace ngslac {
TwoLevel::TwoLevel(const Condensation & system, shared_ptr<StarSweeps> asweeps,
                   shared_ptr<BaseMatrix> acoarse, const SparseRows & rows, FlatArray<int> dofs)
    : SquareOperator(system), sweeps(asweeps), coarse(acoarse),
      prolongation(rows, dofs, asweeps->Order().slot, acoarse->VHeight()) {}

void TwoLevel::Correct(FlatArray<Node> b, FlatArray<Node> z) const {
  auto slots = prolongation.Slots();
  Array<float> left(slots.Size());
  ParallelFor(slots.Size(), [&](size_t i) {
    size_t node = slots[i] / width;
    if (i && size_t(slots[i - 1]) / width == node)
      return; // the first slot of a node does it for all
    Node product = sweeps->Rows().Times(node, z);
    for (size_t j = i; j < slots.Size() && size_t(slots[j]) / width == node; j++)
      left[j] = b[node][slots[j] % width] - product[slots[j] % width];
  });
  auto rhs = coarse->CreateColVector(), solution = coarse->CreateRowVector();
  prolongation.Restrict(left, rhs.FV<double>());
  coarse->Mult(rhs, solution);
  prolongation.Add(solution.FV<double>(),
                   [&](int slot, float value) { z[slot / width][slot % width] += value; });
  sweeps->SetMacroValues(z);
}

void TwoLevel::Mult(const BaseVector & x, BaseVector & y) const {
  static Timer timer("ngslac::TwoLevel");
  RegionTimer reg(timer);
  Array<Node> b(sweeps->Order().Size()), z(sweeps->NValues());
  sweeps->Gather(x.FV<double>(), b);
  ParallelFor(z.Size(), [&](size_t row) { z[row].fill(0); });
  sweeps->Sweep(b, z, false);
  Correct(b, z);
  sweeps->Sweep(b, z, true);
  sweeps->Scatter(z, y.FV<double>());
}

void TwoLevel::MultBulk(const BaseVector & x, BaseVector & y) const {
  static Timer timer("ngslac::TwoLevel - bulk");
  RegionTimer reg(timer);
  Array<Node> z(sweeps->Order().Size()), image(z.Size());
  sweeps->Gather(x.FV<double>(), z);
  ParallelFor(z.Size(), [&](size_t row) { image[row] = sweeps->Rows().TimesBulk(row, z); });
  sweeps->Scatter(image, y.FV<double>());
}

void TwoLevelProduct::Apply(const BaseVector & x, BaseVector & z, BaseVector & image) const {
  pre->Mult(x, z);
  system->Project(z.FV<double>());
  pre->MultBulk(z, image);
  system->ToImage(z.FV<double>(), image.FV<double>());
}
} // namespace ngslac
