// SPDX-License-Identifier: LGPL-2.1-or-later
#include "split.hpp"
#include "faces.hpp"

namespace ngslac {
namespace {
void CheckMesh(const MeshAccess & ma) {
  if (ma.GetDimension() != 2 && ma.GetDimension() != 3)
    throw Exception("SplitSlaveFaces: the mesh must be two- or three-dimensional");
  if (ma.GetCommunicator().Size() > 1)
    throw Exception("SplitSlaveFaces: split the mesh before it is distributed");
}

void CheckElements(const netgen::Mesh & mesh) {
  bool linear = true;
  for (auto el : mesh.SurfaceElements())
    linear = linear && el.GetNP() == el.GetNV();
  for (auto el : mesh.VolumeElements())
    linear = linear && el.GetNP() == el.GetNV();
  if (!linear)
    throw Exception("SplitSlaveFaces: the mesh has elements of second order; "
                    "use linear ones and mesh.Curve(2)");
}

// Netgen's assignment of meshes leaves identified points behind.
void CopyIdentifications(netgen::Mesh & from, netgen::Mesh & to) {
  auto &src = from.GetIdentifications(), &dst = to.GetIdentifications();
  for (int nr : Range(1, src.GetMaxNr() + 1)) {
    Array<netgen::PointIndices<2>> pairs;
    src.GetPairs(nr, pairs);
    for (auto & pair : pairs)
      dst.Add(pair[0], pair[1], nr);
    dst.SetType(nr, src.GetType(nr));
    dst.SetName(nr, src.GetName(nr));
  }
}

void UpdateMesh(netgen::Mesh & mesh) {
  mesh.ComputeNVertices();
  mesh.CalcSurfacesOfNode();
  mesh.RebuildSurfaceElementLists();
  mesh.UpdateTopology();
  mesh.SetNextMajorTimeStamp();
}
} // namespace

shared_ptr<MeshAccess> SplitSlaveFaces(shared_ptr<MeshAccess> ma, const Region & slave,
                                       const string & hexes) {
  static Timer timer("ngslac::SplitSlaveFaces");
  RegionTimer reg(timer);

  CheckMesh(*ma);
  auto source = ma->GetNetgenMesh();
  CheckElements(*source);
  Faces faces(slave);

  auto copy = make_shared<netgen::Mesh>();
  *copy = *source;
  CopyIdentifications(*source, *copy);
  if (ma->GetDimension() == 2)
    SplitEdges(*copy, faces.Elements());
  else
    SplitFaces(*copy, faces.Elements(), hexes == "hexes");
  UpdateMesh(*copy);

  auto result = make_shared<MeshAccess>(copy);
  if (int order = ma->GetCurveOrder(); order > 1)
    result->Curve(order);
  return result;
}
} // namespace ngslac
