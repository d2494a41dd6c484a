// SPDX-License-Identifier: LGPL-2.1-or-later
#include "thickness.hpp"
#include "pairing/overlap.hpp"

namespace ngslac {
Array<int> BodiesOfBoundary(const MeshAccess & ma) {
  Array<int> parent(ma.GetNV());
  for (int v : Range(parent))
    parent[v] = v;
  auto root = [&](int v) {
    while (parent[v] != v)
      v = parent[v] = parent[parent[v]];
    return v;
  };
  for (size_t i : Range(ma.GetNE(VOL))) {
    auto vertices = ma.GetElement(ElementId(VOL, i)).Vertices();
    for (int v : vertices)
      parent[root(v)] = root(vertices[0]);
  }
  Array<int> bodies(ma.GetNE(BND));
  for (size_t i : Range(bodies))
    bodies[i] = root(ma.GetElement(ElementId(BND, i)).Vertices()[0]);
  return bodies;
}

namespace {
/// Boundaries all of whose faces have a body on one side only.
Region Outside(shared_ptr<MeshAccess> ma) {
  BitArray mask(ma->GetNRegions(BND));
  mask.Set();
  Faces faces(ma, mask);
  for (size_t f : Range(faces.Size()))
    if (faces.Behind(f).Size() != 1)
      mask.Clear(ma->GetElIndex(faces.Id(f)));
  return Region(ma, BND, mask);
}
} // namespace

template <int D>
Array<double> BodyThicknesses(const Region & master, const Region & slave, const BitArray & faces) {
  auto ma = master.Mesh();
  Surface<D> surface(master, nullptr, 1), others(Outside(ma), nullptr, 1);
  auto bodies = BodiesOfBoundary(*ma);
  return ThicknessesBehind<D>(surface, others, [&](int face, int other) {
    int there = others.Element(other);
    return faces.Test(face) && !slave.Mask().Test(ma->GetElIndex(ElementId(BND, there))) &&
           bodies[surface.Element(face)] == bodies[there];
  });
}

template Array<double> BodyThicknesses<2>(const Region &, const Region &, const BitArray &);
template Array<double> BodyThicknesses<3>(const Region &, const Region &, const BitArray &);
} // namespace ngslac
