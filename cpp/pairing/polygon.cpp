// SPDX-License-Identifier: LGPL-2.1-or-later
#include "polygon.hpp"

namespace ngslac {
namespace {
double Cross(Vec<2> a, Vec<2> b) {
  return a(0) * b(1) - a(1) * b(0);
}

/// Signed distance from the line from a to b, positive on the left.
struct Line {
  Vec<2> a, normal;
  Line(Vec<2> aa, Vec<2> b) : a(aa) {
    Vec<2> d = b - a;
    double length = L2Norm(d);
    normal = length > 0 ? Vec<2>(-d(1) / length, d(0) / length) : Vec<2>(0.0);
  }
  double operator()(Vec<2> p) const { return InnerProduct(normal, p - a); }
};

/// Is there an edge of p with all of q on its outer side?
bool Separates(const Polygon & p, const Polygon & q, double tolerance) {
  for (int i = 0; i < p.Size(); i++) {
    Line line(p[i], p[(i + 1) % p.Size()]);
    bool outside = L2Norm2(line.normal) > 0;
    for (int j = 0; j < q.Size() && outside; j++)
      outside = line(q[j]) <= tolerance;
    if (outside)
      return true;
  }
  return false;
}
} // namespace

double Polygon::Area() const {
  double twice = 0;
  for (int i = 1; i + 1 < n; i++)
    twice += Cross(corners[i] - corners[0], corners[i + 1] - corners[0]);
  return 0.5 * twice;
}

Vec<2> Polygon::Centroid() const {
  Vec<2> sum = 0.0;
  double total = 0;
  for (int i = 1; i + 1 < n; i++) {
    double area = Cross(corners[i] - corners[0], corners[i + 1] - corners[0]);
    total += area;
    sum += area / 3 * (corners[0] + corners[i] + corners[i + 1]);
  }
  return total > 0 ? Vec<2>((1 / total) * sum) : corners[0];
}

bool Polygon::IsConvex() const {
  for (int i = 0; i < n; i++) {
    auto & corner = corners[(i + 1) % n];
    Vec<2> in = corner - corners[i], out = corners[(i + 2) % n] - corner;
    if (Cross(in, out) < -1e-12 * L2Norm(in) * L2Norm(out))
      return false;
  }
  return true;
}

bool Polygon::Contains(Vec<2> point) const {
  for (int i = 0; i < n; i++)
    if (Cross(corners[(i + 1) % n] - corners[i], point - corners[i]) < 0)
      return false;
  return n > 0;
}

Polygon Clip(const Polygon & polygon, Vec<2> a, Vec<2> b, double tolerance) {
  Line line(a, b);
  auto distance = [&](Vec<2> p) {
    double d = line(p);
    return fabs(d) <= tolerance ? 0.0 : d;
  };
  Polygon result;
  int n = polygon.Size();
  if (n == 0)
    return result;
  double last = distance(polygon[n - 1]);
  for (int i = 0; i < n; i++) {
    double now = distance(polygon[i]);
    if (last * now < 0) {
      auto & before = polygon[(i + n - 1) % n];
      result.Append(before + last / (last - now) * (polygon[i] - before));
    }
    if (now >= 0)
      result.Append(polygon[i]);
    last = now;
  }
  return result;
}

Polygon Intersection(const Polygon & p, const Polygon & q, double tolerance) {
  Polygon result = p;
  for (int i = 0; i < q.Size() && result.Size(); i++)
    result = Clip(result, q[i], q[(i + 1) % q.Size()], tolerance);
  return result;
}

bool Overlap(const Polygon & p, const Polygon & q, double tolerance) {
  return !Separates(p, q, tolerance) && !Separates(q, p, tolerance);
}

void Subtract(const Polygon & p, const Polygon & q, double tolerance, Array<Polygon> & parts) {
  Polygon rest = p;
  for (int i = 0; i < q.Size(); i++) {
    auto &a = q[i], &b = q[(i + 1) % q.Size()];
    if (Polygon outside = Clip(rest, b, a, tolerance); outside.Area() > 0)
      parts.Append(outside);
    rest = Clip(rest, a, b, tolerance);
  }
}
} // namespace ngslac
