// SPDX-License-Identifier: LGPL-2.1-or-later
#include "tiescene.hpp"
#include "facepair.hpp"

namespace ngslac {
namespace {
/// Calls f with the segments of a macro-element, and with the points of each and their old pairs.
template <int D, typename F>
void ForPairs(const MeshScene<D> & now, const MacroPoints<D> & points, size_t m, F f) {
  for (int s : points.segments[m])
    for (auto & p : points.pairing->points.Range(points.pairing->Points(s)))
      f(p, OldPair<D>(now, points.pairing->segments[s], p));
}

/// Integral over a segment of how x + g n - y moves with the functions of both faces.
template <int D>
FlatMatrix<> Motion(const MeshScene<D> & now, const Pairing<D> & pairing, int s,
                    const FacePair<D> & faces, LocalHeap & lh) {
  FlatMatrix<> columns(D, faces.Size(), lh);
  columns = 0.0;
  auto & segment = faces.segment;
  for (auto & p : pairing.points.Range(pairing.Points(s))) {
    HeapReset hr(lh);
    OldPair<D> old(now, segment, p);
    auto on_slave = now.slave_shapes.Calc(segment.slave, p.slave, lh);
    auto on_master = now.master_shapes->Calc(segment.master, p.master, lh);
    auto gradients = Gradients<D>(old.dx, on_slave, lh);
    for (int i : Range(faces.slaves))
      for (int k : Range(D)) {
        columns(k, D * i + k) += p.weight * on_slave.value(i);
        for (int l : Range(D))
          columns(l, D * i + k) -= p.weight * p.gap * old.slave_normal(k) * gradients(i, l);
      }
    for (int i : Range(faces.masters))
      for (int k : Range(D))
        columns(k, D * (faces.slaves + i) + k) -= p.weight * on_master.value(i);
  }
  return columns;
}

/// Adds the second derivative of  - factor n . traction . By  -n_k g_i  the normal turns with
/// function i in direction k; that turns with function j in direction l by
///   n_l (g_j)_k g_i + n_k (g_i)_l g_j - (g_i . g_j) n_k n_l n .
template <int D>
void AddTurns(const Vec<D> & n, FlatMatrixFixWidth<D> g, double factor, const Vec<D> & traction,
              FlatMatrix<> block) {
  double pressing = InnerProduct(n, traction);
  for (int i : Range(g.Height()))
    for (int j : Range(g.Height())) {
      double one = InnerProduct(g.Row(i), traction), other = InnerProduct(g.Row(j), traction);
      double both = InnerProduct(g.Row(i), g.Row(j)) * pressing;
      for (int k : Range(D))
        for (int l : Range(D))
          block(D * i + k, D * j + l) -=
              factor * (n(l) * g(j, k) * one + n(k) * g(i, l) * other - both * n(k) * n(l));
    }
}
} // namespace

template <int D>
MacroGap<D> TieScene<D>::MeanOf(size_t m) {
  double gap = 0;
  Vec<D> normal = 0.0;
  ForPairs(*this, *this->points, m, [&](const PairPoint<D> & p, const OldPair<D> & old) {
    normal += p.weight * old.slave_normal;
    gap += p.weight * (old.gap - InnerProduct(old.slave_normal, old.apart));
  });
  double mean = 1 / this->points->area[m];
  return {mean * gap, mean * normal, Vec<D>(0.0), 0.0};
}

template <int D>
Vec<D> TieScene<D>::SlipOf(const SlipPairs<D> & pairs, size_t m) const {
  Vec<D> sum = 0.0;
  ForPairs(*this, *pairs.points, m,
           [&](const PairPoint<D> & p, const OldPair<D> & old) { sum += p.weight * old.apart; });
  return 1 / pairs.points->area[m] * sum;
}

template <int D>
void TieScene<D>::AddSlip(const SlipPairs<D> & pairs, size_t m, MacroRows<D> & rows,
                          LocalHeap & lh) const {
  auto & points = *pairs.points;
  for (int s : points.segments[m]) {
    HeapReset hr(lh);
    FacePair<D> faces(*this, points.pairing->segments[s], rows, lh);
    faces.AddTo(rows.slip, Motion(*this, *points.pairing, s, faces, lh), 1 / points.area[m], lh);
  }
}

template <int D>
void TieScene<D>::AddForces(size_t m, const MacroTraction<D> & traction, Scatter & y,
                            LocalHeap & lh) const {
  auto & points = *this->points;
  Vec<D> same = traction.At(this->mean[m].normal);
  for (int s : points.segments[m]) {
    HeapReset hr(lh);
    FacePair<D> faces(this->slave_shapes, this->master_shapes, points.pairing->segments[s], lh);
    auto of_dofs = faces.OfDofs(Motion(*this, *points.pairing, s, faces, lh), lh);
    for (int j : Range(faces.at))
      y.Add(faces.Dof(j), -InnerProduct(same, Vec<D>(of_dofs.Col(j))));
  }
}

template <int D>
void TieScene<D>::AddDerivatives(size_t m, const MacroTraction<D> & traction, Rim,
                                 MacroRows<D> & rows, BlockSum &, LocalHeap & lh) const {
  if (traction.IsZero())
    return;
  auto & points = *this->points;
  Vec<D> same = traction.At(this->mean[m].normal);
  for (int s : points.segments[m]) {
    HeapReset hr(lh);
    auto & segment = points.pairing->segments[s];
    FacePair<D> faces(*this, segment, rows, lh);
    FlatMatrix<> block(faces.Size(), faces.Size(), lh);
    block = 0.0;
    for (auto & p : points.pairing->points.Range(points.pairing->Points(s))) {
      HeapReset hr(lh);
      OldPair<D> old(*this, segment, p);
      auto shapes = this->slave_shapes.Calc(segment.slave, p.slave, lh);
      if (p.gap != 0)
        AddTurns(old.slave_normal, Gradients<D>(old.dx, shapes, lh), p.weight * p.gap, same, block);
    }
    auto by_dofs = faces.BlockOfDofs(block, lh);
    auto slaves = Range(faces.SlaveDofs());
    for (int j : slaves)
      for (int i : slaves)
        rows.stiffness(faces.at[i], rows.TurningPosition(faces.Dof(j))) += by_dofs(i, j);
  }
}

template <int D>
pair<Vec<D>, Vec<3>> TieScene<D>::Resultant(size_t m, const MacroTraction<D> & traction) const {
  Vec<D> arm = 0.0, same = traction.At(this->mean[m].normal);
  ForPairs(*this, *this->points, m, [&](const PairPoint<D> & p, const OldPair<D> & old) {
    arm += p.weight * (this->slave.Origin() + old.x + old.gap * old.slave_normal);
  });
  return {this->points->area[m] * same, Moment(arm, same)};
}

template class TieScene<2>;
template class TieScene<3>;
} // namespace ngslac
