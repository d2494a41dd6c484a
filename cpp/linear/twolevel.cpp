// SPDX-License-Identifier: LGPL-2.1-or-later
#include "twolevel.hpp"

namespace ngslac {
TwoLevel::TwoLevel(const Condensation & system, shared_ptr<StarSweeps> asweeps,
                   shared_ptr<BaseMatrix> acoarse, FlatArray<int> dofs)
    : SquareOperator(system), sweeps(asweeps), coarse(acoarse) {
  if (size_t(coarse->VHeight()) != dofs.Size())
    throw Exception("TwoLevel: " + ToString(dofs.Size()) + " dofs for a coarse operator of size " +
                    ToString(coarse->VHeight()));
  auto & slot = sweeps->Order().slot;
  for (int i : Range(dofs))
    if (dofs[i] < 0 || size_t(dofs[i]) >= slot.Size() || slot[dofs[i]] < 0)
      throw Exception("TwoLevel: dof " + ToString(dofs[i]) + " of the coarse system is not free");
    else
      places.Append({slot[dofs[i]], i});
  QuickSort(places);
}

void TwoLevel::Correct(FlatArray<Node> b, FlatArray<Node> z) const {
  auto left = coarse->CreateColVector(), correction = coarse->CreateRowVector();
  auto node = [&](size_t i) { return size_t(places[i].first) / width; };
  ParallelFor(places.Size(), [&](size_t i) {
    if (i && node(i - 1) == node(i))
      return; // the first dof of a node does it for all
    Node product = sweeps->Rows().Times(node(i), z);
    for (size_t j = i; j < places.Size() && node(j) == node(i); j++) {
      auto [slot, dof] = places[j];
      left.FV<double>()(dof) = b[slot / width][slot % width] - product[slot % width];
    }
  });
  coarse->Mult(left, correction);
  ParallelFor(places.Size(), [&](size_t i) {
    auto [slot, dof] = places[i];
    z[slot / width][slot % width] += float(correction.FV<double>()(dof));
  });
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
