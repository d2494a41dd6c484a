#include "facepair.hpp"

namespace ngslac {
namespace {
/// A pair of points that once faced each other.
template <int D>
struct OldPair {
  Vec<D> apart, normal;
  Mat<D, D - 1> dx;

  OldPair(const MovingSurfaces<D> & now, const Segment & segment, const PairPoint<D> & p) {
    Vec<D> x;
    now.slave.Evaluate(segment.slave, p.slave, x, dx);
    normal = now.slave.Normal(segment.slave, dx);
    apart = x - now.master.Point(segment.master, p.master);
  }
  Vec<D> Slip() const { return apart - InnerProduct(normal, apart) * normal; }
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
Vec<D> MeanSlip(const MovingSurfaces<D> & now, const MacroPoints<D> & points, size_t macro,
                MacroRows<D> & rows, LocalHeap & lh) {
  Vec<D> sum = 0.0;
  double mean = 1 / points.area[macro];
  for (int s : points.segments[macro]) {
    HeapReset hr(lh);
    auto & segment = points.pairing->segments[s];
    FacePair<D> faces(now, segment, rows, lh);
    FlatMatrix<> columns(D, faces.Size(), lh);
    columns = 0.0;
    for (auto & p : points.pairing->points.Range(points.pairing->Points(s))) {
      HeapReset hr(lh);
      OldPair<D> old(now, segment, p);
      sum += p.weight * old.Slip();
      auto on_slave = now.slave_shapes.Calc(segment.slave, p.slave, lh);
      auto on_master = now.master_shapes.Calc(segment.master, p.master, lh);
      auto gradients = Gradients<D>(old.dx, on_slave, lh);
      auto & n = old.normal;
      Mat<D, D> across = Id<D>() - n * Trans(n);
      across *= mean * p.weight;
      for (int i : Range(faces.slaves)) {
        Vec<D> g = gradients.Row(i);
        Vec<D> turning = InnerProduct(n, old.apart) * g + InnerProduct(g, old.apart) * n;
        turning *= mean * p.weight;
        for (int l : Range(D))
          for (int k : Range(D))
            columns(l, D * i + k) += across(l, k) * on_slave.value(i) + turning(l) * n(k);
      }
      for (int i : Range(faces.masters))
        for (int l : Range(D))
          for (int k : Range(D))
            columns(l, D * (faces.slaves + i) + k) -= across(l, k) * on_master.value(i);
    }
    auto of_dofs = faces.OfDofs(columns, lh);
    for (int l : Range(D))
      for (int j : Range(faces.at))
        rows.slip(l, faces.at[j]) += of_dofs(l, j);
  }
  return mean * sum;
}

template <int D>
Vec<D> Carried(const MovingSurfaces<D> & now, const MacroPoints<D> & points, size_t macro,
               const Vec<D> & vector) {
  auto & segment = points.pairing->segments[points.segments[macro][0]];
  Vec<D> x;
  Mat<D, D - 1> dx;
  now.slave.Evaluate(segment.slave, points.pairing->points[segment.first].slave, x, dx);
  return dx * Vec<D - 1>(Trans(points.dual[macro]) * vector);
}

template <int D>
void SubtractCarried(const MovingSurfaces<D> & now, const MacroPoints<D> & points, size_t macro,
                     const Vec<D> & vector, MacroRows<D> & rows, LocalHeap & lh) {
  HeapReset hr(lh);
  auto & segment = points.pairing->segments[points.segments[macro][0]];
  auto shapes =
      now.slave_shapes.Calc(segment.slave, points.pairing->points[segment.first].slave, lh);
  FacePair<D> faces(now, segment, rows, lh);
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
  template Vec<D> Carried(const MovingSurfaces<D> &, const MacroPoints<D> &, size_t,               \
                          const Vec<D> &);                                                         \
  template void SubtractCarried(const MovingSurfaces<D> &, const MacroPoints<D> &, size_t,         \
                                const Vec<D> &, MacroRows<D> &, LocalHeap &);                      \
  template Vec<D> MeanSlip(const MovingSurfaces<D> &, const MacroPoints<D> &, size_t);             \
  template Vec<D> MeanSlip(const MovingSurfaces<D> &, const MacroPoints<D> &, size_t,              \
                           MacroRows<D> &, LocalHeap &);
INSTANTIATE(2)
INSTANTIATE(3)
} // namespace ngslac
