// SPDX-License-Identifier: LGPL-2.1-or-later
#include "macroends.hpp"
#include "macrotables.hpp"

namespace ngslac {
template <int D>
MacroEnds<D>::MacroEnds(const LACSpace & space, const ProxyInfo & u, const Paired<D> & surfaces,
                        std::function<Pairing<D>(const BitArray &)> points,
                        FlatArray<Vec<D>> direction, FlatVector<> x)
    : place(space.NMacros()) {
  auto & slave = *surfaces.slave;
  auto & master = *surfaces.master;
  shares = EndShares(space, slave, master, *surfaces.pairing, *surfaces.jump);
  place = -1;
  for (size_t m : Range(shares))
    if (shares[m] > 0) {
      place[m] = numbers.Size();
      numbers.Append(m);
    }
  if (!numbers.Size())
    return;
  BitArray faces(slave.Size());
  faces.Clear();
  for (size_t f : Range(slave.Size()))
    if (place[space.MacroOfFace()[slave.Element(f)]] >= 0)
      faces.SetBit(f);
  auto pairing = points(faces);
  auto segments = SegmentsOfMacros<D>(space, slave, pairing);
  faces = pairing.UsedFaces(master.Size(), &Segment::master);
  FaceShapes<D> master_shapes(u, master, max(1, u.Order(master)), &faces);
  faces = pairing.UsedFaces(slave.Size(), &Segment::slave);
  FaceShapes<D> slave_shapes(u, slave, max(1, u.Order(slave)), &faces);
  rows.SetSize(numbers.Size());
  ParallelFor(numbers.Size(), [&](size_t i) {
    size_t m = numbers[i];
    rows[i] = EndRows<D>(segments[m], pairing, slave_shapes, master_shapes, slave, direction[m]);
    rows[i].Blend(shares[m], surfaces.jump->area[m]);
    rows[i].CountFrom(x);
  });
}

template <int D>
Array<FlatArray<int>> MacroEnds<D>::Dofs(size_t nmacros) const {
  Array<FlatArray<int>> dofs(nmacros);
  for (size_t i : Range(rows))
    dofs[numbers[i]].Assign(rows[i].dofs);
  return dofs;
}

template <int D>
void MacroEnds<D>::Look(const MacroLaw<D> & law, FlatArray<Vec<D>> direction, FlatVector<> x) {
  ParallelFor(rows.Size(), [&](size_t i) {
    size_t m = numbers[i];
    rows[i].Look(x, law.Clearance(m), law.GivenPressure(m, direction[m], x));
  });
}

template <int D>
void MacroEnds<D>::AddForces(size_t m, const MacroLaw<D> & law, Scatter & y) const {
  auto & own = rows[place[m]];
  auto forces = own.Forces(law.Spread(m, own.points));
  for (size_t j : Range(own.dofs))
    y.Add(own.dofs[j], forces(j));
}

template <int D>
Vec<D> MacroEnds<D>::MomentOf(size_t m, const MacroLaw<D> & law) const {
  auto & own = rows[place[m]];
  return own.MomentOf(law.Spread(m, own.points));
}

template <int D>
PlaceRows<D> MacroEnds<D>::RowsOf(size_t m, const MacroLaw<D> & law, const MacroJump<D> & jump,
                                  const Vec<D> & direction, BlockSum & stiffness) const {
  auto & own = rows[place[m]];
  auto spread = law.Spread(m, own.points);
  PlaceRows<D> result(own.dofs);
  result.force = 0.0;
  for (auto & e : jump.Row(m))
    result.force.Col(own.PositionOf(e.dof)) =
        e.integral - InnerProduct(e.integral, direction) * direction;
  auto pressed = own.Pressed(spread);
  for (size_t i : Range(own.dofs))
    result.force.Col(i) += pressed(i) * direction;
  result.jump = (1 / jump.area[m]) * result.force;
  stiffness.Add(own.dofs, own.dofs, own.Stiffness(spread));
  return result;
}

template <int D>
Array<double> MacroEnds<D>::Save() const {
  Array<double> saved;
  for (auto & own : rows) {
    saved.Append(own.points.given);
    saved += own.points.gap;
  }
  return saved;
}

template <int D>
void MacroEnds<D>::Load(FlatArray<double> saved) {
  size_t at = 0;
  for (auto & own : rows) {
    own.points.given = saved[at++];
    for (double & gap : own.points.gap)
      gap = saved[at++];
  }
}

template class MacroEnds<2>;
template class MacroEnds<3>;
} // namespace ngslac
