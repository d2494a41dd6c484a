// SPDX-License-Identifier: LGPL-2.1-or-later
#include "tiemotion.hpp"
#include "facepair.hpp"

namespace ngslac {
namespace {
/// A point of the slave with its tangents and normal.
template <int D>
struct SlavePoint {
  Vec<D> x, normal;
  Mat<D, D - 1> dx;

  SlavePoint(const MovingSurfaces<D> & now, int face, const PairPoint<D> & p) {
    now.slave.Evaluate(face, p.slave, x, dx);
    normal = now.slave.Normal(face, dx);
  }
};

/// Adds what the points of one segment contribute, by scalar functions.
template <int D>
class SegmentTie {
  const MovingSurfaces<D> & now;
  const Segment & segment;
  FacePair<D> faces;
  int n1;                 // columns of the slave
  FlatMatrix<> columns;   // of the mean distance
  FlatMatrix<> stiffness; // by the functions of the slave

public:
  SegmentTie(const MovingSurfaces<D> & anow, const Segment & asegment, const MacroRows<D> & rows,
             LocalHeap & lh)
      : now(anow), segment(asegment), faces(now, segment, rows, lh), n1(D * faces.slaves),
        columns(D, faces.Size(), lh), stiffness(n1, n1, lh) {
    columns = 0.0, stiffness = 0.0;
  }

  void Add(const PairPoint<D> & p, double weight, const Vec<D> & traction, LocalHeap & lh) {
    SlavePoint<D> at(now, segment.slave, p);
    auto on_slave = now.slave_shapes.Calc(segment.slave, p.slave, lh);
    auto on_master = now.master_shapes.Calc(segment.master, p.master, lh);
    auto gradients = Gradients<D>(at.dx, on_slave, lh);
    for (int i : Range(faces.slaves))
      for (int k : Range(D)) {
        columns(k, D * i + k) += weight * on_slave.value(i);
        for (int l : Range(D))
          columns(l, D * i + k) -= weight * p.gap * at.normal(k) * gradients(i, l);
      }
    for (int i : Range(faces.masters))
      for (int k : Range(D))
        columns(k, n1 + D * i + k) -= weight * on_master.value(i);
    if (p.gap != 0 && IsTraction(traction))
      AddTurns(at.normal, gradients, p.weight * p.gap, traction);
  }

  void AddTo(MacroRows<D> & rows, bool loaded, LocalHeap & lh) const {
    auto & at = faces.at;
    auto of_dofs = faces.OfDofs(columns, lh);
    for (int l : Range(D))
      for (int j : Range(at))
        rows.slip(l, at[j]) += of_dofs(l, j);
    if (!loaded)
      return;
    FlatMatrix<> block(faces.Size(), faces.Size(), lh);
    block = 0.0;
    block.Rows(0, n1).Cols(0, n1) = stiffness;
    auto by_dofs = faces.BlockOfDofs(block, lh);
    auto slaves = faces.SlaveDofs();
    for (int j : Range(slaves))
      for (int i : Range(slaves))
        rows.stiffness(at[i], rows.TurningPosition(slaves[j])) += by_dofs(i, j);
  }

private:
  /// Of  - factor n . traction  the second derivative. By  -n_k g_i  the normal turns with function
  /// i in direction k; that turns with function j in direction l by
  ///   n_l (g_j)_k g_i + n_k (g_i)_l g_j - (g_i . g_j) n_k n_l n .
  void AddTurns(const Vec<D> & n, FlatMatrixFixWidth<D> g, double factor, const Vec<D> & traction) {
    double pressing = InnerProduct(n, traction);
    for (int i : Range(faces.slaves))
      for (int j : Range(faces.slaves)) {
        double one = InnerProduct(g.Row(i), traction), other = InnerProduct(g.Row(j), traction);
        double both = InnerProduct(g.Row(i), g.Row(j)) * pressing;
        for (int k : Range(D))
          for (int l : Range(D))
            stiffness(D * i + k, D * j + l) -=
                factor * (n(l) * g(j, k) * one + n(k) * g(i, l) * other - both * n(k) * n(l));
      }
  }
};
} // namespace

template <int D>
MacroTie<D> MeanTie(const MovingSurfaces<D> & now, const MacroPoints<D> & points, size_t macro) {
  MacroTie<D> mean{0.0, 0.0, 0.0};
  for (int s : points.segments[macro]) {
    auto & segment = points.pairing->segments[s];
    for (auto & p : points.pairing->points.Range(points.pairing->Points(s))) {
      SlavePoint<D> at(now, segment.slave, p);
      Vec<D> y;
      Mat<D, D - 1> dy;
      now.master.Evaluate(segment.master, p.master, y, dy);
      mean.apart += p.weight * (at.x + p.gap * at.normal - y);
      mean.normal += p.weight * at.normal;
      mean.gap += p.weight * InnerProduct(at.normal, y - at.x);
    }
  }
  double weight = 1 / points.area[macro];
  mean.apart *= weight, mean.gap *= weight;
  mean.normal *= 1 / L2Norm(mean.normal);
  return mean;
}

template <int D>
void AddTie(const MovingSurfaces<D> & now, const MacroPoints<D> & points, size_t macro,
            const Vec<D> & traction, MacroRows<D> & rows, LocalHeap & lh) {
  double mean = 1 / points.area[macro];
  for (int s : points.segments[macro]) {
    HeapReset hr(lh);
    SegmentTie<D> sum(now, points.pairing->segments[s], rows, lh);
    for (auto & p : points.pairing->points.Range(points.pairing->Points(s))) {
      HeapReset hr(lh);
      sum.Add(p, mean * p.weight, traction, lh);
    }
    sum.AddTo(rows, IsTraction(traction), lh);
  }
}

template <int D>
pair<Vec<D>, Vec<3>> TieResultant(const MovingSurfaces<D> & now, const MacroPoints<D> & points,
                                  size_t macro, const Vec<D> & traction) {
  Vec<D> arm = 0.0;
  for (int s : points.segments[macro])
    for (auto & p : points.pairing->points.Range(points.pairing->Points(s))) {
      SlavePoint<D> at(now, points.pairing->segments[s].slave, p);
      arm += p.weight * (now.slave.Origin() + at.x + p.gap * at.normal);
    }
  return {points.area[macro] * traction, Moment(arm, traction)};
}

#define INSTANTIATE(D)                                                                             \
  template MacroTie<D> MeanTie(const MovingSurfaces<D> &, const MacroPoints<D> &, size_t);         \
  template void AddTie(const MovingSurfaces<D> &, const MacroPoints<D> &, size_t, const Vec<D> &,  \
                       MacroRows<D> &, LocalHeap &);                                               \
  template pair<Vec<D>, Vec<3>> TieResultant(const MovingSurfaces<D> &, const MacroPoints<D> &,    \
                                             size_t, const Vec<D> &);
INSTANTIATE(2)
INSTANTIATE(3)
} // namespace ngslac
