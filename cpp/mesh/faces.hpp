// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <comp.hpp>

namespace ngslac {
using namespace ngcomp;

/// The faces of some boundaries of a mesh, in its order: one side of a contact.
class Faces {
  shared_ptr<MeshAccess> ma;
  Array<int> elements;

public:
  /// `boundaries`: a bit for each, as the mask of a Region; those that are made later do not count
  Faces(shared_ptr<MeshAccess> mesh, const BitArray & boundaries);
  explicit Faces(const Region & region) : Faces(region.Mesh(), region.Mask()) {}

  size_t Size() const { return elements.Size(); }
  /// Appends the first faces once more.
  void Repeat(size_t first) {
    for (size_t f : Range(first))
      elements.Append(int(elements[f]));
  }
  /// Numbers of the boundary elements of the mesh.
  FlatArray<int> Elements() const { return elements; }
  int operator[](size_t face) const { return elements[face]; }
  auto begin() const { return elements.begin(); }
  auto end() const { return elements.end(); }

  ElementId Id(size_t face) const { return {BND, size_t(elements[face])}; }
  /// Name of the boundary that a face belongs to.
  string Name(size_t face) const { return string(ma->GetMaterial(Id(face))); }
  /// Volume elements with this face.
  Array<int> Behind(size_t face) const;
  /// +1 where the area vector of a boundary element points out of the body, -1 where it points into
  /// it: meshes may have the corners of their boundary elements in any order. 0 where there is not
  /// exactly one volume element behind the face.
  template <int D>
  int Outward(size_t face, LocalHeap & lh) const;

private:
  template <int D>
  Vec<D> InnerPoint(ElementId element, LocalHeap & lh) const;
};
} // namespace ngslac
