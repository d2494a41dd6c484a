// SPDX-License-Identifier: LGPL-2.1-or-later
#include "faces.hpp"
#include "areavector.hpp"

namespace ngslac {
namespace {
IntegrationPoint ReferenceCenter(ELEMENT_TYPE type) {
  Vec<3> center = 0.0;
  auto vertices = ElementTopology::GetVertices(type);
  int nv = ElementTopology::GetNVertices(type);
  for (int i : Range(nv))
    for (int k : Range(3))
      center(k) += vertices[i][k] / nv;
  return IntegrationPoint(center(0), center(1), center(2), 0);
}
} // namespace

Faces::Faces(shared_ptr<MeshAccess> mesh, const BitArray & boundaries) : ma(mesh) {
  for (size_t i : Range(ma->GetNE(BND)))
    if (size_t index = ma->GetElIndex(ElementId(BND, i));
        index < boundaries.Size() && boundaries.Test(index))
      elements.Append(i);
}

Array<int> Faces::Behind(size_t face) const {
  Array<int> volumes;
  ma->GetFacetElements(ma->GetElement(Id(face)).Facets()[0], volumes);
  return volumes;
}

template <int D>
Vec<D> Faces::InnerPoint(ElementId element, LocalHeap & lh) const {
  auto & trafo = ma->GetTrafo(element, lh);
  Vec<D> x;
  trafo.CalcPoint(ReferenceCenter(trafo.GetElementType()), x);
  return x;
}

template <int D>
int Faces::Outward(size_t face, LocalHeap & lh) const {
  HeapReset hr(lh);
  auto volumes = Behind(face);
  if (volumes.Size() != 1)
    return 0;
  auto & trafo = ma->GetTrafo(Id(face), lh);
  MappedIntegrationPoint<D - 1, D> middle(ReferenceCenter(trafo.GetElementType()), trafo);
  Vec<D> inwards = InnerPoint<D>(ElementId(VOL, volumes[0]), lh) - middle.GetPoint();
  return InnerProduct(AreaVector(middle.GetJacobian()), inwards) < 0 ? 1 : -1;
}

template int Faces::Outward<2>(size_t, LocalHeap &) const;
template int Faces::Outward<3>(size_t, LocalHeap &) const;
} // namespace ngslac
