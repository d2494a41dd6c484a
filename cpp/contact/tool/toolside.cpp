// SPDX-License-Identifier: LGPL-2.1-or-later
#include "toolscene.hpp"

namespace ngslac {
namespace {
// Deeper than this part of the slave's size all of it has gone in on the wrong side.
constexpr double too_deep = 0.5;

/// Where the points of a slave are.
struct Sides {
  bool faces = false;  // does any face the tool?
  bool behind = false; // does any look the same way as the tool?
  double nearest = 0;  // distance of the point that is nearest to the surface of the tool
  double shallow = -1; // depth of the shallowest of those that face it
};

template <int D>
Sides SidesOf(const ToolScene<D> & now, const Pairing<D> & all) {
  Sides sides;
  sides.nearest = sides.shallow = std::numeric_limits<double>::infinity();
  for (size_t s : Range(all.Size()))
    for (auto & p : all.points.Range(all.Points(s))) {
      Vec<D> x;
      Mat<D, D - 1> dx;
      now.slave.Evaluate(all.segments[s].slave, p.slave, x, dx);
      auto hit = now.tool.At(now.InSpace(x));
      double cosine = InnerProduct(now.slave.Normal(all.segments[s].slave, dx), hit.normal);
      sides.nearest = min(sides.nearest, fabs(hit.distance));
      sides.behind = sides.behind || cosine >= -facing_cosine;
      if (cosine > facing_cosine)
        continue;
      sides.faces = true;
      sides.shallow = min(sides.shallow, -hit.distance);
    }
  return sides;
}

template <int D>
double SizeOf(const Surface<D> & surface) {
  netgen::Box<D> box(netgen::Box<D>::EMPTY_BOX);
  for (size_t f : Range(surface.Size()))
    for (auto & c : surface.Control(f)) {
      netgen::Point<D> p;
      for (int k : Range(D))
        p(k) = c(k);
      box.Add(p);
    }
  return box.Diam();
}
} // namespace

template <int D>
void CheckSideOfTool(const ToolScene<D> & now, const Pairing<D> & all, double maxdist) {
  auto sides = SidesOf(now, all);
  string remedy = "does its normal point the wrong way? Remedy: the other normal, the corners of a "
                  "Polygon in the other order (the tool is on their left), a minus before a tool "
                  "that is a cavity (or before a signed distance that is > 0 inside)";
  if (!sides.faces && sides.behind && !(maxdist > 0 && sides.nearest > maxdist))
    throw Exception("LACContact: slave and tool never meet: no slave normal points at the surface "
                    "of the tool from outside, the slave looks away from it; " +
                    remedy + "; or give the maxdist that the tool is farther away than at first");
  if (sides.faces && sides.shallow > too_deep * SizeOf(now.slave))
    throw Exception("LACContact: all of the slave that faces the tool is inside of it, " +
                    ToString(sides.shallow) + " deep at least; " + remedy +
                    "; or move them apart at first");
}

template void CheckSideOfTool(const ToolScene<2> &, const Pairing<2> &, double);
template void CheckSideOfTool(const ToolScene<3> &, const Pairing<3> &, double);
} // namespace ngslac
