// SPDX-License-Identifier: LGPL-2.1-or-later
#include "collectedshapes.hpp"
#include "contact/macrotables.hpp"
#include "facepair.hpp"
#include "pointsums.hpp"

namespace ngslac {
template <int D>
shared_ptr<MacroPoints<D>> MakePoints(shared_ptr<const Pairing<D>> pairing,
                                      const Surface<D> & slave, const LACSpace & space,
                                      FlatArray<double> area) {
  auto & segments = pairing->segments;
  auto of_segments = SegmentsOfMacros<D>(space, slave, *pairing);
  auto of_rim = OfMacros<D>(
      pairing->rim.Size(), [&](int i) { return segments[pairing->rim[i].segment].slave; }, slave,
      space);
  Array<Mat<D, D - 1>> dual(space.NMacros());
  for (size_t m : Range(dual))
    if (area[m] > 0) {
      auto & segment = segments[of_segments[m][0]];
      Vec<D> x;
      Mat<D, D - 1> dx;
      slave.Evaluate(segment.slave, pairing->points[segment.first].slave, x, dx);
      dual[m] = DualBasis<D>(dx);
    }
  return make_shared<MacroPoints<D>>(MacroPoints<D>{
      pairing, std::move(of_segments), std::move(of_rim), Array<double>(area), std::move(dual)});
}

template <int D>
MacroRows<D>::MacroRows(FlatArray<int> adofs, FlatArray<int> aturning)
    : dofs(adofs), turning(aturning), data(4 * D + 2, adofs.Size()),
      stiffness(adofs.Size(), aturning.Size()) {
  data = 0.0, stiffness = 0.0;
  size_t n = dofs.Size();
  normal.AssignMemory(D, n, data.Data());
  force.AssignMemory(D, n, data.Data() + D * n);
  gap.AssignMemory(n, data.Data() + 2 * D * n);
  squeeze.AssignMemory(n, data.Data() + (2 * D + 1) * n);
  tilt.AssignMemory(D, n, data.Data() + (2 * D + 2) * n);
  slip.AssignMemory(D, n, data.Data() + (3 * D + 2) * n);
}

template <int D>
void MacroRows<D>::MakeMeans(const MacroGap<D> & mean, double area, double share) {
  double weight = 1 / area;
  gap *= weight;
  Mat<D, D> across = Id<D>() - mean.normal * Trans(mean.normal);
  across *= 1 / mean.length;
  for (int j : Range(dofs)) {
    Vec<D> slave = weight * Vec<D>(normal.Col(j)), master = weight * Vec<D>(tilt.Col(j));
    Vec<D> turn = share * (slave + master);
    tilt.Col(j) = turn;
    normal.Col(j) = across * Vec<D>(slave - turn);
    squeeze(j) -= InnerProduct(mean.tilt, force.Col(j));
  }
}

template <int D>
PlaceRows<D> MacroRows<D>::OfPlace(const Vec<D> & n, const Vec<D> & slipped, double opened) const {
  PlaceRows<D> rows(dofs);
  rows.normal = normal;
  Mat<D, D> across = Id<D>() - n * Trans(n);
  for (int j : Range(dofs)) {
    Vec<D> turn = normal.Col(j), moved = across * Vec<D>(slip.Col(j));
    moved -= InnerProduct(n, slipped) * turn + InnerProduct(turn, slipped) * n;
    rows.jump.Col(j) = moved - gap(j) * n - opened * turn;
    rows.force.Col(j) = across * Vec<D>(force.Col(j)) + squeeze(j) * n;
  }
  return rows;
}

template <int D>
MacroGap<D> MeshScene<D>::MeanOf(size_t m) {
  auto & points = *this->points;
  double gap = 0;
  Vec<D> slave = 0.0, master = 0.0;
  for (int s : points.segments[m]) {
    auto & segment = points.pairing->segments[s];
    for (size_t i : points.pairing->Points(s)) {
      auto & p = points.pairing->points[i];
      Ray<D> ray(this->slave, segment.slave, this->master, segment.master, p);
      hits[i] = ray.Hit();
      gap += p.weight * ray.gap;
      slave += p.weight * ray.normal;
      master += p.weight * this->master.Normal(segment.master, ray.dy);
    }
  }
  double mean = 1 / points.area[m];
  return {mean * gap, mean * slave, mean * master, share};
}

template <int D>
FlatMatrix<> MeshScene<D>::PartnerMoves(const FacePair<D> & faces, size_t point,
                                        LocalHeap & lh) const {
  constexpr int R = D - 1;
  auto & p = this->points->pairing->points[point];
  auto [on_slave, on_master] = pair(faces.segment.slave, faces.segment.master);
  Ray<D> ray(this->slave, on_slave, master, on_master, p, hits[point]);
  auto slaves = this->slave_shapes.Calc(on_slave, p.slave, lh);
  auto masters = this->master_shapes->Calc(on_master, ray.eta, lh);
  auto gradients = Gradients<D>(ray.dx, slaves, lh);
  Mat<R, D> response = ray.response.Rows(0, R);
  FlatMatrix<> columns(R, faces.Size(), lh);
  for (int i : Range(faces.slaves))
    for (int k : Range(D)) {
      Vec<D> apart = -ray.gap * ray.normal(k) * gradients.Row(i);
      apart(k) += slaves.value(i);
      columns.Col(D * i + k) = response * apart;
    }
  for (int i : Range(faces.masters))
    for (int k : Range(D))
      columns.Col(D * (faces.slaves + i) + k) = -masters.value(i) * response.Col(k);
  return faces.OfDofs(columns, lh);
}

namespace {
/// Calls f with the segments of every pair of faces: divided faces have many, whose forces act on
/// the same dofs.
template <int D, typename F>
void ForFacePairs(const MacroPoints<D> & points, size_t macro, F f) {
  auto & segments = points.pairing->segments;
  Array<int> order(points.segments[macro]);
  auto faces = [&](int s) { return pair(segments[s].slave, segments[s].master); };
  std::stable_sort(order.begin(), order.end(), [&](int s, int t) { return faces(s) < faces(t); });
  for (size_t i = 0, next = 0; i < order.Size(); i = next) {
    while (next < order.Size() && faces(order[next]) == faces(order[i]))
      next++;
    f(order.Range(i, next));
  }
}

/// Adds what the points between two faces contribute to the derivatives, by scalar functions.
template <int D>
class FacePairDerivative {
  const MeshScene<D> & now;
  const MacroTraction<D> & traction;
  MacroRows<D> & rows;
  FacePair<D> faces;
  bool loaded, has_rim = false;
  int n1, n; // columns of the slave, of both
  PointSums<D> sums;
  // as in MacroRows, but the sums of both normals in place of normal and tilt
  FlatMatrix<> columns;
  FlatMatrix<> rim; // forces at the end of the master

public:
  FacePairDerivative(const MeshScene<D> & anow, const Segment & segment,
                     const MacroTraction<D> & atraction, MacroRows<D> & arows, LocalHeap & lh)
      : now(anow), traction(atraction), rows(arows), faces(now, segment, rows, lh),
        loaded(!traction.IsZero()), n1(D * faces.slaves), n(faces.Size()),
        sums({now.slave_shapes, segment.slave, lh}, {*now.master_shapes, segment.master, lh},
             loaded, lh),
        columns(3 * D + 2, n, lh), rim(0, 0, lh) {
    columns = 0.0;
  }

  void Add(const PairPoint<D> & p, const RayHit<D> & hit) {
    auto [slave, master] = pair(faces.segment.slave, faces.segment.master);
    Ray<D> ray(now.slave, slave, now.master, master, p, hit);
    Vec<D> normal = now.master.Normal(master, ray.dy);
    sums.Add(p.slave, {ray, p.weight, p.weight * traction.At(ray.normal), normal,
                       now.master.Hessian(master, ray.eta, normal)});
  }

  /// The overlap grows where the image of the master's end moves outwards; where another face comes
  /// next, that one's grows less, and nothing but gap and normal of the master differ.
  void AddRim(const RimPoint<D> & end, const MacroGap<D> & mean, LocalHeap & lh) {
    bool moves_forces = end.beyond < 0 || end.step != 0;
    if (!has_rim && loaded && moves_forces) {
      rim.AssignMemory(n, n, lh);
      rim = 0.0;
    }
    has_rim = has_rim || moves_forces;
    HeapReset hr(lh);
    auto [slave, master] = pair(faces.segment.slave, faces.segment.master);
    Ray<D> ray(now.slave, slave, now.master, master, end.point);
    auto on_slave = now.slave_shapes.Calc(slave, end.point.slave, lh);
    auto on_master = now.master_shapes->Calc(master, ray.eta, lh);
    auto gradients = Gradients<D>(ray.dx, on_slave, lh);
    // Where rays end they lie closer than where they start, if the slave is curved.
    Mat<D - 1, D - 1> bend = now.slave.Hessian(slave, end.point.slave, ray.normal);
    Mat<D, D - 1> ends = ray.dx - ray.gap * Mat<D, D - 1>(DualBasis<D>(ray.dx) * bend);
    Vec<D> direction = DualBasis<D>(ends) * end.outwards;
    Vec<D> force = traction.At(ray.normal);
    FlatVector<> growth(n, lh), work(n, lh);
    for (int i : Range(faces.slaves)) {
      double turning = ray.gap * InnerProduct(direction, gradients.Row(i));
      for (int k : Range(D)) {
        growth(D * i + k) = turning * ray.normal(k) - direction(k) * on_slave.value(i);
        work(D * i + k) = end.beyond < 0 ? force(k) * on_slave.value(i) : 0.0;
      }
    }
    for (int i : Range(faces.masters))
      for (int k : Range(D)) {
        growth(n1 + D * i + k) = direction(k) * on_master.value(i);
        work(n1 + D * i + k) = -force(k) * on_master.value(i);
      }
    growth *= end.point.weight;
    Vec<D> beyond = end.beyond >= 0 ? NormalOf(end.beyond, end.eta) : mean.master;
    Vec<D> master_jump = now.master.Normal(master, ray.dy) - beyond;
    for (int l : Range(D))
      columns.Row(2 * D + 2 + l) += master_jump(l) * growth;
    if (end.beyond < 0)
      for (int l : Range(D))
        columns.Row(l) += (ray.normal(l) - mean.slave(l)) * growth;
    columns.Row(2 * D) += (end.beyond < 0 ? ray.gap - mean.gap : -end.step) * growth;
    if (loaded && moves_forces)
      rim -= work * Trans(growth);
  }

  void AddToRows(BlockSum & stiffness, LocalHeap & lh) {
    auto & at = faces.at;
    sums.AddTo(columns);
    faces.AddTo(rows.data, columns, 1, lh);
    if (!loaded)
      return;
    auto by_dofs = faces.BlockOfDofs(Block(lh), lh);
    auto slaves = faces.SlaveDofs(), masters = faces.MasterDofs();
    IntRange master(slaves.Size(), at.Size());
    FlatArray<int> turning(at.Size(), lh);
    for (int j : Range(at))
      turning[j] = rows.TurningPosition(j < slaves.Size() ? slaves[j] : masters[j - slaves.Size()]);
    for (int i : Range(at))
      for (int j : Range(has_rim && i < slaves.Size() ? at.Size() : slaves.Size()))
        rows.stiffness(at[i], turning[j]) += by_dofs(i, j);
    AddBlock(masters, by_dofs.Rows(master).Cols(master), stiffness);
  }

private:
  /// Of the forces on the master face by its own dofs.
  static void AddBlock(FlatArray<int> masters, SliceMatrix<> block, BlockSum & stiffness) {
    int n = masters.Size();
    ArrayMem<int, 100> order(n), sorted(n);
    for (int i : Range(n))
      order[i] = i;
    std::sort(order.begin(), order.end(), [&](int i, int j) { return masters[i] < masters[j]; });
    Matrix<> values(n, n);
    for (int j : Range(n)) {
      sorted[j] = masters[order[j]];
      values.Col(j) = block.Col(order[j]);
    }
    stiffness.Add(masters, sorted, std::move(values));
  }

  Vec<D> NormalOf(int face, Vec<D - 1> eta) const {
    Vec<D> y;
    Mat<D, D - 1> dy;
    now.master.Evaluate(face, eta, y, dy);
    return now.master.Normal(face, dy);
  }

  /// Derivative of the forces, rows and columns by function and component.
  FlatMatrix<> Block(LocalHeap & lh) {
    FlatMatrix<> block(n, n, lh);
    block = 0.0;
    sums.AddTo(traction.pressure, block);
    if (has_rim)
      block += rim;
    return block;
  }
};
} // namespace

template <int D>
void MeshScene<D>::AddDerivatives(size_t m, const MacroTraction<D> & traction, Rim rim,
                                  MacroRows<D> & rows, BlockSum & stiffness, LocalHeap & lh) const {
  auto & points = *this->points;
  auto & pairing = *points.pairing;
  ForFacePairs(points, m, [&](FlatArray<int> segments) {
    HeapReset hr(lh);
    FacePairDerivative<D> derivative(*this, pairing.segments[segments[0]], traction, rows, lh);
    for (int s : segments)
      for (size_t i : pairing.Points(s))
        derivative.Add(pairing.points[i], hits[i]);
    for (int r : points.rim[m])
      if (rim == Rim::moves && segments.Contains(pairing.rim[r].segment))
        derivative.AddRim(pairing.rim[r], this->mean[m], lh);
    derivative.AddToRows(stiffness, lh);
  });
  rows.MakeMeans(this->mean[m], points.area[m], share);
}

template <int D>
void MeshScene<D>::AddForces(size_t m, const MacroTraction<D> & traction, Scatter & y,
                             LocalHeap & lh) const {
  auto & points = *this->points;
  auto & slave_shapes = this->slave_shapes;
  auto & master_shapes = *this->master_shapes;
  ForFacePairs(points, m, [&](FlatArray<int> segments) {
    HeapReset hr(lh);
    auto & segment = points.pairing->segments[segments[0]];
    FlatVector<> on_slave(slave_shapes.Functions(segment.slave).Height(), lh);
    FlatVector<> on_master(master_shapes.Functions(segment.master).Height(), lh);
    FlatMatrixFixWidth<D> slave(on_slave.Size(), lh), master(on_master.Size(), lh);
    slave = 0.0, master = 0.0;
    for (int s : segments)
      for (size_t i : points.pairing->Points(s)) {
        auto & p = points.pairing->points[i];
        Vec<D> force = p.weight * traction.At(hits[i].normal);
        slave_shapes.CalcBasis(segment.slave, p.slave, on_slave);
        master_shapes.CalcBasis(segment.master, hits[i].eta, on_master);
        for (int j : Range(on_slave))
          slave.Row(j) -= on_slave(j) * force;
        for (int j : Range(on_master))
          master.Row(j) += on_master(j) * force;
      }
    slave_shapes.AddForces(segment.slave, slave, y, lh);
    master_shapes.AddForces(segment.master, master, y, lh);
  });
}

template <int D>
pair<Vec<D>, Vec<3>> Scene<D>::Resultant(size_t m, const MacroTraction<D> & traction) const {
  Vec<D> force = 0.0;
  Vec<3> moment = 0.0;
  for (int s : points->segments[m]) {
    int face = points->pairing->segments[s].slave;
    for (auto & p : points->pairing->points.Range(points->pairing->Points(s))) {
      Vec<D> x;
      Mat<D, D - 1> dx;
      slave.Evaluate(face, p.slave, x, dx);
      Vec<D> part = p.weight * traction.At(slave.Normal(face, dx));
      force += part;
      moment += Moment(Vec<D>(slave.Origin() + x), part);
    }
  }
  return {force, moment};
}

// --- slip ----------------------------------------------------------------------------------------

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
  template shared_ptr<MacroPoints<D>> MakePoints(shared_ptr<const Pairing<D>>, const Surface<D> &, \
                                                 const LACSpace &, FlatArray<double>);             \
  template struct MacroRows<D>;                                                                    \
  template class Scene<D>;                                                                         \
  template class MeshScene<D>;                                                                     \
  template Vec<D> Carried(const Surface<D> &, const MacroPoints<D> &, size_t, const Vec<D> &);     \
  template Vec<D> Carried(const Surface<D> &, const Surface<D> &, const MacroPoints<D> &, size_t,  \
                          const Vec<D> &);                                                         \
  template void SubtractCarried(const FaceShapes<D> &, const MacroPoints<D> &, size_t,             \
                                const Vec<D> &, MacroRows<D> &, LocalHeap &);
INSTANTIATE(2)
INSTANTIATE(3)
} // namespace ngslac
