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
void MacroEnds<D>::Clear(FlatArray<int> multipliers, SparseMatrix<double> & mat) const {
  for (size_t n : Range(rows))
    for (int i : rows[n].dofs) {
      for (int j : rows[n].dofs)
        mat(i, j) = 0;
      for (int lam : multipliers.Range(D * numbers[n], D * (numbers[n] + 1)))
        mat(i, lam) = mat(lam, i) = 0;
    }
}

template <int D>
void MacroEnds<D>::SetLines(size_t m, const MacroLaw<D> & law, const MacroJump<D> & jump,
                            const Vec<D> & direction, const ngbla::Mat<D, D> & projection,
                            SparseMatrix<double> & mat) const {
  auto & own = rows[place[m]];
  auto spread = law.Spread(m, own.points);
  auto lam = law.dofs.Range(D * m, D * (m + 1));
  auto block = law.EndBlock(m, direction, jump.RowArea(m), projection, spread);
  auto factor = law.EndFactor(m, direction);
  ngbla::Mat<D, D> along = Id<D>() - direction * Trans(direction);
  ngbla::Mat<D, D> slides = factor * projection * along;
  Vec<D> presses = spread.c / law.c[m] * (factor * Vec<D>(projection * direction));
  for (int k : Range(D))
    for (int l : Range(D))
      mat(lam[k], lam[l]) = block(k, l);

  Matrix<> integrals(own.dofs.Size(), D);
  integrals = 0.0;
  for (auto & e : jump.Row(m))
    integrals.Row(own.PositionOf(e.dof)) = e.integral;
  auto pressed = own.Pressed(spread);
  auto stiffness = own.Stiffness(spread);
  for (size_t i : Range(own.dofs)) {
    Vec<D> integral = integrals.Row(i), slid = slides * integral;
    Vec<D> force = along * integral + pressed(i) * direction;
    for (int k : Range(D)) {
      mat(own.dofs[i], lam[k]) = -force(k);
      mat(lam[k], own.dofs[i]) = -slid(k) - pressed(i) * presses(k);
    }
    for (size_t j : Range(own.dofs))
      mat(own.dofs[i], own.dofs[j]) += stiffness(i, j);
  }
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
