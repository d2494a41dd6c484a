// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include "endrows.hpp"
#include "kinematics.hpp"
#include "macrotables.hpp"

namespace ngslac {
/// Cosine of the angle by which a surface turns at an end that is sharp.
constexpr double sharp_cosine = 0.7;
/// How much the gap may change in a macro-element, relative to its size; from twice that on the
/// surfaces part there, whatever lies beyond.
constexpr double parting_slope = 0.05;
/// Shares less than that are rounding errors of ends at the same place.
constexpr double least_share = 1e-3;

/// A side of a face: a corner in 2D, where both points are the same, an edge in 3D.
template <int D>
struct FaceSide {
  std::array<int, 2> vertices; // sorted
  int face;
  Vec<D> from, to;
  bool operator<(const FaceSide & other) const {
    return pair(vertices, face) < pair(other.vertices, other.face);
  }
  Vec<D> Middle() const { return 0.5 * (from + to); }
};

/// Numbers of the corners, in a boundary element of the mesh, between which a side is.
template <int D>
std::array<int, 2> SideCorners(ELEMENT_TYPE type, int side) {
  if (D == 2)
    return {side, side};
  auto & edge = ElementTopology::GetEdges(type)[side];
  return {edge[0], edge[1]};
}

template <int D>
int NSides(ELEMENT_TYPE type) {
  return D == 2 ? 2 : ElementTopology::GetNEdges(type);
}

/// Sorted by their vertices, so that faces with the same side follow each other.
template <int D>
Array<FaceSide<D>> SidesOf(const Surface<D> & surface, const MeshAccess & ma) {
  Array<FaceSide<D>> sides;
  for (size_t f : Range(surface.Size())) {
    auto vertices = ma.GetElement(ElementId(BND, surface.Element(f))).Vertices();
    auto type = surface.Type(f);
    auto corner = [&](int i) {
      const POINT3D & at = ElementTopology::GetVertices(type)[i];
      Vec<D - 1> xi;
      for (int k : Range(D - 1))
        xi(k) = at[k];
      return surface.Point(f, xi);
    };
    for (int i : Range(NSides<D>(type))) {
      auto [from, to] = SideCorners<D>(type, i);
      int a = vertices[from], b = vertices[to];
      sides.Append(FaceSide<D>{{min(a, b), max(a, b)}, int(f), corner(from), corner(to)});
    }
  }
  QuickSort(sides);
  return sides;
}

/// Calls f with the sides at the same place, one range after the other.
template <int D, typename F>
void ForSamePlace(FlatArray<FaceSide<D>> sides, F f) {
  for (size_t i = 0, next = 0; i < sides.Size(); i = next) {
    while (next < sides.Size() && sides[next].vertices == sides[i].vertices)
      next++;
    f(sides.Range(i, next));
  }
}

/// The sides that only one face has.
template <int D>
Array<FaceSide<D>> FreeSides(FlatArray<FaceSide<D>> sides) {
  Array<FaceSide<D>> free;
  ForSamePlace<D>(sides, [&](FlatArray<FaceSide<D>> same) {
    if (same.Size() == 1)
      free.Append(same[0]);
  });
  return free;
}

/// A place where the slave ends, with the direction in which it would go on.
template <int D>
struct SlaveEnd {
  Vec<D> point, outwards, along;

  SlaveEnd(const Surface<D> & slave, const FaceSide<D> & side)
      : point(side.Middle()), along(side.to - side.from) {
    Vec<D> center = 0.0;
    auto corners = Corners<D - 1>(slave.Type(side.face));
    for (auto & xi : corners)
      center += (1.0 / corners.Size()) * slave.Point(side.face, xi);
    if (double length = L2Norm(along); length > 0)
      along *= 1 / length;
    outwards = point - center;
    outwards -= InnerProduct(outwards, along) * along;
    outwards *= 1 / L2Norm(outwards);
  }

  /// How far the master goes on beyond, at most `size`; negative: it ends before.
  double Beyond(FlatArray<FaceSide<D>> master_ends, double size) const {
    double nearest = size;
    for (auto & end : master_ends) {
      double before = InnerProduct(along, end.from - point);
      double behind = InnerProduct(along, end.to - point);
      if (before * behind > 0)
        continue;
      double t = before == behind ? 0 : before / (before - behind);
      double s = InnerProduct(outwards, (1 - t) * end.from + t * end.to - point);
      if (fabs(s) < fabs(nearest))
        nearest = s;
    }
    return nearest;
  }
};

/// At which ends of the slave does its body not go on nearly in the same direction?
template <int D>
BitArray AreSharp(FlatArray<FaceSide<D>> ends, const Surface<D> & slave, const MeshAccess & ma) {
  std::map<std::array<int, 2>, int> number;
  for (int i : Range(ends))
    number[ends[i].vertices] = i;
  BitArray sharp(ends.Size()), own(ma.GetNE(BND));
  sharp.Set(), own.Clear();
  for (size_t f : Range(slave.Size()))
    own.SetBit(slave.Element(f));
  for (size_t element : Range(ma.GetNE(BND))) {
    ElementId id(BND, element);
    auto vertices = ma.GetElement(id).Vertices();
    for (int i = 0; !own.Test(element) && i < NSides<D>(ma.GetElType(id)); i++) {
      auto [from, to] = SideCorners<D>(ma.GetElType(id), i);
      int a = vertices[from], b = vertices[to];
      auto end = number.find({min(a, b), max(a, b)});
      if (end == number.end())
        continue;
      SlaveEnd<D> here(slave, ends[end->second]);
      Vec<D> on = -0.5 * (ma.GetPoint<D>(a) + ma.GetPoint<D>(b));
      for (int v : vertices)
        on += 1.0 / vertices.Size() * ma.GetPoint<D>(v);
      on -= InnerProduct(on, here.along) * here.along;
      if (InnerProduct(on, here.outwards) > sharp_cosine * L2Norm(on))
        sharp.Clear(end->second);
    }
  }
  return sharp;
}

/// 1 where the surfaces keep their distance within each macro-element, 0 where they part.
template <int D>
Array<double> Parallels(const LACSpace & space, const Surface<D> & slave,
                        const Pairing<D> & pairing, const MacroJump<D> & jump) {
  Array<double> least(jump.Size()), most(jump.Size());
  least = numeric_limits<double>::max(), most = numeric_limits<double>::lowest();
  for (size_t s : Range(pairing.Size())) {
    int m = space.MacroOfFace()[slave.Element(pairing.segments[s].slave)];
    for (auto & p : pairing.points.Range(pairing.Points(s)))
      least[m] = min(least[m], p.gap), most[m] = max(most[m], p.gap);
  }
  for (size_t m : Range(least)) {
    double slope = (most[m] - least[m]) / jump.Size(m);
    least[m] = max(0.0, min(1.0, 2 - slope / parting_slope));
  }
  return least;
}

/// The largest part that the neighbours of each macro-element have without a partner.
template <int D>
Array<double> OpenNeighbours(FlatArray<FaceSide<D>> sides, const std::function<int(int)> & macro,
                             FlatArray<double> open) {
  Array<double> largest(open.Size());
  largest = 0.0;
  ForSamePlace<D>(sides, [&](FlatArray<FaceSide<D>> same) {
    for (auto & one : same)
      for (auto & other : same)
        if (int m = macro(one.face), n = macro(other.face); m != n)
          largest[m] = max(largest[m], open[n]);
  });
  return largest;
}

/// How far contact ends inside of each macro-element of the slave, 0 to 1.
///
/// 1 where the master ends inside of it, or at its border with faces of the slave beyond, or where
/// the slave ends on a master that goes on. 0 elsewhere, and where both surfaces end at the same
/// place, or where they part before they end, as round ones do. It changes continuously with the
/// places of the ends: it falls while an end of the master goes on through the neighbour.
template <int D>
Array<double> EndShares(const LACSpace & space, const Surface<D> & slave, const Surface<D> & master,
                        const Pairing<D> & pairing, const MacroJump<D> & jump) {
  auto & ma = *space.GetMeshAccess();
  auto macro = [&](int face) { return space.MacroOfFace()[slave.Element(face)]; };
  auto sides = SidesOf(slave, ma);
  Array<double> open(jump.Size());
  for (size_t m : Range(open))
    open[m] = max(0.0, 1 - jump.area[m] / jump.fullarea[m]);
  auto shares = OpenNeighbours<D>(sides, macro, open);
  for (size_t m : Range(shares))
    shares[m] += open[m];

  auto slave_ends = FreeSides<D>(sides), master_ends = FreeSides<D>(SidesOf(master, ma));
  auto sharp = AreSharp<D>(slave_ends, slave, ma);
  Array<double> beyond(slave_ends.Size());
  ParallelFor(slave_ends.Size(), [&](size_t i) {
    double size = jump.Size(macro(slave_ends[i].face));
    beyond[i] = SlaveEnd<D>(slave, slave_ends[i]).Beyond(master_ends, size) / size;
  });
  for (size_t i : Range(slave_ends))
    if (sharp.Test(i))
      shares[macro(slave_ends[i].face)] += max(0.0, beyond[i]);
  auto parallel = Parallels(space, slave, pairing, jump);
  for (size_t m : Range(shares)) {
    shares[m] = min(1.0, shares[m]) * parallel[m];
    if (jump.area[m] == 0 || shares[m] < least_share)
      shares[m] = 0;
  }
  return shares;
}

/// The macro-elements of small sliding inside of which contact ends.
template <int D>
class MacroEnds {
  Array<EndRows<D>> rows;
  Array<size_t> numbers; // of their macro-elements
  Array<int> place;      // of each macro-element in `rows`, or -1
  Array<double> shares;  // see EndShares

public:
  MacroEnds() = default;
  /// `points`: pairs the slave faces that are set; gaps are counted from the displacements `x`.
  MacroEnds(const LACSpace & space, const ProxyInfo & u, const Paired<D> & surfaces,
            std::function<Pairing<D>(const BitArray &)> points, FlatArray<Vec<D>> direction,
            FlatVector<> x)
      : place(space.NMacros()) {
    auto & slave = *surfaces.slave;
    auto & master = *surfaces.master;
    shares = EndShares(space, slave, master, *surfaces.pairing, *surfaces.jump);
    place = -1;
    for (size_t m : Range(shares))
      if (shares[m] > 0) {
        place[m] = numbers.Size();
        numbers.Append(m);
      }
    if (!numbers.Size())
      return;
    BitArray faces(slave.Size());
    faces.Clear();
    for (size_t f : Range(slave.Size()))
      if (place[space.MacroOfFace()[slave.Element(f)]] >= 0)
        faces.SetBit(f);
    auto pairing = points(faces);
    auto segments = SegmentsOfMacros<D>(space, slave, pairing);
    faces = pairing.UsedFaces(master.Size(), &Segment::master);
    FaceShapes<D> master_shapes(u, master, max(1, u.Order(master)), &faces);
    faces = pairing.UsedFaces(slave.Size(), &Segment::slave);
    FaceShapes<D> slave_shapes(u, slave, max(1, u.Order(slave)), &faces);
    rows.SetSize(numbers.Size());
    ParallelFor(numbers.Size(), [&](size_t i) {
      size_t m = numbers[i];
      rows[i] = EndRows<D>(segments[m], pairing, slave_shapes, master_shapes, slave, direction[m]);
      rows[i].Blend(shares[m], surfaces.jump->area[m]);
      rows[i].CountFrom(x);
    });
  }

  bool Empty() const { return rows.Size() == 0; }
  double ShareOf(size_t m) const { return shares.Size() ? shares[m] : 0; }
  const EndPoints * PointsOf(size_t m) const {
    return place.Size() && place[m] >= 0 ? &rows[place[m]].points : nullptr;
  }
  /// Of each macro-element the dofs that couple by the points.
  Array<FlatArray<int>> Dofs(size_t nmacros) const {
    Array<FlatArray<int>> dofs(nmacros);
    for (size_t i : Range(rows))
      dofs[numbers[i]].Assign(rows[i].dofs);
    return dofs;
  }

  void Look(const MacroLaw<D> & law, FlatArray<Vec<D>> direction, FlatVector<> x) {
    ParallelFor(rows.Size(), [&](size_t i) {
      size_t m = numbers[i];
      rows[i].Look(x, law.Clearance(m), law.GivenPressure(m, direction[m], x));
    });
  }

  /// Adds the virtual work of the pressure.
  void AddForces(size_t m, const MacroLaw<D> & law, Scatter & y) const {
    auto & own = rows[place[m]];
    auto forces = own.Forces(law.Spread(m, own.points));
    for (size_t j : Range(own.dofs))
      y.Add(own.dofs[j], forces(j));
  }

  Vec<D> MomentOf(size_t m, const MacroLaw<D> & law) const {
    auto & own = rows[place[m]];
    return own.MomentOf(law.Spread(m, own.points));
  }

  /// How one of them moves with the dofs; adds the stiffness of its points.
  PlaceRows<D> RowsOf(size_t m, const MacroLaw<D> & law, const MacroJump<D> & jump,
                      const Vec<D> & direction, BlockSum & stiffness) const {
    auto & own = rows[place[m]];
    auto spread = law.Spread(m, own.points);
    PlaceRows<D> result(own.dofs);
    result.force = 0.0;
    for (auto & e : jump.Row(m))
      result.force.Col(own.PositionOf(e.dof)) =
          e.integral - InnerProduct(e.integral, direction) * direction;
    auto pressed = own.Pressed(spread);
    for (size_t i : Range(own.dofs))
      result.force.Col(i) += pressed(i) * direction;
    result.jump = (1 / jump.area[m]) * result.force;
    stiffness.Add(own.dofs, own.dofs, own.Stiffness(spread));
    return result;
  }

  /// The points at the last evaluation, as numbers.
  Array<double> Save() const {
    Array<double> saved;
    for (auto & own : rows) {
      saved.Append(own.points.pressure);
      saved += own.points.gap;
    }
    return saved;
  }

  void Load(FlatArray<double> saved) {
    size_t at = 0;
    for (auto & own : rows) {
      own.points.pressure = saved[at++];
      for (double & gap : own.points.gap)
        gap = saved[at++];
    }
  }
};
} // namespace ngslac
