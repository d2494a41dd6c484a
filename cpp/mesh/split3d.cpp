// SPDX-License-Identifier: LGPL-2.1-or-later
#include "split.hpp"

#include <algorithm>
#include <limits>
#include <map>

namespace ngslac {
namespace {
using netgen::Element;
using netgen::Element2d;
using netgen::ElementIndex;
using netgen::NetgenGeometry;
using netgen::PointGeomInfo;
using netgen::PointIndex;
using netgen::SurfaceElementIndex;
using Point3 = netgen::Point<3>;
using Corners = std::vector<PointIndex>;

// A point on a surface element, with its parameters on the surface of the geometry.
struct FacePoint {
  Point3 p;
  PointGeomInfo gi;
};

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

// The mean of the corners, projected to the geometry of the mesh. It stays where it is if the mesh
// has no geometry, or if its points do not lie on it.
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

// Splits faces of a three-dimensional mesh in place.
//
// Cone pattern: the face gets a vertex at its centre, and a volume element becomes the cones from
// this vertex over its other faces. Hexahedral pattern: the face gets four vertices, which make a
// smaller quadrilateral in it; five quadrilaterals and six hexahedra result. Both leave the edges
// and the other faces of the element alone, so that a piece with another slave face is split like
// an element.
class FaceSplitter {
  netgen::Mesh & mesh;

  struct Face {
    bool cone = true;
    double size = 0;                        // the first face to be split is the largest
    std::map<PointIndex, PointIndex> inner; // hexahedral pattern: the new vertex next to a corner
    PointIndex center = PointIndex::INVALID;
  };
  std::map<Corners, Face> faces; // by the sorted corners
  BitArray slave_points;

public:
  explicit FaceSplitter(netgen::Mesh & amesh) : mesh(amesh), slave_points(mesh.GetNP()) {
    slave_points.Clear();
  }

  void Mark(SurfaceElementIndex sei) {
    const Element2d el(mesh[sei]);
    Face face;
    for (int i : Range(1, el.GetNV() - 1))
      face.size += netgen::Cross(mesh[el[i]] - mesh[el[0]], mesh[el[i + 1]] - mesh[el[0]]).Length();
    faces[MakeKey(el.Vertices())] = face;
    for (auto pi : el.Vertices())
      slave_points.SetBit(pi - netgen::IndexBASE<PointIndex>());
  }

  // Hexahedra on both sides of a quadrilateral can stay hexahedra.
  void ChooseHexPattern() {
    for (auto & [key, face] : faces)
      face.cone = key.size() == 3;
    for (auto el : mesh.VolumeElements())
      if (el.GetType() != netgen::HEX)
        for (auto & corners : OuterFaces(el))
          if (auto face = FindFace(corners))
            face->cone = true;
  }

  void Split() {
    for (auto sei : mesh.SurfaceElements().Range())
      SplitSurfaceElement(sei);
    for (auto ei : mesh.VolumeElements().Range())
      SplitElement(ei);
  }

private:
  template <typename T>
  static Corners MakeKey(const T & corners) {
    Corners key(corners.begin(), corners.end());
    std::sort(key.begin(), key.end());
    return key;
  }

  Face * FindFace(const Corners & corners) {
    auto it = faces.find(MakeKey(corners));
    return it == faces.end() ? nullptr : &it->second;
  }

  // The faces of an element, seen counterclockwise from outside if its volume is positive.
  static std::vector<Corners> OuterFaces(const netgen::ElementRef & el) {
    std::vector<Corners> all;
    Element2d face(netgen::QUAD);
    for (int k : Range(el.GetNFaces())) {
      el.GetFace2(k + 1, face);
      Corners corners(face.Vertices().begin(), face.Vertices().end());
      if (el.GetType() == netgen::TET) // Netgen's tetrahedra are left-handed
        std::reverse(corners.begin(), corners.end());
      all.push_back(corners);
    }
    return all;
  }

  // Means of the corners of a quadrilateral: a third of the way in from each side that meets at i.
  static std::vector<double> InnerWeights(int i) {
    std::vector<double> weights(4, 2.0 / 9);
    weights[i] = 4.0 / 9;
    weights[(i + 2) % 4] = 1.0 / 9;
    return weights;
  }

  PointGeomInfo AddPoint(const Element2d & el, const std::vector<double> & weights,
                         PointIndex & pi) {
    auto [p, gi] = PointOnFace(mesh, el, weights);
    // A second surface element on the same corners shares the point.
    if (!pi.IsValid())
      pi = mesh.AddPoint(p, mesh[el[0]].GetLayer(), netgen::SURFACEPOINT);
    return gi;
  }

  // Surface elements.

  void SplitSurfaceElement(SurfaceElementIndex sei) {
    const Element2d el(mesh[sei]);
    Face * face = FindFace(Corners(el.Vertices().begin(), el.Vertices().end()));
    if (!face)
      return;
    auto parts = face->cone ? SurfaceCone(el, *face) : SurfaceRing(el, *face);
    for (size_t i : Range(parts.size())) {
      parts[i].SetIndex(el.GetIndex());
      if (i == 0)
        mesh[sei] = parts[i];
      else
        mesh.AddSurfaceElement(parts[i]);
    }
  }

  std::vector<Element2d> SurfaceCone(const Element2d & el, Face & face) {
    int n = el.GetNV();
    PointGeomInfo gi = AddPoint(el, std::vector<double>(n, 1.0 / n), face.center);
    std::vector<Element2d> parts;
    for (int i : Range(n)) {
      int next = (i + 1) % n;
      Element2d part(netgen::TRIG);
      part[0] = el[i], part[1] = el[next], part[2] = face.center;
      part.GeomInfo()[0] = el.GeomInfo()[i];
      part.GeomInfo()[1] = el.GeomInfo()[next];
      part.GeomInfo()[2] = gi;
      parts.push_back(part);
    }
    return parts;
  }

  std::vector<Element2d> SurfaceRing(const Element2d & el, Face & face) {
    Element2d inner(netgen::QUAD);
    for (int i : Range(4)) {
      PointIndex & pi = face.inner.try_emplace(el[i], PointIndex::INVALID).first->second;
      inner.GeomInfo()[i] = AddPoint(el, InnerWeights(i), pi);
      inner[i] = pi;
    }
    std::vector<Element2d> parts{inner};
    for (int i : Range(4)) {
      int next = (i + 1) % 4;
      Element2d part(netgen::QUAD);
      part[0] = el[i], part[1] = el[next], part[2] = inner[next], part[3] = inner[i];
      part.GeomInfo()[0] = el.GeomInfo()[i];
      part.GeomInfo()[1] = el.GeomInfo()[next];
      part.GeomInfo()[2] = inner.GeomInfo()[next];
      part.GeomInfo()[3] = inner.GeomInfo()[i];
      parts.push_back(part);
    }
    return parts;
  }

  // Volume elements.

  void SplitElement(ElementIndex ei) {
    const Element whole(mesh[ei]);
    if (!CanHaveSlaveFace(whole))
      return;
    auto parts = SplitRepeatedly({whole});
    if (parts.size() == 1)
      return;
    if (!AreOriented(parts, whole))
      throw Exception("SplitSlaveFaces: the boundary is so strongly curved that a split element "
                      "would fold over at " +
                      ToString(mesh[whole[0]]) + "; use a finer mesh there");
    for (size_t i : Range(parts.size())) {
      parts[i].SetIndex(whole.GetIndex());
      if (i == 0)
        mesh[ei] = parts[i];
      else
        mesh.AddVolumeElement(parts[i]);
    }
  }

  std::vector<Element> SplitRepeatedly(std::vector<Element> parts) {
    for (size_t i = 0; i < parts.size();) {
      auto pieces = SplitOnce(parts[i]);
      if (pieces.empty()) {
        i++;
        continue;
      }
      parts[i] = pieces[0];
      parts.insert(parts.end(), pieces.begin() + 1, pieces.end());
    }
    return parts;
  }

  // A quick look before the faces are searched.
  bool CanHaveSlaveFace(const Element & el) const {
    int n = 0;
    for (auto pi : el.Vertices())
      n += slave_points.Test(pi - netgen::IndexBASE<PointIndex>());
    return n >= 3;
  }

  // The pieces around one slave face of an element, none if it has no slave face.
  std::vector<Element> SplitOnce(const Element & el) {
    auto outer = OuterFaces(el);
    const Face * face = nullptr;
    size_t nr = 0;
    for (size_t k : Range(outer.size()))
      // A cone would leave no hexahedron for a face with the hexahedral pattern, so it comes later.
      if (auto f = FindFace(outer[k]);
          f && (!face || std::pair(!f->cone, f->size) > std::pair(!face->cone, face->size))) {
        face = f;
        nr = k;
      }
    if (!face)
      return {};
    return face->cone ? Cones(outer, nr, face->center) : Hexes(outer, nr, *face);
  }

  static Element MakeElement(netgen::ELEMENT_TYPE type, const Corners & corners) {
    Element el(type);
    for (size_t j : Range(corners.size()))
      el[j] = corners[j];
    return el;
  }

  // The cones over all faces but the base.
  static std::vector<Element> Cones(const std::vector<Corners> & outer, size_t base,
                                    PointIndex apex) {
    std::vector<Element> pieces;
    for (size_t k : Range(outer.size())) {
      if (k == base)
        continue;
      Corners corners = outer[k];
      bool trig = corners.size() == 3;
      if (!trig)
        std::reverse(corners.begin(), corners.end());
      corners.push_back(apex);
      pieces.push_back(MakeElement(trig ? netgen::TET : netgen::PYRAMID, corners));
    }
    return pieces;
  }

  // A hexahedron below the inner quadrilateral, to half of the depth, and five around it.
  std::vector<Element> Hexes(const std::vector<Corners> & outer, size_t base, const Face & face) {
    Corners a(outer[base].rbegin(), outer[base].rend()); // seen from inside
    Corners b, c, m;
    for (auto pi : a) {
      b.push_back(OppositeCorner(outer, base, pi));
      c.push_back(face.inner.at(pi));
    }
    for (int i : Range(4)) {
      Point3 far(0, 0, 0);
      auto weights = InnerWeights(i);
      for (int j : Range(4))
        far += weights[j] * netgen::Vec<3>(mesh[b[j]]);
      m.push_back(mesh.AddPoint(netgen::Center(mesh[c[i]], far), mesh[a[i]].GetLayer(),
                                netgen::INNERPOINT));
    }
    std::vector<Element> pieces;
    auto add = [&](Corners corners) { pieces.push_back(MakeElement(netgen::HEX, corners)); };
    add({c[0], c[1], c[2], c[3], m[0], m[1], m[2], m[3]});
    add({m[0], m[1], m[2], m[3], b[0], b[1], b[2], b[3]});
    for (int i : Range(4)) {
      int j = (i + 1) % 4;
      add({a[i], a[j], c[j], c[i], b[i], b[j], m[j], m[i]});
    }
    return pieces;
  }

  // The other end of the edge of a hexahedron that leaves the base at this corner.
  static PointIndex OppositeCorner(const std::vector<Corners> & outer, size_t base,
                                   PointIndex corner) {
    auto in_base = [&](PointIndex pi) {
      return std::find(outer[base].begin(), outer[base].end(), pi) != outer[base].end();
    };
    for (auto & face : outer)
      for (int j : Range(4))
        for (int step : {1, 3})
          if (face[j] == corner && !in_base(face[(j + step) % 4]))
            return face[(j + step) % 4];
    throw Exception("SplitSlaveFaces: broken hexahedron");
  }

  // Sum and least of the volumes spanned at the corners, positive if Netgen takes the element so.
  std::pair<double, double> CornerVolumes(const Element & el) const {
    double sum = 0, least = std::numeric_limits<double>::max();
    auto corner = [&](int at, int i, int j, int k) {
      auto & p = mesh[el[at]];
      double volume =
          netgen::Cross(mesh[el[i]] - p, mesh[el[j]] - p) * netgen::Vec<3>(mesh[el[k]] - p);
      sum += volume;
      least = std::min(least, volume);
    };
    switch (el.GetType()) {
    case netgen::TET:
      corner(0, 2, 1, 3);
      break;
    case netgen::PYRAMID:
      for (int i : Range(4))
        corner(i, (i + 1) % 4, (i + 3) % 4, 4);
      break;
    case netgen::PRISM:
      for (int i : Range(3)) {
        corner(i, (i + 1) % 3, (i + 2) % 3, 3 + i);
        corner(3 + i, 3 + (i + 2) % 3, 3 + (i + 1) % 3, i);
      }
      break;
    case netgen::HEX:
      for (int i : Range(4)) {
        corner(i, (i + 1) % 4, (i + 3) % 4, 4 + i);
        corner(4 + i, 4 + (i + 3) % 4, 4 + (i + 1) % 4, i);
      }
      break;
    default:
      throw Exception("SplitSlaveFaces: an element with " + ToString(int(el.GetNV())) +
                      " vertices has a slave face; there must be tetrahedra, "
                      "pyramids, prisms and "
                      "hexahedra only");
    }
    return {sum, least};
  }

  bool AreOriented(const std::vector<Element> & parts, const Element & whole) const {
    double volume = CornerVolumes(whole).first;
    return std::all_of(parts.begin(), parts.end(),
                       [&](auto & part) { return CornerVolumes(part).second / volume > 1e-10; });
  }
};
} // namespace

void SplitFaces(netgen::Mesh & mesh, FlatArray<int> slave, bool hexes) {
  FaceSplitter splitter(mesh);
  for (int i : slave)
    splitter.Mark(SurfaceElementIndex::FromNr0(i));
  if (hexes)
    splitter.ChooseHexPattern();
  splitter.Split();
}
} // namespace ngslac
