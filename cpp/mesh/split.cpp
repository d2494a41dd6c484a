#include "split.hpp"
#include "splitters.hpp"

#include <set>

namespace ngslac {
namespace {
void CheckArguments(MeshAccess & ma, const Region & slave, const string & hexes) {
  if (ma.GetDimension() != 2 && ma.GetDimension() != 3)
    throw Exception("SplitSlaveFaces: the mesh must be two- or three-dimensional");
  if (slave.Mesh().get() != &ma)
    throw Exception("SplitSlaveFaces: the slave region belongs to another mesh");
  if (slave.VB() != BND)
    throw Exception("SplitSlaveFaces: the slave region must be one of boundaries");
  if (ma.GetCommunicator().Size() > 1)
    throw Exception("SplitSlaveFaces: split the mesh before it is distributed");
  if (hexes != "pyramids" && hexes != "hexes")
    throw Exception("SplitSlaveFaces: hexes must be 'pyramids' or 'hexes', not '" + hexes + "'");
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

// The boundary elements of the region.
BitArray SlaveElements(const MeshAccess & ma, const Region & slave) {
  BitArray elements(ma.GetNE(BND));
  elements.Clear();
  for (auto i : Range(ma.GetNE(BND)))
    if (slave.Mask().Test(ma.GetElIndex(ElementId(BND, i))))
      elements.SetBit(i);
  if (!elements.NumSet())
    throw Exception(string("SplitSlaveFaces: the slave region has no ") +
                    (ma.GetDimension() == 2 ? "edges" : "faces") + "; the boundaries are " +
                    BoundaryNames(ma));
  return elements;
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

string BoundaryNames(const MeshAccess & ma) {
  std::set<string> names;
  for (auto i : Range(ma.GetNBoundaries()))
    names.insert(string(ma.GetMaterial(BND, i)));
  string all;
  for (auto & name : names)
    all += (all.empty() ? "'" : ", '") + name + "'";
  return all;
}

shared_ptr<MeshAccess> SplitSlaveFaces(shared_ptr<MeshAccess> ma, const Region & slave,
                                       const string & hexes) {
  static Timer timer("ngslac::SplitSlaveFaces");
  RegionTimer reg(timer);

  if (!ma)
    throw Exception("SplitSlaveFaces: no mesh");
  CheckArguments(*ma, slave, hexes);
  auto source = ma->GetNetgenMesh();
  CheckElements(*source);
  auto elements = SlaveElements(*ma, slave);

  auto copy = make_shared<netgen::Mesh>();
  *copy = *source;
  CopyIdentifications(*source, *copy);
  if (ma->GetDimension() == 2)
    SplitEdges(*copy, elements);
  else
    SplitFaces(*copy, elements, hexes == "hexes");
  UpdateMesh(*copy);

  auto result = make_shared<MeshAccess>(copy);
  if (int order = ma->GetCurveOrder(); order > 1)
    result->Curve(order);
  return result;
}
} // namespace ngslac
