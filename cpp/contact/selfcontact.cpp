// SPDX-License-Identifier: LGPL-2.1-or-later
#include "selfcontact.hpp"

namespace ngslac {
namespace {
// Nearer than this, relative to the slave face, two sides are about to touch.
constexpr double reach = 2;
} // namespace

bool Overlap(const Region & slave, const Region & master) {
  for (size_t i : Range(slave.Mask().Size()))
    if (slave.Mask().Test(i) && master.Mask().Test(i))
      return true;
  return false;
}

template <int D>
std::function<bool(int, int)> NotNeighbours(const Surface<D> & slave, const Surface<D> & master,
                                            const MeshAccess & ma) {
  return [&](int s, int m) {
    auto theirs = ma.GetElement(ElementId(BND, master.Element(m))).Vertices();
    for (int v : ma.GetElement(ElementId(BND, slave.Element(s))).Vertices())
      if (theirs.Contains(v))
        return false;
    return true;
  };
}

template <int D>
Array<double> Thicknesses(const Surface<D> & surface, const MeshAccess & ma) {
  Array<double> thickness(surface.Size());
  ParallelFor(surface.Size(), [&](size_t f) {
    auto face = ma.GetElement(ElementId(BND, surface.Element(f)));
    auto v = face.Vertices();
    auto point = [&](int i) { return ma.GetPoint<D>(v[i]); };
    Mat<D, D - 1> sides;
    for (int k : Range(D - 1))
      sides.Col(k) = point(k + 1) - point(0);
    Vec<D> normal = surface.Normal(f, sides);
    thickness[f] = 0;
    for (int other : ma.GetElement(ElementId(VOL, surface.MeshFaces().Behind(f)[0])).Vertices())
      thickness[f] =
          max(thickness[f], fabs(InnerProduct(normal, Vec<D>(ma.GetPoint<D>(other) - point(0)))));
  });
  return thickness;
}

Array<int> AlongSurface(const LACSpace & space) {
  auto & ma = *space.GetMeshAccess();
  TableCreator<int> creator(ma.GetNV());
  TableCreator<int> vertex_creator(space.NMacros());
  for (; !creator.Done(); creator++, vertex_creator++)
    for (size_t i : Range(ma.GetNE(BND)))
      if (int macro = space.MacroOfFace()[i]; macro >= 0)
        for (int v : ma.GetElement(ElementId(BND, i)).Vertices()) {
          creator.Add(v, macro);
          vertex_creator.Add(macro, v);
        }
  auto macros = creator.MoveTable(), vertices = vertex_creator.MoveTable();
  Array<int> order;
  BitArray reached(space.NMacros());
  reached.Clear();
  for (size_t seed : Range(space.NMacros())) {
    if (reached.Test(seed))
      continue;
    reached.SetBit(seed);
    order.Append(seed);
    for (size_t next = order.Size() - 1; next < order.Size(); next++)
      for (int v : vertices[order[next]])
        for (int other : macros[v])
          if (!reached.Test(other)) {
            reached.SetBit(other);
            order.Append(other);
          }
  }
  return order;
}

template <int D>
void KeepOneSide(Pairing<D> & pairing, const Surface<D> & slave, const Surface<D> & master,
                 const LACSpace & space, FlatArray<int> along, const BitArray & closed) {
  auto macro = [&](int element) { return space.MacroOfFace()[element]; };
  Array<Array<int>> facing(space.NMacros());
  for (size_t s : Range(pairing.Size())) {
    auto & segment = pairing.segments[s];
    int own = macro(slave.Element(segment.slave)), other = macro(master.Element(segment.master));
    double nearest = numeric_limits<double>::infinity();
    for (auto & p : pairing.points.Range(pairing.Points(s)))
      nearest = min(nearest, p.gap);
    if (other >= 0 && other != own && nearest < reach * slave.Diameter(segment.slave)) {
      facing[own].Append(other);
      facing[other].Append(own);
    }
  }
  BitArray kept(space.NMacros());
  kept.Clear();
  for (bool first : {true, false})
    for (int m : along)
      if (closed.Test(m) == first &&
          std::none_of(facing[m].begin(), facing[m].end(), [&](int o) { return kept.Test(o); }))
        kept.SetBit(m);

  Pairing<D> result;
  Array<int> number(pairing.Size());
  for (size_t s : Range(pairing.Size())) {
    auto & segment = pairing.segments[s];
    number[s] = -1;
    if (!kept.Test(macro(slave.Element(segment.slave))))
      continue;
    number[s] = result.segments.Size();
    result.segments.Append(
        Segment{segment.slave, segment.master, result.points.Size(), result.corners.Size()});
    result.points += pairing.points.Range(pairing.Points(s));
    result.corners += pairing.corners.Range(pairing.Corners(s));
  }
  result.segments.Append(Segment{-1, -1, result.points.Size(), result.corners.Size()});
  for (auto rim : pairing.rim)
    if (number[rim.segment] >= 0) {
      rim.segment = number[rim.segment];
      result.rim.Append(rim);
    }
  pairing = std::move(result);
}

#define INSTANTIATE(D)                                                                             \
  template Array<double> Thicknesses(const Surface<D> &, const MeshAccess &);                      \
  template std::function<bool(int, int)> NotNeighbours(const Surface<D> &, const Surface<D> &,     \
                                                       const MeshAccess &);                        \
  template void KeepOneSide(Pairing<D> &, const Surface<D> &, const Surface<D> &,                  \
                            const LACSpace &, FlatArray<int>, const BitArray &);
INSTANTIATE(2)
INSTANTIATE(3)
} // namespace ngslac
