#include "facepair.hpp"

namespace ngslac {
namespace {
/// A pair of points that once faced each other.
template <int D>
struct OldPair {
  Vec<D> apart; // since then
  Vec<D> slave_normal, master_normal;
  double gap; // of then
  Mat<D, D - 1> dx, dy;
  ContactDirection<D> direction;

  OldPair(const MovingSurfaces<D> & now, const Segment & segment, const PairPoint<D> & p)
      : gap(p.gap) {
    Vec<D> x, y;
    now.slave.Evaluate(segment.slave, p.slave, x, dx);
    now.master.Evaluate(segment.master, p.master, y, dy);
    slave_normal = now.slave.Normal(segment.slave, dx);
    master_normal = now.master.Normal(segment.master, dy);
    direction = ContactDirection<D>(slave_normal, master_normal, now.share);
    apart = x + gap * slave_normal - y;
  }
  Vec<D> Slip() const { return direction.Across() * apart; }
};

/// Adds a factor times the derivative of the slip by the scalar functions of one side: they move
/// the points apart by `moves` times their value, and by `swings` times the turn of the side's
/// normal; that has the factor `turns` in the contact direction.
template <int D>
struct SlipSide {
  double moves, swings, turns;
  const Vec<D> & normal;
  const Mat<D, D - 1> & tangents;

  void Add(const OldPair<D> & old, const typename FaceShapes<D>::Values & shapes, double factor,
           FlatMatrix<> columns, LocalHeap & lh) const {
    auto gradients = Gradients<D>(tangents, shapes, lh);
    auto & n = old.direction.normal;
    Mat<D, D> across = old.direction.Across();
    double along = InnerProduct(n, old.apart);
    for (int i : Range(shapes.value)) {
      // the normal turns by  -g  times the component of the displacement along it
      Vec<D> turn = turns * Vec<D>(across * Vec<D>(gradients.Row(i)));
      Vec<D> turning = along * turn + InnerProduct(turn, old.apart) * n;
      turning -= swings * Vec<D>(across * Vec<D>(gradients.Row(i)));
      for (int l : Range(D))
        for (int k : Range(D))
          columns(l, D * i + k) +=
              factor * (moves * across(l, k) * shapes.value(i) + turning(l) * normal(k));
    }
  }
};
} // namespace

template <int D>
Vec<D> MeanSlip(const MovingSurfaces<D> & now, const MacroPoints<D> & points, size_t macro) {
  Vec<D> sum = 0.0;
  for (int s : points.segments[macro])
    for (auto & p : points.pairing->points.Range(points.pairing->Points(s)))
      sum += p.weight * OldPair<D>(now, points.pairing->segments[s], p).Slip();
  return (1 / points.area[macro]) * sum;
}

template <int D>
void AddSlip(const MovingSurfaces<D> & now, const MacroPoints<D> & points, size_t macro,
             MacroRows<D> & rows, LocalHeap & lh) {
  double mean = 1 / points.area[macro];
  for (int s : points.segments[macro]) {
    HeapReset hr(lh);
    auto & segment = points.pairing->segments[s];
    FacePair<D> faces(now, segment, rows, lh);
    FlatMatrix<> slave(D, D * faces.slaves, lh), master(D, D * faces.masters, lh);
    slave = 0.0, master = 0.0;
    for (auto & p : points.pairing->points.Range(points.pairing->Points(s))) {
      HeapReset hr(lh);
      OldPair<D> old(now, segment, p);
      auto & d = old.direction;
      SlipSide<D> of_slave{1, old.gap, d.of_slave, old.slave_normal, old.dx};
      SlipSide<D> of_master{-1, 0, d.of_master, old.master_normal, old.dy};
      of_slave.Add(old, now.slave_shapes.Calc(segment.slave, p.slave, lh), mean * p.weight, slave,
                   lh);
      of_master.Add(old, now.master_shapes.Calc(segment.master, p.master, lh), mean * p.weight,
                    master, lh);
    }
    FlatMatrix<> columns(D, faces.Size(), lh);
    columns.Cols(0, D * faces.slaves) = slave;
    columns.Cols(D * faces.slaves, faces.Size()) = master;
    auto of_dofs = faces.OfDofs(columns, lh);
    for (int l : Range(D))
      for (int j : Range(faces.at))
        rows.slip(l, faces.at[j]) += of_dofs(l, j);
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
  FacePair<D> faces(slave, nullptr, segment, rows, lh);
  FlatMatrix<> columns(D, faces.Size(), lh);
  columns = 0.0;
  Vec<D - 1> components = Trans(points.dual[macro]) * vector;
  for (int i : Range(faces.slaves))
    for (int k : Range(D))
      for (int a : Range(D - 1))
        columns(k, D * i + k) += components(a) * shapes.derivative(a, i);
  auto of_dofs = faces.OfDofs(columns, lh);
  for (int k : Range(D))
    for (int j : Range(faces.at))
      rows.slip(k, faces.at[j]) -= of_dofs(k, j);
}

#define INSTANTIATE(D)                                                                             \
  template Vec<D> Carried(const Surface<D> &, const MacroPoints<D> &, size_t, const Vec<D> &);     \
  template Vec<D> Carried(const Surface<D> &, const Surface<D> &, const MacroPoints<D> &, size_t,  \
                          const Vec<D> &);                                                         \
  template void SubtractCarried(const FaceShapes<D> &, const MacroPoints<D> &, size_t,             \
                                const Vec<D> &, MacroRows<D> &, LocalHeap &);                      \
  template Vec<D> MeanSlip(const MovingSurfaces<D> &, const MacroPoints<D> &, size_t);             \
  template void AddSlip(const MovingSurfaces<D> &, const MacroPoints<D> &, size_t, MacroRows<D> &, \
                        LocalHeap &);
INSTANTIATE(2)
INSTANTIATE(3)
} // namespace ngslac
