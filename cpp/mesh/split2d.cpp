// SPDX-License-Identifier: LGPL-2.1-or-later
#include "split.hpp"

#include <algorithm>
#include <map>

namespace ngslac {
namespace {
using netgen::EdgePointGeomInfo;
using netgen::Element2d;
using netgen::PointIndex;
using netgen::Segment;
using netgen::SegmentIndex;
using netgen::SurfaceElementIndex;

// Netgen keeps the surface parameters with the corners of an element, not with the points.
struct Corner {
  PointIndex pi;
  netgen::PointGeomInfo gi;
};
using CornerList = std::vector<Corner>; // a triangle or a quadrilateral

Corner Between(const Corner & a, const Corner & b, double s, PointIndex pi) {
  Corner c{pi, a.gi};
  c.gi.u += s * (b.gi.u - a.gi.u);
  c.gi.v += s * (b.gi.v - a.gi.v);
  return c;
}

// Splits edges of a two-dimensional mesh in place.
//
// An edge of a triangle gets its mid-point, an edge of a quadrilateral two points at its thirds: no
// quadrilateral can be divided into quadrilaterals when only one of its edges is halved.
class EdgeSplitter {
  netgen::Mesh & mesh;
  shared_ptr<netgen::NetgenGeometry> geometry;

  // the points within every edge to be split, counted from its smaller point number
  using Key = std::array<PointIndex, 2>;
  std::map<Key, std::vector<PointIndex>> edges;

public:
  explicit EdgeSplitter(netgen::Mesh & amesh) : mesh(amesh), geometry(mesh.GetGeometry()) {}

  void Mark(SegmentIndex si) {
    const Segment & seg = mesh[si];
    edges[MakeKey(seg[0], seg[1])] = {PointIndex::INVALID};
  }

  void Split() {
    MarkQuads();
    for (auto si : mesh.LineSegments().Range())
      SplitSegment(si);
    for (auto sei : mesh.SurfaceElements().Range())
      SplitElement(sei);
  }

private:
  static Key MakeKey(PointIndex a, PointIndex b) { return a < b ? Key{a, b} : Key{b, a}; }

  // On an interface a triangle has to follow the quadrilateral on the other side of the edge.
  void MarkQuads() {
    for (auto sei : mesh.SurfaceElements().Range())
      if (const Element2d el(mesh[sei]); el.GetNV() == 4)
        for (int i : Range(4))
          if (auto it = edges.find(MakeKey(el[i], el[(i + 1) % 4])); it != edges.end())
            it->second = {PointIndex::INVALID, PointIndex::INVALID};
  }

  // The point of the geometry at the fraction s of the segment.
  std::pair<netgen::Point<3>, EdgePointGeomInfo> PointOnSegment(const Segment & seg,
                                                                double s) const {
    netgen::Point<3> p1 = mesh[seg[0]], p2 = mesh[seg[1]];
    netgen::Point<3> chord = p1 + s * (p2 - p1);
    EdgePointGeomInfo info = seg.EPGeomInfo(0);
    info.dist += s * (seg.EPGeomInfo(1).dist - info.dist);

    auto between = [&](double t) {
      auto & region = mesh.GetEdgeDescriptor(seg);
      netgen::Point<3> p = p1 + t * (p2 - p1);
      EdgePointGeomInfo gi = seg.EPGeomInfo(0);
      geometry->PointBetweenEdge(p1, p2, t, region.SurfNr(0), region.SurfNr(1), seg.EPGeomInfo(0),
                                 seg.EPGeomInfo(1), p, gi, region.EdgeNr());
      return std::pair(p, gi);
    };
    // Points of a mesh can have been moved since it was generated. Its geometry is then no guide.
    double tol = 1e-4 * netgen::Dist(p1, p2);
    if (!mesh.HasEdgeDescriptor(seg) || !(netgen::Dist(between(0).first, p1) < tol) ||
        !(netgen::Dist(between(1).first, p2) < tol))
      return {chord, info};
    return between(s);
  }

  void SplitSegment(SegmentIndex si) {
    const Segment seg = mesh[si];
    auto it = edges.find(MakeKey(seg[0], seg[1]));
    if (it == edges.end())
      return;
    auto & nodes = it->second;
    int n = nodes.size();

    Segment part = seg;
    for (int j : Range(n + 1)) {
      if (j < n) {
        auto [p, info] = PointOnSegment(seg, (j + 1.0) / (n + 1));
        PointIndex & node = nodes[seg[0] < seg[1] ? j : n - 1 - j];
        if (!node.IsValid())
          node = mesh.AddPoint(p, mesh[seg[0]].GetLayer(), netgen::EDGEPOINT);
        part[1] = node;
        part.EPGeomInfo(1) = info;
      } else {
        part[1] = seg[1];
        part.EPGeomInfo(1) = seg.EPGeomInfo(1);
      }
      if (j == 0)
        mesh[si] = part;
      else
        mesh.AddSegment(part);
      part[0] = part[1];
      part.EPGeomInfo(0) = part.EPGeomInfo(1);
    }
  }

  // Edges to be split, the longest first: this halves an angle between two of them best.
  std::vector<Key> EdgesToSplit(const Element2d & el) const {
    std::vector<Key> cuts;
    int nv = el.GetNV();
    for (int i : Range(nv))
      if (Key cut{el[i], el[(i + 1) % nv]}; edges.count(MakeKey(cut[0], cut[1])))
        cuts.push_back(cut);
    auto length = [&](const Key & k) { return netgen::Dist(mesh[k[0]], mesh[k[1]]); };
    std::stable_sort(cuts.begin(), cuts.end(),
                     [&](auto & a, auto & b) { return length(a) > length(b); });
    return cuts;
  }

  void SplitElement(SurfaceElementIndex sei) {
    const Element2d el(mesh[sei]);
    auto cuts = EdgesToSplit(el);
    if (cuts.empty())
      return;

    CornerList whole;
    for (int i : Range(el.GetNV()))
      whole.push_back({el[i], el.GeomInfo()[i]});
    double orientation = MinCornerArea(whole) > 0 ? 1 : -1;

    std::vector<CornerList> parts{whole};
    for (auto & cut : cuts)
      SplitPart(parts, cut);

    for (size_t i : Range(parts.size())) {
      if (!(orientation * MinCornerArea(parts[i]) > 0))
        throw Exception("SplitSlaveFaces: the boundary is so strongly curved that a split element "
                        "would fold over at " +
                        ToString(mesh[parts[i][0].pi]) + "; use a finer mesh there");
      Element2d part(int(parts[i].size()));
      part.SetIndex(el.GetIndex());
      for (int j : Range(part.GetNV())) {
        part[j] = parts[i][j].pi;
        part.GeomInfo()[j] = parts[i][j].gi;
      }
      if (i == 0)
        mesh[sei] = part;
      else
        mesh.AddSurfaceElement(part);
    }
  }

  // Signed area spanned at the sharpest corner; its sign shows whether the corner is convex.
  double MinCornerArea(const CornerList & poly) const {
    double least = 0;
    int n = poly.size();
    for (int i : Range(n)) {
      auto & p = mesh[poly[i].pi];
      netgen::Vec<3> a = mesh[poly[(i + 1) % n].pi] - p, b = mesh[poly[(i + n - 1) % n].pi] - p;
      double area = a(0) * b(1) - a(1) * b(0);
      least = i ? std::min(least, area) : area;
    }
    return least;
  }

  // Splits the one part that still has the whole edge.
  void SplitPart(std::vector<CornerList> & parts, const Key & cut) {
    for (size_t k : Range(parts.size())) {
      int n = parts[k].size();
      for (int i : Range(n))
        if (parts[k][i].pi == cut[0] && parts[k][(i + 1) % n].pi == cut[1]) {
          CornerList part = parts[k];
          std::rotate(part.begin(), part.begin() + i, part.end());
          auto pieces = n == 3 ? SplitTrig(part) : SplitQuad(part);
          parts[k] = pieces[0];
          parts.insert(parts.end(), pieces.begin() + 1, pieces.end());
          return;
        }
    }
  }

  // The corners on the first edge of a part, its ends included.
  CornerList EdgeCorners(const CornerList & part) const {
    const Corner &a = part[0], &b = part[1];
    auto nodes = edges.at(MakeKey(a.pi, b.pi));
    if (b.pi < a.pi)
      std::reverse(nodes.begin(), nodes.end());
    CornerList line{a};
    for (size_t j : Range(nodes.size()))
      line.push_back(Between(a, b, (j + 1.0) / (nodes.size() + 1), nodes[j]));
    line.push_back(b);
    return line;
  }

  std::vector<CornerList> SplitTrig(const CornerList & trig) const {
    auto line = EdgeCorners(trig);
    std::vector<CornerList> parts;
    for (size_t j : Range(line.size() - 1))
      parts.push_back({line[j], line[j + 1], trig[2]});
    return parts;
  }

  // Four quadrilaterals around two new points at half depth.
  std::vector<CornerList> SplitQuad(const CornerList & quad) {
    auto line = EdgeCorners(quad);
    CornerList inner;
    for (int j : {1, 2}) {
      Corner far = Between(quad[3], quad[2], j / 3.0, PointIndex::INVALID);
      netgen::Point<3> pfar = mesh[quad[3].pi] + j / 3.0 * (mesh[quad[2].pi] - mesh[quad[3].pi]);
      netgen::Point<3> p = netgen::Center(mesh[line[j].pi], pfar);
      auto pi = mesh.AddPoint(p, mesh[quad[0].pi].GetLayer(), netgen::SURFACEPOINT);
      inner.push_back(Between(line[j], far, 0.5, pi));
    }
    return {{line[0], line[1], inner[0], quad[3]},
            {line[1], line[2], inner[1], inner[0]},
            {line[2], line[3], quad[2], inner[1]},
            {inner[0], inner[1], quad[2], quad[3]}};
  }
};
} // namespace

void SplitEdges(netgen::Mesh & mesh, FlatArray<int> slave) {
  EdgeSplitter splitter(mesh);
  for (int i : slave)
    splitter.Mark(SegmentIndex::FromNr0(i));
  splitter.Split();
}
} // namespace ngslac
