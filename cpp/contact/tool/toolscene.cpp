// SPDX-License-Identifier: LGPL-2.1-or-later
#include "toolscene.hpp"
#include "contact/finite/facepair.hpp"

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

  SlavePoint(const ToolScene<D> & now, int face, Vec<D - 1> xi) {
    now.slave.Evaluate(face, xi, x, dx);
    normal = now.slave.Normal(face, dx);
    hit = now.tool.At(now.InSpace(x));
  }
  /// The cosine between both normals; 0 where the tool has none.
  double Cosine() const { return InnerProduct(normal, hit.normal); }
  /// To the plane that touches the tool, along the slave normal.
  double Along() const { return -hit.distance / Cosine(); }
};
} // namespace

template <int D>
shared_ptr<Pairing<D>> FacingPoints(const Pairing<D> & all, const ToolScene<D> & now) {
  auto result = make_shared<Pairing<D>>(all);
  ParallelFor(result->Size(), [&](size_t s) {
    int face = result->segments[s].slave;
    auto set = [&](PairPoint<D> & p) {
      SlavePoint<D> point(now, face, p.slave);
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
shared_ptr<const SlipPairs<D>> ToolScene<D>::Pairs() const {
  auto pairs = make_shared<SlipPairs<D>>(this->points);
  auto & pairing = *this->points->pairing;
  size_t n = pairing.points.Size();
  pairs->at.SetSize(n), pairs->normal.SetSize(n), pairs->gap.SetSize(n);
  ParallelFor(pairing.Size(), [&](size_t s) {
    for (size_t i : pairing.Points(s)) {
      auto & p = pairing.points[i];
      SlavePoint<D> point(*this, pairing.segments[s].slave, p.slave);
      pairs->gap[i] = p.weight > 0 ? point.Along() : 0;
      Vec<D> partner = InSpace(point.x) + pairs->gap[i] * point.normal;
      Vec<D> normal = tool.At(partner).normal;
      if (L2Norm2(normal) == 0)
        normal = point.hit.normal;
      pairs->at[i] = tool.place.ToTool(partner);
      pairs->normal[i] = Trans(tool.place.turn) * normal;
    }
  });
  return pairs;
}

template <int D>
double ToolScene<D>::GapAt(const Segment & segment, const PairPoint<D> & p) const {
  SlavePoint<D> point(*this, segment.slave, p.slave);
  return point.Cosine() < facing_cosine ? point.hit.distance
                                        : std::numeric_limits<double>::quiet_NaN();
}

template <int D>
MacroGap<D> ToolScene<D>::MeanOf(size_t m) {
  auto & points = *this->points;
  double distance = 0;
  Vec<D> slave = 0.0, tool = 0.0;
  for (int s : points.segments[m])
    for (auto & p : points.pairing->points.Range(points.pairing->Points(s)))
      if (p.weight > 0) {
        SlavePoint<D> point(*this, points.pairing->segments[s].slave, p.slave);
        distance += p.weight * point.hit.distance;
        slave += p.weight * point.normal;
        tool += p.weight * point.hit.normal;
      }
  double mean = 1 / points.area[m];
  return {mean * distance, mean * slave, mean * tool, 1.0};
}

template <int D>
void ToolScene<D>::AddForces(size_t m, const MacroTraction<D> & traction, Scatter & y,
                             LocalHeap & lh) const {
  auto & points = *this->points;
  auto & shapes = this->slave_shapes;
  for (int s : points.segments[m]) {
    HeapReset hr(lh);
    int face = points.pairing->segments[s].slave;
    FlatVector<> values(shapes.Functions(face).Height(), lh);
    FlatMatrixFixWidth<D> forces(values.Size(), lh);
    forces = 0.0;
    for (auto & p : points.pairing->points.Range(points.pairing->Points(s))) {
      if (p.weight == 0)
        continue;
      Vec<D> x;
      Mat<D, D - 1> dx;
      this->slave.Evaluate(face, p.slave, x, dx);
      Vec<D> force = p.weight * traction.At(this->slave.Normal(face, dx));
      shapes.CalcBasis(face, p.slave, values);
      for (int i : Range(values))
        forces.Row(i) -= values(i) * force;
      for (auto & own : tool.dofs)
        y.Add(own.dof, InnerProduct(force, own.At(InSpace(x))));
    }
    shapes.AddForces(face, forces, y, lh);
  }
}

namespace {
/// Adds what the points of one slave face contribute to the derivatives: by its scalar functions,
/// and after them by the unknowns of the tool.
template <int D>
class ToolFaceDerivative {
  const ToolScene<D> & now;
  const MacroGap<D> & mean;
  const MacroTraction<D> & traction;
  MacroRows<D> & rows;
  FacePair<D> faces;
  bool loaded, moving;
  int n1, n;
  FlatMatrix<> columns; // as in MacroRows, but the sums of both normals
  FlatMatrix<> block;   // forces

  /// What is known of a point.
  struct Point {
    double weight;
    Vec<D> x, normal; // in the space
    ToolHit<D> hit;
    Mat<D, D> bend;
    FlatVector<> values;
    FlatMatrixFixWidth<D> gradients;
  };

public:
  ToolFaceDerivative(const ToolScene<D> & anow, const Segment & segment, const MacroGap<D> & amean,
                     const MacroTraction<D> & atraction, bool amoving, MacroRows<D> & arows,
                     LocalHeap & lh)
      : now(anow), mean(amean), traction(atraction), rows(arows), faces(now, segment, rows, lh),
        loaded(!traction.IsZero()), moving(amoving), n1(faces.Size()), n(n1 + now.tool.dofs.Size()),
        columns(3 * D + 2, n, lh), block(n, n, lh) {
    columns = 0.0, block = 0.0;
  }

  void Add(const PairPoint<D> & p, LocalHeap & lh) {
    int face = faces.segment.slave;
    Vec<D> x;
    Mat<D, D - 1> dx;
    now.slave.Evaluate(face, p.slave, x, dx);
    x = Vec<D>(now.InSpace(x));
    auto hit = now.tool.At(x);
    auto shapes = now.slave_shapes.Calc(face, p.slave, lh);
    Point point{p.weight,
                x,
                now.slave.Normal(face, dx),
                hit,
                now.tool.Bend(x, hit),
                shapes.value,
                Gradients<D>(dx, shapes, lh)};
    MoveSlave(point);
    for (int t : Range(now.tool.dofs))
      MoveTool(point, n1 + t, now.tool.dofs[t]);
    if (loaded)
      TurnForces(point);
    if (moving)
      Grow(point, lh);
  }

  void AddToRows(LocalHeap & lh) {
    FlatArray<int> at = Positions(lh);
    auto of_dofs = OfDofs(columns, lh);
    for (int row : Range(of_dofs.Height()))
      for (int j : Range(at))
        rows.data(row, at[j]) += of_dofs(row, j);
    if (!loaded)
      return;
    FlatMatrix<> transposed(n, of_dofs.Width(), lh), turned(of_dofs.Width(), n, lh);
    transposed = OfDofs(block, lh);
    turned = Trans(transposed);
    auto by_dofs = OfDofs(turned, lh); // rows: what moves, columns: what is pushed
    for (int j : Range(at))
      for (int i : Range(at))
        rows.stiffness(at[i], rows.TurningPosition(rows.dofs[at[j]])) += by_dofs(j, i);
  }

private:
  /// By dof D i + k the slave normal turns by  -n_k g_i.
  void MoveSlave(const Point & point) {
    for (int i : Range(faces.slaves))
      for (int k : Range(D)) {
        int j = D * i + k;
        double value = point.weight * point.values(i);
        columns(D + k, j) += value;
        columns(2 * D, j) += value * point.hit.gradient(k);
        columns(2 * D + 1, j) += value * point.normal(k);
        for (int l : Range(D)) {
          columns(l, j) -= point.weight * point.normal(k) * point.gradients(i, l);
          columns(2 * D + 2 + l, j) += value * point.bend(l, k);
        }
      }
  }

  /// An unknown of the tool moves it under the point.
  void MoveTool(const Point & point, int column, const ToolDof<D> & own) {
    Vec<D> velocity = own.At(point.x), turn = own.spin * point.hit.normal - point.bend * velocity;
    columns(2 * D, column) -= point.weight * InnerProduct(point.hit.gradient, velocity);
    columns(2 * D + 1, column) -= point.weight * InnerProduct(point.normal, velocity);
    for (int l : Range(D)) {
      columns(D + l, column) -= point.weight * velocity(l);
      columns(2 * D + 2 + l, column) += point.weight * turn(l);
    }
  }

  /// A constant pressure turns with the slave normal; moments change with the point.
  void TurnForces(const Point & point) {
    double pressed = point.weight * traction.pressure;
    Vec<D> force = point.weight * traction.At(point.normal);
    auto & dofs = now.tool.dofs;
    for (int j : Range(faces.slaves))
      for (int k : Range(D)) {
        double turned = -pressed * point.normal(k);
        for (int i : Range(faces.slaves))
          for (int l : Range(D))
            block(D * i + l, D * j + k) += turned * point.gradients(j, l) * point.values(i);
        for (int t : Range(dofs))
          block(n1 + t, D * j + k) +=
              InnerProduct(force, dofs[t].spin.Col(k)) * point.values(j) -
              turned * InnerProduct(point.gradients.Row(j), dofs[t].At(point.x));
      }
    for (int t : Range(dofs))
      for (int other : Range(dofs))
        if (dofs[t].turns && !dofs[other].turns)
          block(n1 + t, n1 + other) -=
              InnerProduct(force, Vec<D>(dofs[t].spin * dofs[other].linear));
  }

  /// The weight changes with the angle between both normals.
  void Grow(const Point & point, LocalHeap & lh) {
    double factor = point.weight * FacingGrowth(InnerProduct(point.normal, point.hit.normal));
    if (factor == 0)
      return;
    FlatVector<> growth(n, lh), work(n, lh);
    Vec<D> by_place = Trans(point.bend) * point.normal, force = traction.At(point.normal);
    for (int i : Range(faces.slaves)) {
      double turning = InnerProduct(point.hit.normal, point.gradients.Row(i));
      for (int k : Range(D)) {
        growth(D * i + k) = by_place(k) * point.values(i) - turning * point.normal(k);
        work(D * i + k) = force(k) * point.values(i);
      }
    }
    for (int t : Range(now.tool.dofs)) {
      auto & own = now.tool.dofs[t];
      Vec<D> velocity = own.At(point.x), spun = own.spin * point.hit.normal;
      growth(n1 + t) = InnerProduct(point.normal, spun) - InnerProduct(by_place, velocity);
      work(n1 + t) = -InnerProduct(force, velocity);
    }
    growth *= factor;
    columns.Row(2 * D) += (point.hit.distance - mean.gap) * growth;
    for (int l : Range(D)) {
      columns.Row(l) += (point.normal(l) - mean.slave(l)) * growth;
      columns.Row(2 * D + 2 + l) += (point.hit.normal(l) - mean.master(l)) * growth;
    }
    if (loaded)
      block -= work * Trans(growth);
  }

  /// Of all columns in the rows of the macro-element.
  FlatArray<int> Positions(LocalHeap & lh) const {
    FlatArray<int> at(faces.at.Size() + now.tool.dofs.Size(), lh);
    at.Range(0, faces.at.Size()) = faces.at;
    for (int t : Range(now.tool.dofs))
      at[faces.at.Size() + t] = rows.Position(now.tool.dofs[t].dof);
    return at;
  }

  /// A column for each dof in place of each function and component.
  FlatMatrix<> OfDofs(FlatMatrix<> m, LocalHeap & lh) const {
    FlatMatrix<> own(m.Height(), n1, lh);
    own = m.Cols(0, n1);
    auto of_face = faces.OfDofs(own, lh);
    int width = of_face.Width();
    FlatMatrix<> result(m.Height(), width + n - n1, lh);
    result.Cols(0, width) = of_face;
    result.Cols(width, result.Width()) = m.Cols(n1, n);
    return result;
  }
};
} // namespace

template <int D>
void ToolScene<D>::AddDerivatives(size_t m, const MacroTraction<D> & traction, Rim rim,
                                  MacroRows<D> & rows, BlockSum &, LocalHeap & lh) const {
  auto & points = *this->points;
  auto & mean = this->mean[m];
  for (int s : points.segments[m]) {
    HeapReset hr(lh);
    auto & segment = points.pairing->segments[s];
    ToolFaceDerivative<D> derivative(*this, segment, mean, traction, rim == Rim::moves, rows, lh);
    for (auto & p : points.pairing->points.Range(points.pairing->Points(s)))
      if (p.weight > 0) {
        HeapReset hr(lh);
        derivative.Add(p, lh);
      }
    derivative.AddToRows(lh);
  }
  rows.MakeMeans(mean, points.area[m], 1);
}

namespace {
/// A point of the slave, and the point of the tool that it once faced, where they are now.
template <int D>
struct OldPartner {
  Vec<D> apart, slave_normal, normal; // of the tool, then
  Vec<D> place;                       // of the tool's point
  Mat<D, D - 1> dx;

  OldPartner(const ToolScene<D> & now, const SlipPairs<D> & partners, size_t point, int face,
             Vec<D - 1> xi) {
    Vec<D> x;
    now.slave.Evaluate(face, xi, x, dx);
    slave_normal = now.slave.Normal(face, dx);
    normal = now.tool.place.turn * partners.normal[point];
    place = now.tool.place.ToSpace(partners.at[point]);
    apart = now.InSpace(x) + partners.gap[point] * slave_normal - place;
  }
  Mat<D, D> Across() const { return Id<D>() - normal * Trans(normal); }
};
} // namespace

template <int D>
Vec<D> ToolScene<D>::SlipOf(const SlipPairs<D> & pairs, size_t m) const {
  auto & points = pairs.points->pairing->points;
  return ngslac::MeanOf(*pairs.points, m, [&](const Segment & segment, size_t i) {
    OldPartner<D> old(*this, pairs, i, segment.slave, points[i].slave);
    return Vec<D>(old.Across() * old.apart);
  });
}

template <int D>
void ToolScene<D>::AddSlip(const SlipPairs<D> & pairs, size_t m, MacroRows<D> & rows,
                           LocalHeap & lh) const {
  auto & points = *pairs.points;
  double mean = 1 / points.area[m];
  for (int s : points.segments[m]) {
    HeapReset hr(lh);
    auto & segment = points.pairing->segments[s];
    FacePair<D> faces(*this, segment, rows, lh);
    FlatMatrix<> columns(D, faces.Size(), lh);
    columns = 0.0;
    for (size_t point : points.pairing->Points(s)) {
      auto & p = points.pairing->points[point];
      if (p.weight == 0)
        continue;
      HeapReset hr(lh);
      double weight = mean * p.weight;
      OldPartner<D> old(*this, pairs, point, segment.slave, p.slave);
      auto shapes = this->slave_shapes.Calc(segment.slave, p.slave, lh);
      auto gradients = Gradients<D>(old.dx, shapes, lh);
      Mat<D, D> across = old.Across();
      for (int i : Range(faces.slaves)) {
        Vec<D> swing = pairs.gap[point] * Vec<D>(across * Vec<D>(gradients.Row(i)));
        for (int l : Range(D))
          for (int k : Range(D))
            columns(l, D * i + k) +=
                weight * (across(l, k) * shapes.value(i) - swing(l) * old.slave_normal(k));
      }
      for (auto & own : tool.dofs) {
        Vec<D> turn = own.spin * old.normal, moved = across * own.At(old.place);
        moved += InnerProduct(old.normal, old.apart) * turn;
        moved += InnerProduct(turn, old.apart) * old.normal;
        for (int l : Range(D))
          rows.slip(l, rows.Position(own.dof)) -= weight * moved(l);
      }
    }
    faces.AddTo(rows.slip, columns, 1, lh);
  }
}

#define INSTANTIATE(D)                                                                             \
  template shared_ptr<Pairing<D>> AllPoints(const Surface<D> &, int);                              \
  template shared_ptr<Pairing<D>> FacingPoints(const Pairing<D> &, const ToolScene<D> &);          \
  template class ToolScene<D>;
INSTANTIATE(2)
INSTANTIATE(3)
} // namespace ngslac
