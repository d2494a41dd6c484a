#include "facepair.hpp"

namespace ngslac {
namespace {
/// A point of the slave, one of the master, and the direction halfway between both normals.
template <int D>
struct MidPair {
  Vec<D> apart, slave_normal, master_normal, normal;
  Mat<D, D - 1> dx, dy;
  double length; // of the difference of the normals

  MidPair(const MovingSurfaces<D> & now, const Segment & segment, const PairPoint<D> & p) {
    Vec<D> x, y;
    now.slave.Evaluate(segment.slave, p.slave, x, dx);
    now.master.Evaluate(segment.master, p.master, y, dy);
    slave_normal = now.slave.Normal(segment.slave, dx);
    master_normal = now.master.Normal(segment.master, dy);
    apart = x - y;
    normal = slave_normal - master_normal;
    length = L2Norm(normal);
    normal *= 1 / length;
  }
  Vec<D> Slip() const { return apart - InnerProduct(normal, apart) * normal; }
};

/// Moves the partner until the direction halfway between both normals leads to it; false: none
/// near.
template <int D>
bool FindMidPartner(const MovingSurfaces<D> & now, const Segment & segment, PairPoint<D> & p) {
  Vec<D - 1> start = p.master;
  for (int it = 0; it < 20; it++) {
    MidPair<D> mid(now, segment, p);
    Mat<D, D - 1> dual = DualBasis<D>(mid.dy);
    Mat<D - 1, D - 1> bend = now.master.Hessian(segment.master, p.master, mid.master_normal);
    // By eta: apart loses the tangents, and the normal of the master turns by -dual * bend.
    Mat<D, D - 1> turn = (InnerProduct(mid.normal, mid.apart) / mid.length) * (dual * bend);
    Mat<D, D> across = Id<D>() - mid.normal * Trans(mid.normal);
    Mat<D - 1, D - 1> slope = Trans(mid.dy) * across * (mid.dy + turn);
    Vec<D - 1> step = Inv(slope) * Vec<D - 1>(Trans(mid.dy) * mid.Slip());
    p.master += step;
    if (!(L2Norm(p.master - start) < 1))
      return false;
    if (L2Norm(step) < 1e-9)
      return true;
  }
  return false;
}
} // namespace

template <int D>
shared_ptr<MacroPoints<D>> WithMidPartners(const MovingSurfaces<D> & now,
                                           const MacroPoints<D> & points) {
  auto pairing = make_shared<Pairing<D>>(*points.pairing);
  ParallelFor(pairing->Size(), [&](size_t s) {
    for (auto & p : pairing->points.Range(pairing->Points(s))) {
      auto mid = p;
      if (FindMidPartner(now, pairing->segments[s], mid))
        p = mid;
    }
  });
  auto result = make_shared<MacroPoints<D>>(points);
  result->pairing = pairing;
  return result;
}

template <int D>
Vec<D> MeanSlip(const MovingSurfaces<D> & now, const MacroPoints<D> & points, size_t macro) {
  Vec<D> sum = 0.0;
  for (int s : points.segments[macro])
    for (auto & p : points.pairing->points.Range(points.pairing->Points(s)))
      sum += p.weight * MidPair<D>(now, points.pairing->segments[s], p).Slip();
  return (1 / points.area[macro]) * sum;
}

namespace {
/// Adds the derivative of a factor times the slip by the scalar functions of one side, which moves
/// the points apart (sign 1) or together (-1) and turns the direction with its normal.
template <int D>
void AddSlip(const MidPair<D> & mid, double sign, const Vec<D> & normal,
             const Mat<D, D - 1> & tangents, const typename FaceShapes<D>::Values & shapes,
             double factor, FlatMatrix<> columns, LocalHeap & lh) {
  auto gradients = Gradients<D>(tangents, shapes, lh);
  auto & n = mid.normal;
  Mat<D, D> across = Id<D>() - n * Trans(n);
  double along = InnerProduct(n, mid.apart);
  for (int i : Range(shapes.value)) {
    // the direction turns by  -turn  times the component along the side's own normal
    Vec<D> turn = (sign / mid.length) * (across * Vec<D>(gradients.Row(i)));
    Vec<D> turning = along * turn + InnerProduct(turn, mid.apart) * n;
    for (int l : Range(D))
      for (int k : Range(D))
        columns(l, D * i + k) +=
            factor * (sign * across(l, k) * shapes.value(i) + turning(l) * normal(k));
  }
}
} // namespace

template <int D>
Vec<D> MeanSlip(const MovingSurfaces<D> & now, const MacroPoints<D> & points, size_t macro,
                MacroRows<D> & rows, LocalHeap & lh) {
  Vec<D> sum = 0.0;
  double mean = 1 / points.area[macro];
  for (int s : points.segments[macro]) {
    HeapReset hr(lh);
    auto & segment = points.pairing->segments[s];
    FacePair<D> faces(now, segment, rows, lh);
    FlatMatrix<> slave(D, D * faces.slaves, lh), master(D, D * faces.masters, lh);
    slave = 0.0, master = 0.0;
    for (auto & p : points.pairing->points.Range(points.pairing->Points(s))) {
      HeapReset hr(lh);
      MidPair<D> mid(now, segment, p);
      sum += p.weight * mid.Slip();
      double w = mean * p.weight;
      AddSlip(mid, 1, mid.slave_normal, mid.dx, now.slave_shapes.Calc(segment.slave, p.slave, lh),
              w, slave, lh);
      AddSlip(mid, -1, mid.master_normal, mid.dy,
              now.master_shapes.Calc(segment.master, p.master, lh), w, master, lh);
    }
    FlatMatrix<> columns(D, faces.Size(), lh);
    columns.Cols(0, D * faces.slaves) = slave;
    columns.Cols(D * faces.slaves, faces.Size()) = master;
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
  template shared_ptr<MacroPoints<D>> WithMidPartners(const MovingSurfaces<D> &,                   \
                                                      const MacroPoints<D> &);                     \
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
