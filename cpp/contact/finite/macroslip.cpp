// SPDX-License-Identifier: LGPL-2.1-or-later
#include "collectedshapes.hpp"
#include "facepair.hpp"

namespace ngslac {
namespace {
/// The derivative of the slip by the scalar functions of one side: they move the points apart by
/// `moves` times their value, and by `swings` times the turn of the side's normal; that has the
/// factor `turns` in the contact direction.
template <int D>
class SlipSide {
  static constexpr int R = D - 1;
  CollectedShapes<D> shapes;
  double moves;
  FlatMatrix<> by_value, by_derivative; // factors: a row for each point, and for its derivatives
  FlatMatrix<> sums;                    // row D l + k: of component l by component k

public:
  SlipSide(const FaceShapes<D> & all, int face, double amoves, LocalHeap & lh)
      : shapes(all, face, lh), moves(amoves), by_value(shapes.most_points, D * D, lh),
        by_derivative(R * shapes.most_points, D * D, lh), sums(D * D, shapes.Size(), lh) {
    sums = 0.0;
  }

  void Add(Vec<R> xi, const OldPair<D> & old, double weight, double turns, double swings,
           const Vec<D> & normal, const Mat<D, R> & tangents) {
    int i = shapes.NPoints();
    shapes.Add(xi);
    auto & n = old.direction.normal;
    Mat<D, D> across = old.direction.Across();
    // the normal turns by  -g  times the component of the displacement along it
    Mat<D, R> turn = across * DualBasis<D>(tangents);
    Vec<R> apart = Trans(turn) * old.apart;
    Mat<D, R> turning = turns * (InnerProduct(n, old.apart) * turn + n * Trans(apart));
    turning -= swings * turn;
    for (int l : Range(D))
      for (int k : Range(D)) {
        by_value(i, D * l + k) = weight * moves * across(l, k);
        for (int c : Range(R))
          by_derivative(R * i + c, D * l + k) = weight * turning(l, c) * normal(k);
      }
    if (shapes.IsFull())
      Multiply();
  }

  /// Columns by function and component.
  void AddTo(FlatMatrix<> columns, int first) {
    Multiply();
    for (int i : Range(sums.Width()))
      for (int l : Range(D))
        for (int k : Range(D))
          columns(l, first + D * i + k) += sums(D * l + k, i);
  }

private:
  void Multiply() {
    int npoints = shapes.NPoints();
    if (npoints == 0)
      return;
    shapes.Evaluate();
    sums += Trans(by_value.Rows(0, npoints)) * shapes.Values();
    sums += Trans(by_derivative.Rows(0, R * npoints)) * shapes.Derivatives();
    shapes.Clear();
  }
};
} // namespace

template <int D>
Vec<D> MeshScene<D>::SlipOf(const SlipPairs<D> & pairs, size_t m) const {
  auto & points = pairs.points->pairing->points;
  return ngslac::MeanOf(*pairs.points, m, [&](const Segment & segment, size_t i) {
    return OldPair<D>(*this, segment, points[i]).Slip();
  });
}

template <int D>
void MeshScene<D>::AddSlip(const SlipPairs<D> & pairs, size_t m, MacroRows<D> & rows,
                           LocalHeap & lh) const {
  auto & points = *pairs.points;
  double mean = 1 / points.area[m];
  for (int s : points.segments[m]) {
    HeapReset hr(lh);
    auto & segment = points.pairing->segments[s];
    FacePair<D> faces(*this, segment, rows, lh);
    SlipSide<D> of_slave(this->slave_shapes, segment.slave, 1, lh);
    SlipSide<D> of_master(*this->master_shapes, segment.master, -1, lh);
    for (auto & p : points.pairing->points.Range(points.pairing->Points(s))) {
      OldPair<D> old(*this, segment, p);
      auto & d = old.direction;
      double w = mean * p.weight;
      of_slave.Add(p.slave, old, w, d.of_slave, old.gap, old.slave_normal, old.dx);
      of_master.Add(p.master, old, w, d.of_master, 0, old.master_normal, old.dy);
    }
    FlatMatrix<> columns(D, faces.Size(), lh);
    columns = 0.0;
    of_slave.AddTo(columns, 0);
    of_master.AddTo(columns, D * faces.slaves);
    faces.AddTo(rows.slip, columns, 1, lh);
  }
}

namespace {
/// The tangents that vectors of a macro-element are carried with.
template <int D>
Mat<D, D - 1> TangentsOf(const Surface<D> & slave, const MacroPoints<D> & points, size_t macro) {
  auto & segment = points.pairing->segments[points.segments[macro][0]];
  Vec<D> x;
  Mat<D, D - 1> dx;
  slave.Evaluate(segment.slave, points.pairing->points[segment.first].slave, x, dx);
  return dx;
}
} // namespace

template <int D>
Vec<D> Carried(const Surface<D> & slave, const MacroPoints<D> & points, size_t macro,
               const Vec<D> & vector) {
  return TangentsOf(slave, points, macro) * Vec<D - 1>(Trans(points.dual[macro]) * vector);
}

template <int D>
Vec<D> Carried(const Surface<D> & before, const Surface<D> & slave, const MacroPoints<D> & points,
               size_t macro, const Vec<D> & vector) {
  auto dual = DualBasis<D>(TangentsOf(before, points, macro));
  return TangentsOf(slave, points, macro) * Vec<D - 1>(Trans(dual) * vector);
}

template <int D>
void SubtractCarried(const FaceShapes<D> & slave, const MacroPoints<D> & points, size_t macro,
                     const Vec<D> & vector, MacroRows<D> & rows, LocalHeap & lh) {
  HeapReset hr(lh);
  auto & segment = points.pairing->segments[points.segments[macro][0]];
  auto shapes = slave.Calc(segment.slave, points.pairing->points[segment.first].slave, lh);
  FacePair<D> faces(slave, nullptr, segment, lh);
  for (int j : Range(faces.at))
    faces.at[j] = rows.Position(faces.Dof(j));
  FlatMatrix<> columns(D, faces.Size(), lh);
  columns = 0.0;
  Vec<D - 1> components = Trans(points.dual[macro]) * vector;
  for (int i : Range(faces.slaves))
    for (int k : Range(D))
      for (int a : Range(D - 1))
        columns(k, D * i + k) += components(a) * shapes.derivative(a, i);
  faces.AddTo(rows.slip, columns, -1, lh);
}

#define INSTANTIATE(D)                                                                             \
  template Vec<D> Carried(const Surface<D> &, const MacroPoints<D> &, size_t, const Vec<D> &);     \
  template Vec<D> Carried(const Surface<D> &, const Surface<D> &, const MacroPoints<D> &, size_t,  \
                          const Vec<D> &);                                                         \
  template void SubtractCarried(const FaceShapes<D> &, const MacroPoints<D> &, size_t,             \
                                const Vec<D> &, MacroRows<D> &, LocalHeap &);                      \
  template Vec<D> MeshScene<D>::SlipOf(const SlipPairs<D> &, size_t) const;                        \
  template void MeshScene<D>::AddSlip(const SlipPairs<D> &, size_t, MacroRows<D> &, LocalHeap &)   \
      const;
INSTANTIATE(2)
INSTANTIATE(3)
} // namespace ngslac
