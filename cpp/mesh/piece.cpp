// SPDX-License-Identifier: LGPL-2.1-or-later
#include "piece.hpp"

#include <map>

namespace ngslac {
namespace {
using netgen::Element;
using netgen::Element2d;
using netgen::PointIndex;
using netgen::Segment;
using netgen::SurfaceElementIndex;

// Netgen has no function for the numbers of segments.
Array<int> netgen::ParallelMeshTopology::* NumbersOfSegments();
template <auto member>
struct SegmentNumbers {
  friend Array<int> netgen::ParallelMeshTopology::* NumbersOfSegments() { return member; }
};
template struct SegmentNumbers<&netgen::ParallelMeshTopology::glob_segm>;

constexpr int head = 4, most2 = ELEMENT2D_MAXPOINTS, most3 = ELEMENT_MAXPOINTS;

int Nr0(PointIndex pi) {
  return pi - netgen::IndexBASE<PointIndex>();
}
PointIndex FromNr0(int nr) {
  return netgen::IndexBASE<PointIndex>() + nr;
}

/// Numbers of the points of a process in the whole mesh.
class GlobalPoints {
  const netgen::ParallelMeshTopology & topology;

public:
  explicit GlobalPoints(const netgen::Mesh & mesh) : topology(mesh.GetParallelTopology()) {}
  int operator()(PointIndex pi) const { return topology.GetGlobalPNum(pi) - 1; }
};

template <typename TROW>
void PutHead(TROW && row, int number, int type, int region, int count) {
  row(0) = number, row(1) = type, row(2) = region, row(3) = count;
}

void PutPoints(const netgen::Mesh & mesh, MeshPiece & piece) {
  GlobalPoints global(mesh);
  piece.point_numbers.SetSize(mesh.GetNP(), 1), piece.points.SetSize(mesh.GetNP(), 3);
  for (auto pi : mesh.Points().Range()) {
    piece.point_numbers(Nr0(pi), 0) = global(pi);
    for (int k : Range(3))
      piece.points(Nr0(pi), k) = mesh[pi](k);
  }
}

void PutVolumes(const netgen::Mesh & mesh, MeshPiece & piece) {
  GlobalPoints global(mesh);
  piece.volumes.SetSize(mesh.GetNE(), head + most3);
  piece.volumes = 0;
  for (int i : Range(mesh.GetNE())) {
    auto el = mesh[netgen::ElementIndex::FromNr0(i)];
    auto row = piece.volumes.Row(i);
    PutHead(row, mesh.GetParallelTopology().GetGlobalElNum(i + 1), el.GetType(),
            el.GetIndex().Nr1(), el.GetNP());
    for (int j : Range(el.GetNP()))
      row(head + j) = global(el[j]);
  }
}

void PutSurfaces(const netgen::Mesh & mesh, MeshPiece & piece) {
  GlobalPoints global(mesh);
  piece.surfaces.SetSize(mesh.GetNSE(), head + 2 * most2);
  piece.surface_parameters.SetSize(mesh.GetNSE(), 2 * most2);
  piece.surfaces = 0, piece.surface_parameters = 0.0;
  for (int i : Range(mesh.GetNSE())) {
    auto el = mesh[SurfaceElementIndex::FromNr0(i)];
    auto row = piece.surfaces.Row(i);
    PutHead(row, mesh.GetParallelTopology().GetGlobalSElNum(i + 1), el.GetType(),
            el.GetIndex().Nr1(), el.GetNP());
    for (int j : Range(el.GetNP())) {
      row(head + j) = global(el[j]);
      row(head + most2 + j) = el.GeomInfo()[j].trignum;
      piece.surface_parameters(i, 2 * j) = el.GeomInfo()[j].u;
      piece.surface_parameters(i, 2 * j + 1) = el.GeomInfo()[j].v;
    }
  }
}

void PutSegments(const netgen::Mesh & mesh, MeshPiece & piece) {
  GlobalPoints global(mesh);
  auto & numbers = mesh.GetParallelTopology().*NumbersOfSegments();
  piece.segments.SetSize(mesh.GetNSeg(), head + 3 + 2);
  piece.segment_parameters.SetSize(mesh.GetNSeg(), 6);
  piece.segments = 0;
  for (int i : Range(mesh.GetNSeg())) {
    auto & seg = mesh[netgen::SegmentIndex::FromNr0(i)];
    auto row = piece.segments.Row(i);
    PutHead(row, numbers[i], 0, seg.GetIndex().Nr1(), seg.GetNP());
    for (int j : Range(seg.GetNP()))
      row(head + j) = global(seg[j]);
    for (int j : Range(2)) {
      auto & info = seg.EPGeomInfo(j);
      row(head + 3 + j) = info.gi.trignum;
      piece.segment_parameters(i, 3 * j) = info.gi.u;
      piece.segment_parameters(i, 3 * j + 1) = info.gi.v;
      piece.segment_parameters(i, 3 * j + 2) = info.dist;
    }
  }
}

void AddPoints(const MeshPiece & all, netgen::Mesh & mesh) {
  int count = 0;
  for (int i : Range(all.point_numbers.Height()))
    count = max(count, all.point_numbers(i, 0) + 1);
  Array<netgen::Point<3>> points(count);
  for (int i : Range(all.point_numbers.Height()))
    points[all.point_numbers(i, 0)] =
        netgen::Point<3>(all.points(i, 0), all.points(i, 1), all.points(i, 2));
  for (auto & p : points)
    mesh.AddPoint(p);
}

/// The rows in the order of their numbers, each once.
Array<int> ByNumber(const Matrix<int> & rows) {
  std::map<int, int> found;
  for (int i : Range(rows.Height()))
    found.emplace(rows(i, 0), i);
  Array<int> order;
  for (auto & [number, i] : found)
    order.Append(i);
  return order;
}

void AddVolumes(const MeshPiece & all, netgen::Mesh & mesh) {
  for (int i : ByNumber(all.volumes)) {
    auto row = all.volumes.Row(i);
    Element el{netgen::ELEMENT_TYPE(row(1))};
    el.SetIndex(netgen::VolumeRegionIndex::FromNr1(row(2)));
    for (int j : Range(row(3)))
      el[j] = FromNr0(row(head + j));
    mesh.AddVolumeElement(el);
  }
}

void AddSurfaces(const MeshPiece & all, netgen::Mesh & mesh) {
  for (int i : ByNumber(all.surfaces)) {
    auto row = all.surfaces.Row(i);
    Element2d el{netgen::ELEMENT_TYPE(row(1))};
    el.SetIndex(netgen::FaceRegionIndex::FromNr1(row(2)));
    for (int j : Range(row(3))) {
      el[j] = FromNr0(row(head + j));
      el.GeomInfo()[j].trignum = row(head + most2 + j);
      el.GeomInfo()[j].u = all.surface_parameters(i, 2 * j);
      el.GeomInfo()[j].v = all.surface_parameters(i, 2 * j + 1);
    }
    mesh.AddSurfaceElement(el);
  }
}

void AddSegments(const MeshPiece & all, netgen::Mesh & mesh) {
  for (int i : ByNumber(all.segments)) { // those between parts of the mesh are there twice
    auto row = all.segments.Row(i);
    Segment seg;
    seg.SetIndex(netgen::EdgeRegionIndex::FromNr1(row(2)));
    for (int j : Range(row(3)))
      seg[j] = FromNr0(row(head + j));
    for (int j : Range(2)) {
      auto & info = seg.EPGeomInfo(j);
      info.gi.trignum = row(head + 3 + j);
      info.gi.u = all.segment_parameters(i, 3 * j);
      info.gi.v = all.segment_parameters(i, 3 * j + 1);
      info.dist = all.segment_parameters(i, 3 * j + 2);
    }
    mesh.AddSegment(seg);
  }
}
} // namespace

MeshPiece PieceOf(const MeshAccess & ma) {
  auto & mesh = *ma.GetNetgenMesh();
  MeshPiece piece;
  PutPoints(mesh, piece);
  PutVolumes(mesh, piece);
  PutSurfaces(mesh, piece);
  PutSegments(mesh, piece);
  return piece;
}

shared_ptr<MeshAccess> WholeMesh(const MeshAccess & empty, const MeshPiece & all) {
  auto mesh = make_shared<netgen::Mesh>();
  *mesh = *empty.GetNetgenMesh(); // regions, names, geometry
  AddPoints(all, *mesh);
  AddVolumes(all, *mesh);
  AddSurfaces(all, *mesh);
  AddSegments(all, *mesh);
  mesh->ComputeNVertices();
  mesh->CalcSurfacesOfNode();
  mesh->RebuildSurfaceElementLists();
  mesh->UpdateTopology();
  mesh->SetNextMajorTimeStamp();
  return make_shared<MeshAccess>(mesh);
}
} // namespace ngslac
