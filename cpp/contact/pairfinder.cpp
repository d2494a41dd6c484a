// SPDX-License-Identifier: LGPL-2.1-or-later
#include "pairfinder.hpp"
#include "pairing/overlap.hpp"
#include "selfcontact.hpp"

namespace ngslac {
namespace {
/// For each boundary element, one vertex that stands for the body that it belongs to.
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

/// How thick the body behind some faces of a master is in the reference configuration, up to the
/// other side; infinite where there is none that is no slave, and for other faces.
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
} // namespace

template <int D>
PairFinder<D>::PairFinder(const ContactSetup & asetup, shared_ptr<LACSpace> aspace,
                          const ProxyInfo & au)
    : setup(asetup), space(aspace), u(au),
      selfcontact(setup.master && Overlap(space->SlaveRegion(), *setup.master)) {}

template <int D>
unique_ptr<Surface<D>>
PairFinder<D>::SurfaceOf(const Region & region,
                         shared_ptr<CoefficientFunction> displacement) const {
  auto surface = make_unique<Surface<D>>(region, nullptr, 1);
  if (displacement || setup.finite)
    surface = make_unique<Surface<D>>(region, displacement, u.Order(*surface));
  if (space->IsAxisymmetric())
    surface->Turn();
  return surface;
}

template <int D>
unique_ptr<Surface<D>> PairFinder<D>::Slave(shared_ptr<CoefficientFunction> displacement) const {
  return SurfaceOf(space->SlaveRegion(), displacement);
}

template <int D>
unique_ptr<Surface<D>> PairFinder<D>::Master(shared_ptr<CoefficientFunction> displacement) const {
  return setup.master ? SurfaceOf(*setup.master, displacement) : nullptr;
}

template <int D>
PairingOptions PairFinder<D>::Options(const Surface<D> & slave, const Surface<D> & master,
                                      int order, SearchMargin margin) const {
  auto options = SearchOptions(slave, master, setup.maxdist, setup.penetration, order);
  options.maxdist += margin.farther, options.penetration += margin.deeper;
  if (selfcontact)
    LimitToOthers(slave, master, options);
  return options;
}

template <int D>
Paired<D> PairFinder<D>::Pair(unique_ptr<Surface<D>> slave, unique_ptr<Surface<D>> master,
                              SearchMargin margin, Meeting meeting) const {
  auto pairing = make_shared<Pairing<D>>();
  if (setup.obstacle) {
    *pairing = PairWithObstacle<D>(*slave, 2 * Degree(*slave, u.Order(*slave)));
  } else {
    int order = Degree(*slave, max(u.Order(*slave), u.Order(*master)));
    auto options = Options(*slave, *master, (D == 2 ? 2 : 1) * order, margin);
    *pairing = ngslac::Pair<D>(*slave, *master, options);
    if (pairing->Size() == 0 && !selfcontact && setup.active) // self-contact may come later
      CheckMeeting(*slave, *master, options, margin, meeting);
  }
  return {std::move(slave), std::move(master), pairing, nullptr, margin};
}

template <int D>
Pairing<D> PairFinder<D>::PairFiner(const Surface<D> & slave, const Surface<D> & master,
                                    SearchMargin margin, const BitArray & faces) const {
  int order = Degree(slave, max(u.Order(slave), u.Order(master)));
  auto options = Options(slave, master, (D == 2 ? 6 : 2) * order, margin);
  options.maypair = [&, others = options.maypair](int face, int master_face) {
    return faces.Test(face) && (!others || others(face, master_face));
  };
  return ngslac::Pair<D>(slave, master, options);
}

template <int D>
void PairFinder<D>::CheckMeeting(const Surface<D> & slave, const Surface<D> & master,
                                 const PairingOptions & options, SearchMargin margin,
                                 Meeting meeting) const {
  BitArray all(slave.Size());
  all.Set();
  double deepest = 0, searched = options.penetration - margin.deeper;
  for (double depth : Excesses(slave, master, options, all))
    deepest = max(deepest, depth - margin.deeper);
  if (deepest > searched)
    throw Exception("LACContact: slave and master never meet: the bodies overlap by up to " +
                    ToString(deepest) + ", deeper than penetration = " + ToString(searched) +
                    "; move them apart, or give penetration = " + ToString(1.1 * deepest) +
                    " to have them pushed apart");
  if (meeting == Meeting::later || AreApart(slave, master))
    return;
  throw Exception("LACContact: slave and master never meet: no slave normal reaches the master "
                  "surface within maxdist = " +
                  ToString(options.maxdist - margin.farther) +
                  "; check the regions, the placement of the bodies and maxdist");
}

template <int D>
bool PairFinder<D>::AreApart(const Surface<D> & slave, const Surface<D> & master) const {
  if (!setup.finite || setup.tied || setup.maxdist == 0)
    return false;
  auto options = SearchOptions(slave, master, 0, setup.penetration, 1);
  return ngslac::Pair<D>(slave, master, options).Size() > 0;
}

template <int D>
Array<double> PairFinder<D>::Excesses(const Surface<D> & slave, const Surface<D> & master,
                                      const PairingOptions & options,
                                      const BitArray & faces) const {
  Array<double> depths(slave.Size()), limits(slave.Size());
  depths = 0.0;
  for (int f : Range(slave.Size()))
    limits[f] = options.Penetration(f);
  auto bodies = selfcontact ? BodiesOfBoundary(*u.fes->GetMeshAccess()) : Array<int>();
  auto maypair = [&](int f, int m) {
    return faces.Test(f) && (!selfcontact || bodies[slave.Element(f)] != bodies[master.Element(m)]);
  };
  auto parts = DeepParts<D>(slave, master, maypair, limits);
  if (parts.Size() == 0)
    return depths;
  size_t base = master.BaseSize(); // an image is as thick as what it is one of
  BitArray met(base);
  met.Clear();
  for (auto & part : parts)
    met.SetBit(part.master % base);
  auto thickness = BodyThicknesses<D>(*setup.master, space->SlaveRegion(), met);
  for (auto & part : parts)
    if (part.depth <= thickness[part.master % base])
      depths[part.slave] = max(depths[part.slave], part.depth);
  return depths;
}

template <int D>
Array<double> PairFinder<D>::Depths(const Surface<D> & slave, const Surface<D> & master) const {
  auto options = Options(slave, master, 1, {});
  Array<double> least(space->NMacros());
  least = numeric_limits<double>::infinity();
  for (size_t f : Range(slave.Size())) {
    double & depth = least[space->MacroOfFace()[slave.Element(f)]];
    depth = min(depth, options.Penetration(f));
  }
  return least;
}

template <int D>
Array<double> PairFinder<D>::Overlaps(const Surface<D> & slave, const Surface<D> * master,
                                      SearchMargin margin, const BitArray & faces) const {
  Array<double> deepest(space->NMacros());
  deepest = 0.0;
  if (!master || faces.NumSet() == 0)
    return deepest;
  auto depths = Excesses(slave, *master, Options(slave, *master, 1, margin), faces);
  for (size_t f : Range(depths))
    if (double & most = deepest[space->MacroOfFace()[slave.Element(f)]]; depths[f] > 0)
      most = max(most, depths[f] - margin.deeper);
  return deepest;
}

template <int D>
void PairFinder<D>::LimitToOthers(const Surface<D> & slave, const Surface<D> & master,
                                  PairingOptions & options) const {
  options.maypair = NotNeighbours<D>(slave, master, *u.fes->GetMeshAccess());
  if (setup.penetration > 0)
    return;
  // A normal that goes into the body must not find its other side.
  options.depths = Thicknesses<D>(slave, *u.fes->GetMeshAccess());
  for (size_t f : Range(slave.Size()))
    options.depths[f] = min(options.penetration, 0.5 * min(slave.Diameter(f), options.depths[f]));
}

template class PairFinder<2>;
template class PairFinder<3>;
} // namespace ngslac
