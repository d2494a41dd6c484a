// SPDX-License-Identifier: LGPL-2.1-or-later
#include "macrotool.hpp"

namespace ngslac {
template <int D>
shared_ptr<Pairing<D>> AllPoints(const Surface<D> & reference, int order) {
  return make_shared<Pairing<D>>(PairWithObstacle<D>(reference, order));
}

namespace {
/// From there on, as an angle of both normals of 120 degrees, a point faces the tool as a whole.
constexpr double whole_cosine = -0.5;

double PartOfWay(double cosine) {
  return (facing_cosine - cosine) / (facing_cosine - whole_cosine);
}
} // namespace

double Facing(double cosine) {
  double t = min(1.0, max(0.0, PartOfWay(cosine)));
  return t * t * (3 - 2 * t);
}

double FacingGrowth(double cosine) {
  double t = PartOfWay(cosine);
  if (t <= 0 || t >= 1)
    return 0;
  return -6 * (1 - t) / (t * (3 - 2 * t)) / (facing_cosine - whole_cosine);
}

namespace {
/// A point of the slave surface with what the tool is there.
template <int D>
struct SlavePoint {
  Vec<D> x, normal;
  Mat<D, D - 1> dx;
  ToolHit<D> hit;

  SlavePoint(const Surface<D> & slave, const ToolPosition<D> & tool, int face, Vec<D - 1> xi) {
    slave.Evaluate(face, xi, x, dx);
    normal = slave.Normal(face, dx);
    hit = tool.At(slave.Origin() + x);
  }
  /// The cosine between both normals; 0 where the tool has none.
  double Cosine() const { return InnerProduct(normal, hit.normal); }
  /// To the plane that touches the tool, along the slave normal.
  double Along() const { return -hit.distance / Cosine(); }
};
} // namespace

template <int D>
shared_ptr<Pairing<D>> FacingPoints(const Pairing<D> & all, const Surface<D> & slave,
                                    const ToolPosition<D> & tool) {
  auto result = make_shared<Pairing<D>>(all);
  ParallelFor(result->Size(), [&](size_t s) {
    int face = result->segments[s].slave;
    auto set = [&](PairPoint<D> & p) {
      SlavePoint<D> point(slave, tool, face, p.slave);
      double share = Facing(point.Cosine());
      p.gap = share > 0 ? point.Along() : point.hit.distance;
      p.normal = point.normal;
      p.weight *= share;
    };
    for (auto & p : result->points.Range(result->Points(s)))
      set(p);
    for (auto & p : result->corners.Range(result->Corners(s)))
      set(p);
  });
  return result;
}

template <int D>
ToolPartners<D> PartnersOf(const Pairing<D> & points, const Surface<D> & slave,
                           const ToolPosition<D> & tool) {
  ToolPartners<D> result;
  size_t n = points.points.Size();
  result.at.SetSize(n), result.normal.SetSize(n), result.gap.SetSize(n);
  ParallelFor(points.Size(), [&](size_t s) {
    for (size_t i : points.Points(s)) {
      auto & p = points.points[i];
      SlavePoint<D> point(slave, tool, points.segments[s].slave, p.slave);
      result.gap[i] = p.weight > 0 ? point.Along() : 0;
      Vec<D> partner = slave.Origin() + point.x + result.gap[i] * point.normal;
      Vec<D> normal = tool.At(partner).normal;
      if (L2Norm2(normal) == 0)
        normal = point.hit.normal;
      result.at[i] = tool.place.ToTool(partner);
      result.normal[i] = Trans(tool.place.turn) * normal;
    }
  });
  return result;
}

template <int D>
MacroGap<D> MeanDistance(const ToolScene<D> & now, const MacroPoints<D> & points, size_t macro) {
  double distance = 0;
  Vec<D> slave = 0.0, tool = 0.0;
  for (int s : points.segments[macro])
    for (auto & p : points.pairing->points.Range(points.pairing->Points(s)))
      if (p.weight > 0) {
        SlavePoint<D> point(now.slave, now.tool, points.pairing->segments[s].slave, p.slave);
        distance += p.weight * point.hit.distance;
        slave += p.weight * point.normal;
        tool += p.weight * point.hit.normal;
      }
  double mean = 1 / points.area[macro];
  return {mean * distance, mean * slave, mean * tool, 1.0};
}

template <int D>
void AddToolTraction(const ToolScene<D> & now, const MacroPoints<D> & points, size_t macro,
                     const MacroTraction<D> & traction, Scatter & y, LocalHeap & lh) {
  for (int s : points.segments[macro]) {
    HeapReset hr(lh);
    int face = points.pairing->segments[s].slave;
    FlatVector<> values(now.shapes.Functions(face).Height(), lh);
    FlatMatrixFixWidth<D> forces(values.Size(), lh);
    forces = 0.0;
    for (auto & p : points.pairing->points.Range(points.pairing->Points(s))) {
      if (p.weight == 0)
        continue;
      Vec<D> x;
      Mat<D, D - 1> dx;
      now.slave.Evaluate(face, p.slave, x, dx);
      Vec<D> force = p.weight * traction.At(now.slave.Normal(face, dx));
      now.shapes.CalcBasis(face, p.slave, values);
      for (int i : Range(values))
        forces.Row(i) -= values(i) * force;
      for (auto & own : now.tool.dofs)
        y.Add(own.dof, InnerProduct(force, own.At(now.InSpace(x))));
    }
    now.shapes.AddForces(face, forces, y, lh);
  }
}

#define INSTANTIATE(D)                                                                             \
  template shared_ptr<Pairing<D>> AllPoints(const Surface<D> &, int);                              \
  template shared_ptr<Pairing<D>> FacingPoints(const Pairing<D> &, const Surface<D> &,             \
                                               const ToolPosition<D> &);                           \
  template ToolPartners<D> PartnersOf(const Pairing<D> &, const Surface<D> &,                      \
                                      const ToolPosition<D> &);                                    \
  template MacroGap<D> MeanDistance(const ToolScene<D> &, const MacroPoints<D> &, size_t);         \
  template void AddToolTraction(const ToolScene<D> &, const MacroPoints<D> &, size_t,              \
                                const MacroTraction<D> &, Scatter &, LocalHeap &);
INSTANTIATE(2)
INSTANTIATE(3)
} // namespace ngslac
