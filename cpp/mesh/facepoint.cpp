// SPDX-License-Identifier: LGPL-2.1-or-later
#include "facepoint.hpp"

#include <algorithm>

namespace ngslac {
namespace {
using netgen::NetgenGeometry;
using netgen::PointGeomInfo;
using Point3 = netgen::Point<3>;

// The nearest point of a surface, found from the parameters gi unless these mislead.
FacePoint Project(const NetgenGeometry & geometry, int surface, const Point3 & p,
                  const PointGeomInfo & gi, double reach) {
  FacePoint fp{p, gi};
  if (geometry.ProjectPointGI(surface, fp.p, fp.gi) && netgen::Dist(p, fp.p) <= reach)
    return fp;
  fp.p = p;
  fp.gi = geometry.ProjectPoint(surface, fp.p);
  return fp;
}

// Points of a mesh can have been moved since it was generated. Its geometry is then no guide.
bool LiesOnGeometry(const NetgenGeometry & geometry, int surface, const netgen::Mesh & mesh,
                    const netgen::Element2d & el, double tolerance) {
  for (int i : ngcore::Range(el.GetNV())) {
    Point3 p = mesh[el[i]];
    auto fp = Project(geometry, surface, p, el.GeomInfo()[i], tolerance);
    if (!(netgen::Dist(p, fp.p) <= tolerance))
      return false;
  }
  return true;
}
} // namespace

FacePoint PointOnFace(const netgen::Mesh & mesh, const netgen::Element2d & el,
                      const std::vector<double> & weights) {
  FacePoint mean{Point3(0, 0, 0), el.GeomInfo()[0]};
  mean.gi.u = mean.gi.v = 0;
  double size = 0;
  for (int i : ngcore::Range(el.GetNV())) {
    Point3 p = mesh[el[i]];
    mean.p += weights[i] * netgen::Vec<3>(p);
    mean.gi.u += weights[i] * el.GeomInfo()[i].u;
    mean.gi.v += weights[i] * el.GeomInfo()[i].v;
    size = std::max(size, netgen::Dist(mesh[el[0]], p));
  }
  auto geometry = mesh.GetGeometry();
  int surface = mesh.GetFaceDescriptor(el).SurfNr();
  if (!geometry || !LiesOnGeometry(*geometry, surface, mesh, el, 1e-4 * size))
    return mean;

  // The parameters of a corner at a pole are arbitrary, and so is their mean: try other starts.
  std::vector<PointGeomInfo> starts{mean.gi};
  for (int i : ngcore::Range(el.GetNV()))
    starts.push_back(el.GeomInfo()[i]);
  for (auto gi : starts) {
    Point3 p = mean.p;
    if (geometry->ProjectPointGI(surface, p, gi) && netgen::Dist(p, mean.p) <= size)
      return {p, gi};
  }
  auto fp = Project(*geometry, surface, mean.p, mean.gi, size);
  return netgen::Dist(mean.p, fp.p) <= size ? fp : mean;
}
} // namespace ngslac
