#include "macromotion.hpp"
#include "ray.hpp"

namespace ngslac {
namespace {
/// Numbers of things that belong to slave faces, macro-element by macro-element.
template <int D, typename FACE>
Table<int> OfMacros(size_t n, FACE face, const Surface<D> & slave, const LACSpace & space) {
  TableCreator<int> creator(space.NMacros());
  for (; !creator.Done(); creator++)
    for (int i : Range(n))
      creator.Add(space.MacroOfFace()[slave.Element(face(i))], i);
  return creator.MoveTable();
}
} // namespace

template <int D>
shared_ptr<MacroPoints<D>> MakePoints(const Pairing<D> & pairing, const Surface<D> & slave,
                                      const LACSpace & space, FlatArray<double> area) {
  auto & segments = pairing.segments;
  auto of_segments =
      OfMacros<D>(pairing.Size(), [&](int i) { return segments[i].slave; }, slave, space);
  auto of_rim = OfMacros<D>(
      pairing.rim.Size(), [&](int i) { return segments[pairing.rim[i].segment].slave; }, slave,
      space);
  Array<Mat<D, D - 1>> dual(space.NMacros());
  for (size_t m : Range(dual))
    if (area[m] > 0) {
      auto & segment = segments[of_segments[m][0]];
      Vec<D> x;
      Mat<D, D - 1> dx;
      slave.Evaluate(segment.slave, pairing.points[segment.first].slave, x, dx);
      dual[m] = DualBasis<D>(dx);
    }
  return make_shared<MacroPoints<D>>(MacroPoints<D>{
      pairing, std::move(of_segments), std::move(of_rim), Array<double>(area), std::move(dual)});
}

template <int D>
MacroRows<D>::MacroRows(Array<int> && adofs) : dofs(std::move(adofs)) {
  size_t n = dofs.Size();
  gap.SetSize(n), squeeze.SetSize(n);
  normal.SetSize(D, n), slip.SetSize(D, n), force.SetSize(D, n);
  gap = 0.0, squeeze = 0.0, normal = 0.0, slip = 0.0, force = 0.0;
}

namespace {
template <int D>
Array<int> Positions(const MacroRows<D> & rows, FlatArray<int> dofs) {
  Array<int> positions(dofs.Size());
  for (int i : Range(dofs))
    positions[i] = rows.Position(dofs[i]);
  return positions;
}

/// Derivative of the unit normal by the dofs of a slave face.
template <int D>
FlatMatrix<> NormalDerivative(Vec<D> normal, const Mat<D, D - 1> & dx,
                              const typename FaceShapes<D>::Values & shapes, LocalHeap & lh) {
  FlatMatrix<> result(D, shapes.value.Width(), lh);
  auto dual = DualBasis<D>(dx);
  result = 0.0;
  for (int j : Range(result.Width()))
    for (int a : Range(D - 1))
      result.Col(j) -= InnerProduct(normal, shapes.derivative[a].Col(j)) * dual.Col(a);
  return result;
}
} // namespace

template <int D>
MacroGap<D> MeanGap(const MovingSurfaces<D> & now, const MacroPoints<D> & points, size_t macro) {
  double gap = 0;
  Vec<D> normals = 0.0;
  for (int s : points.segments[macro]) {
    auto & segment = points.pairing.segments[s];
    for (auto & p : points.pairing.points.Range(points.pairing.Points(s))) {
      Ray<D> ray(now.slave, segment.slave, now.master, segment.master, p);
      gap += p.weight * ray.gap;
      normals += p.weight * ray.normal;
    }
  }
  double length = L2Norm(normals);
  return {gap / points.area[macro], (1 / length) * normals, length};
}

namespace {
/// Adds what the points of one segment contribute to the derivatives.
template <int D>
class SegmentDerivative {
  const MovingSurfaces<D> & now;
  const Segment & segment;
  Array<int> slave_at, master_at;
  MacroRows<D> & rows;

public:
  FlatMatrix<> block; // of the forces, slave dofs first

  SegmentDerivative(const MovingSurfaces<D> & anow, const Segment & asegment, MacroRows<D> & arows,
                    LocalHeap & lh)
      : now(anow), segment(asegment),
        slave_at(Positions(arows, now.slave_shapes.Dofs(segment.slave))),
        master_at(Positions(arows, now.master_shapes.Dofs(segment.master))), rows(arows),
        block(slave_at.Size() + master_at.Size(), slave_at.Size() + master_at.Size(), lh) {
    block = 0.0;
  }

  void Add(const PairPoint<D> & p, const MacroTraction<D> & traction, LocalHeap & lh) {
    int n1 = slave_at.Size(), n2 = master_at.Size();
    Ray<D> ray(now.slave, segment.slave, now.master, segment.master, p);
    auto on_slave = now.slave_shapes.Calc(now.slave, segment.slave, p.slave, lh);
    auto on_master = now.master_shapes.Calc(now.master, segment.master, ray.eta, lh);
    auto turn = NormalDerivative<D>(ray.normal, ray.dx, on_slave, lh);
    FlatMatrix<> moved(D, n1 + n2, lh), response(D, n1 + n2, lh);
    moved.Cols(0, n1) = on_slave.value + ray.gap * turn;
    moved.Cols(n1, n1 + n2) = -on_master.value;
    response = ray.response * moved;
    for (int j : Range(n1))
      response(D - 1, j) += InnerProduct(ray.miss, turn.Col(j));

    double w = p.weight;
    for (int j : Range(n1))
      rows.normal.Col(slave_at[j]) += w * turn.Col(j);
    for (int j : Range(n1 + n2)) {
      int at = At(j);
      Vec<D> jump = j < n1 ? Vec<D>(on_slave.value.Col(j)) : Vec<D>(-on_master.value.Col(j - n1));
      rows.gap(at) += w * response(D - 1, j);
      rows.force.Col(at) += w * jump;
      rows.squeeze(at) += w * InnerProduct(jump, ray.normal);
      for (int l : Range(n1))
        block(j, l) += w * traction.pressure * InnerProduct(jump, turn.Col(l));
    }
    Vec<D> force = w * traction.At(ray.normal);
    for (int a : Range(D - 1))
      for (int i : Range(n2))
        block.Row(n1 + i) += InnerProduct(force, on_master.derivative[a].Col(i)) * response.Row(a);
  }

  /// The overlap grows where the image of the master's end moves outwards.
  void AddRim(const RimPoint<D> & rim, const MacroGap<D> & mean, const MacroTraction<D> & traction,
              LocalHeap & lh) {
    int n1 = slave_at.Size(), n2 = master_at.Size();
    Ray<D> ray(now.slave, segment.slave, now.master, segment.master, rim.point);
    auto on_slave = now.slave_shapes.Calc(now.slave, segment.slave, rim.point.slave, lh);
    auto on_master = now.master_shapes.Calc(now.master, segment.master, ray.eta, lh);
    auto turn = NormalDerivative<D>(ray.normal, ray.dx, on_slave, lh);
    Vec<D> direction = DualBasis<D>(ray.dx) * rim.outwards;
    Vec<D> force = traction.At(ray.normal);
    FlatVector<> growth(n1 + n2, lh), work(n1 + n2, lh);
    for (int j : Range(n1)) {
      growth(j) = -InnerProduct(direction, on_slave.value.Col(j) + ray.gap * turn.Col(j));
      work(j) = InnerProduct(force, on_slave.value.Col(j));
    }
    for (int j : Range(n2)) {
      growth(n1 + j) = InnerProduct(direction, on_master.value.Col(j));
      work(n1 + j) = -InnerProduct(force, on_master.value.Col(j));
    }
    growth *= rim.point.weight;
    for (int j : Range(n1 + n2)) {
      rows.gap(At(j)) += growth(j) * (ray.gap - mean.gap);
      rows.normal.Col(At(j)) += growth(j) * ray.normal;
    }
    block -= work * Trans(growth);
  }

private:
  int At(int j) const { return j < slave_at.Size() ? slave_at[j] : master_at[j - slave_at.Size()]; }
};
} // namespace

template <int D>
void AddDerivatives(const MovingSurfaces<D> & now, const MacroPoints<D> & points, size_t macro,
                    const MacroGap<D> & mean, const MacroTraction<D> & traction, bool moving_rim,
                    MacroRows<D> & rows, const ForceBlock & add, LocalHeap & lh) {
  auto & pairing = points.pairing;
  for (int s : points.segments[macro]) {
    HeapReset hr(lh);
    auto & segment = pairing.segments[s];
    SegmentDerivative<D> derivative(now, segment, rows, lh);
    for (auto & p : pairing.points.Range(pairing.Points(s))) {
      HeapReset hr(lh);
      derivative.Add(p, traction, lh);
    }
    for (int r : points.rim[macro])
      if (moving_rim && pairing.rim[r].segment == s)
        derivative.AddRim(pairing.rim[r], mean, traction, lh);
    add(now.slave_shapes.Dofs(segment.slave), now.master_shapes.Dofs(segment.master),
        derivative.block);
  }
  rows.gap *= 1 / points.area[macro];
  Mat<D, D> across = Id<D>() - mean.normal * Trans(mean.normal);
  across *= 1 / mean.length;
  for (int j : Range(rows.dofs)) {
    Vec<D> turn = across * Vec<D>(rows.normal.Col(j));
    rows.normal.Col(j) = turn;
  }
}

template <int D>
void AddTraction(const MovingSurfaces<D> & now, const MacroPoints<D> & points, size_t macro,
                 const MacroTraction<D> & traction, FlatVector<> y, LocalHeap & lh) {
  for (int s : points.segments[macro]) {
    HeapReset hr(lh);
    auto & segment = points.pairing.segments[s];
    auto slave_dofs = now.slave_shapes.Dofs(segment.slave);
    auto master_dofs = now.master_shapes.Dofs(segment.master);
    FlatVector<> slave_forces(slave_dofs.Size(), lh), master_forces(master_dofs.Size(), lh);
    slave_forces = 0.0, master_forces = 0.0;
    for (auto & p : points.pairing.points.Range(points.pairing.Points(s))) {
      HeapReset hr(lh);
      Ray<D> ray(now.slave, segment.slave, now.master, segment.master, p);
      Vec<D> force = p.weight * traction.At(ray.normal);
      auto on_slave = now.slave_shapes.Calc(now.slave, segment.slave, p.slave, lh);
      auto on_master = now.master_shapes.Calc(now.master, segment.master, ray.eta, lh);
      for (int j : Range(slave_dofs))
        slave_forces(j) -= InnerProduct(force, on_slave.value.Col(j));
      for (int j : Range(master_dofs))
        master_forces(j) += InnerProduct(force, on_master.value.Col(j));
    }
    for (int j : Range(slave_dofs))
      AtomicAdd(y(slave_dofs[j]), slave_forces(j));
    for (int j : Range(master_dofs))
      AtomicAdd(y(master_dofs[j]), master_forces(j));
  }
}

template <int D>
pair<Vec<D>, Vec<3>> Resultant(const MovingSurfaces<D> & now, const MacroPoints<D> & points,
                               size_t macro, const MacroTraction<D> & traction) {
  Vec<D> force = 0.0;
  Vec<3> moment = 0.0;
  for (int s : points.segments[macro]) {
    int face = points.pairing.segments[s].slave;
    for (auto & p : points.pairing.points.Range(points.pairing.Points(s))) {
      Vec<D> x;
      Mat<D, D - 1> dx;
      now.slave.Evaluate(face, p.slave, x, dx);
      Vec<D> part = p.weight * traction.At(now.slave.Normal(face, dx));
      force += part;
      moment += Moment(x, part);
    }
  }
  return {force, moment};
}

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
    for (auto & p : points.pairing.points.Range(points.pairing.Points(s)))
      sum += p.weight * OldPair<D>(now, points.pairing.segments[s], p).Slip();
  return (1 / points.area[macro]) * sum;
}

template <int D>
Vec<D> MeanSlip(const MovingSurfaces<D> & now, const MacroPoints<D> & points, size_t macro,
                MacroRows<D> & rows, LocalHeap & lh) {
  Vec<D> sum = 0.0;
  double mean = 1 / points.area[macro];
  for (int s : points.segments[macro]) {
    auto & segment = points.pairing.segments[s];
    auto slave_at = Positions(rows, now.slave_shapes.Dofs(segment.slave));
    auto master_at = Positions(rows, now.master_shapes.Dofs(segment.master));
    for (auto & p : points.pairing.points.Range(points.pairing.Points(s))) {
      HeapReset hr(lh);
      OldPair<D> old(now, segment, p);
      sum += p.weight * old.Slip();
      auto on_slave = now.slave_shapes.Calc(now.slave, segment.slave, p.slave, lh);
      auto on_master = now.master_shapes.Calc(now.master, segment.master, p.master, lh);
      auto turn = NormalDerivative<D>(old.normal, old.dx, on_slave, lh);
      Mat<D, D> across = Id<D>() - old.normal * Trans(old.normal);
      across *= mean * p.weight;
      double opening = InnerProduct(old.normal, old.apart);
      for (int j : Range(slave_at)) {
        rows.slip.Col(slave_at[j]) += across * Vec<D>(on_slave.value.Col(j));
        rows.slip.Col(slave_at[j]) -= mean * p.weight * opening * turn.Col(j);
        rows.slip.Col(slave_at[j]) -=
            mean * p.weight * InnerProduct(turn.Col(j), old.apart) * old.normal;
      }
      for (int j : Range(master_at))
        rows.slip.Col(master_at[j]) -= across * Vec<D>(on_master.value.Col(j));
    }
  }
  return mean * sum;
}

template <int D>
Vec<D> Carried(const MovingSurfaces<D> & now, const MacroPoints<D> & points, size_t macro,
               const Vec<D> & vector) {
  auto & segment = points.pairing.segments[points.segments[macro][0]];
  Vec<D> x;
  Mat<D, D - 1> dx;
  now.slave.Evaluate(segment.slave, points.pairing.points[segment.first].slave, x, dx);
  return dx * Vec<D - 1>(Trans(points.dual[macro]) * vector);
}

template <int D>
void SubtractCarried(const MovingSurfaces<D> & now, const MacroPoints<D> & points, size_t macro,
                     const Vec<D> & vector, MacroRows<D> & rows, LocalHeap & lh) {
  HeapReset hr(lh);
  auto & segment = points.pairing.segments[points.segments[macro][0]];
  auto & xi = points.pairing.points[segment.first].slave;
  auto shapes = now.slave_shapes.Calc(now.slave, segment.slave, xi, lh);
  auto positions = Positions(rows, now.slave_shapes.Dofs(segment.slave));
  Vec<D - 1> components = Trans(points.dual[macro]) * vector;
  for (int j : Range(positions))
    for (int a : Range(D - 1))
      rows.slip.Col(positions[j]) -= components(a) * shapes.derivative[a].Col(j);
}

#define INSTANTIATE(D)                                                                             \
  template shared_ptr<MacroPoints<D>> MakePoints(const Pairing<D> &, const Surface<D> &,           \
                                                 const LACSpace &, FlatArray<double>);             \
  template struct MacroRows<D>;                                                                    \
  template MacroGap<D> MeanGap(const MovingSurfaces<D> &, const MacroPoints<D> &, size_t);         \
  template void AddDerivatives(const MovingSurfaces<D> &, const MacroPoints<D> &, size_t,          \
                               const MacroGap<D> &, const MacroTraction<D> &, bool,                \
                               MacroRows<D> &, const ForceBlock &, LocalHeap &);                   \
  template void AddTraction(const MovingSurfaces<D> &, const MacroPoints<D> &, size_t,             \
                            const MacroTraction<D> &, FlatVector<>, LocalHeap &);                  \
  template pair<Vec<D>, Vec<3>> Resultant(const MovingSurfaces<D> &, const MacroPoints<D> &,       \
                                          size_t, const MacroTraction<D> &);                       \
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
