// SPDX-License-Identifier: LGPL-2.1-or-later
#include "facetmap.hpp"
#include "layers.hpp"
#include "orientedbox.hpp"
#include "pieces.hpp"

namespace ngslac {
namespace {
// Relative to a facet, in the plane: smaller distances are not resolved, nor are those below the
// rounding errors of positions.
constexpr double clip_tolerance = 1e-14;
// Master facets that overlap by more than this are two layers, the nearer one is the partner.
constexpr double layer_tolerance = 1e-9;
// Part of a facet that the slits between curved master faces may leave free.
constexpr double widest_slits = 5e-3;
// Area of a degenerate face, relative to its diameter squared.
constexpr double degenerate = 1e-12;
// How far beyond an edge to look for a neighbour, relative to the facet; where there may be slits
// between divided faces farther than they are wide.
constexpr double rim_distance = 1e-4, rim_distance_divided = 0.02;
// How far a normal ray may miss its master face: facets have straight sides, faces do not.
constexpr double outside_tolerance = 0.2;

/// Pairs one slave face after the other; owns the buffers.
class FacePairer {
  const Surface<3> & slave;
  const Surface<3> & master;
  const Facets & slave_facets;
  const Facets & master_facets;
  const BoxTree<3> & tree;
  const PairingOptions & options;
  const Quadratures & rules;

  Array<int> candidates;
  Layers pieces;
  double penetration; // deepest of this face
  double rounding;    // of its positions
  double stretch;     // of the weights

public:
  FacePairer(const Surface<3> & aslave, const Surface<3> & amaster, const Facets & aslave_facets,
             const Facets & amaster_facets, const BoxTree<3> & atree,
             const PairingOptions & aoptions, const Quadratures & arules)
      : slave(aslave), master(amaster), slave_facets(aslave_facets), master_facets(amaster_facets),
        tree(atree), options(aoptions), rules(arules) {}

  void Do(int face, Pairing<3> & result) {
    penetration = options.Penetration(face);
    rounding = slave.Rounding(face);
    for (auto & facet : slave_facets.Of(face)) {
      FacetMap map(facet);
      if (!(map.Outline().Area() > degenerate * sqr(facet.size)) || !map.Outline().IsConvex())
        throw Exception("LACContact: boundary element " + ToString(slave.Element(face)) +
                        " of the slave surface is degenerate: it has no area or folds over");
      // The nearest partner is usually close: widen the search until the facet is covered.
      double most = max(options.maxdist, penetration);
      for (double reach = facet.size;; reach *= 4) {
        Search(map, reach);
        if (reach >= most || Covered(map, reach))
          break;
      }
      LeaveFarPieces(map);
      stretch = Stretch(map);
      for (auto & piece : pieces)
        if (AddSegment(map, piece, result))
          AddRim(map, piece, result);
    }
  }

private:
  /// A length relative to a facet, at least the rounding error of positions.
  double Length(const FacetMap & map, double relative) const {
    return max(relative * map.GetFacet().size, rounding);
  }

  /// Straight, as pieces are cut out along the normal of the facet. True normals of a curved face
  /// spread, but a box that did so would find, far away, more and more faces that no piece is of.
  OrientedBox<3> SearchBox(const FacetMap & map, double reach) const {
    auto & facet = map.GetFacet();
    double ahead = min(reach, options.maxdist), behind = min(reach, penetration);
    OrientedBox<3> box{map.Origin() + 0.5 * (ahead - behind) * map.Normal(),
                       {map.Tangent(0), map.Tangent(1), map.Normal()},
                       {0, 0, 0.5 * (ahead + behind)}};
    for (int i : Range(facet.n))
      box.Add(facet.x[i]);
    for (double & half : box.half)
      half += 0.05 * facet.size;
    return box;
  }

  void Search(const FacetMap & map, double reach) {
    candidates.SetSize0();
    tree.Visit(SearchBox(map, reach), [&](int j) {
      if (!options.maypair || options.maypair(map.GetFacet().face, j))
        candidates.Append(j);
    });
    QuickSort(candidates);
    pieces.Clear();
    for (int j : candidates)
      for (auto & facet : master_facets.Of(j))
        if (options.MayFace(InnerProduct(facet.normal, map.Normal())))
          AddPieces(map, facet);
    pieces.RemoveHidden(Length(map, layer_tolerance));
  }

  /// A part of the slave that looks past the end of a master may see another one far behind. It is
  /// not about to touch that one, and in the average it would let the part before the end go
  /// through.
  void LeaveFarPieces(const FacetMap & map) {
    double size = map.GetFacet().size, nearest = numeric_limits<double>::infinity();
    Array<double> distance;
    for (auto & piece : pieces) {
      distance.Append(fabs(piece.Gap(piece.polygon.Centroid())));
      nearest = min(nearest, distance.Last());
    }
    auto is_far = [&](size_t i) { return distance[i] > nearest + size; };
    Array<int> reached;
    Array<bool> left(pieces.Size());
    left = false;
    auto leave = [&](size_t i) {
      if (left[i] || !is_far(i))
        return;
      left[i] = true;
      reached.Append(i);
    };
    auto step_to = [&](const Piece & piece, const Piece & next, Vec<2> point) {
      return fabs(next.Gap(point)) - fabs(piece.Gap(point));
    };
    for (size_t i : Range(pieces.Size()))
      if (!is_far(i))
        ForNeighbours(map, pieces[i], [&](size_t next, Vec<2> point) {
          if (step_to(pieces[i], pieces[next], point) > size)
            leave(next);
        });
    for (size_t k = 0; k < reached.Size(); k++)
      ForNeighbours(map, pieces[reached[k]], [&](size_t next, Vec<2> point) {
        if (step_to(pieces[reached[k]], pieces[next], point) > -size)
          leave(next);
      });
    if (reached.Size())
      pieces.Remove(left);
  }

  /// Calls f with the numbers of the pieces beyond the edges of one, and the middles of these.
  template <typename F>
  void ForNeighbours(const FacetMap & map, const Piece & piece, F f) const {
    ForEdges(map, piece, rim_distance, [&](Vec<2> a, Vec<2> b, Vec<2> beyond) {
      if (auto next = pieces.Covering(beyond))
        f(next - pieces.begin(), 0.5 * (a + b));
    });
  }

  /// Calls f with the ends of each edge of a piece, and a point at this distance beyond its middle,
  /// relative to the facet.
  template <typename F>
  static void ForEdges(const FacetMap & map, const Piece & piece, double distance, F f) {
    auto & polygon = piece.polygon;
    for (int i : Range(polygon.Size())) {
      Vec<2> a = polygon[i], b = polygon[(i + 1) % polygon.Size()];
      Vec<2> across(b(1) - a(1), a(0) - b(0));
      if (L2Norm(across) == 0)
        continue;
      across *= distance * map.GetFacet().size / L2Norm(across);
      f(a, b, Vec<2>(0.5 * (a + b) + across));
    }
  }

  /// The common part of the slave facet with a master facet, projected along the slave normal.
  void AddPieces(const FacetMap & map, const Facet & facet) {
    Polygon outline;
    for (int i : Range(facet.n))
      outline.Append(map.Project(facet.x[i]));
    if (outline.Area() < 0)
      outline.Reverse();
    if (outline.IsConvex())
      return AddPiece(map, facet, outline);
    for (int i : {0, 1}) { // strongly warped: cut from the reentrant corner
      Polygon one{outline[i], outline[i + 1], outline[i + 2]};
      Polygon two{outline[i + 2], outline[(i + 3) % 4], outline[i]};
      if (one.Area() > 0 && two.Area() > 0) {
        AddPiece(map, facet, one);
        AddPiece(map, facet, two);
        return;
      }
    }
  }

  void AddPiece(const FacetMap & map, const Facet & facet, const Polygon & outline) {
    double thinnest = Length(map, clip_tolerance);
    auto common = Intersection(outline, map.Outline(), thinnest);
    if (common.Area() <= thinnest * map.GetFacet().size)
      return;
    double slope = InnerProduct(facet.normal, map.Normal());
    Piece piece{common, &facet, InnerProduct(facet.normal, facet.Center() - map.Origin()) / slope};
    for (int k : Range(2))
      piece.tilt(k) = -InnerProduct(facet.normal, map.Tangent(k)) / slope;
    CutOff(piece, 1, options.maxdist);
    CutOff(piece, -1, penetration);
    if (piece.polygon.Size())
      pieces.Append(piece);
  }

  /// Leaves the part of a piece where  sign * gap <= limit.
  void CutOff(Piece & piece, double sign, double limit) const {
    auto & polygon = piece.polygon;
    if (polygon.Size() == 0)
      return;
    int beyond = 0;
    for (int i : Range(polygon.Size()))
      beyond += sign * piece.Gap(polygon[i]) > limit;
    if (beyond == 0)
      return;
    if (beyond < polygon.Size()) {
      Vec<2> downhill = -sign * piece.tilt;
      Vec<2> on = ((limit - sign * piece.gap) / L2Norm2(piece.tilt)) * (sign * piece.tilt);
      double whole = polygon.Area();
      polygon = Clip(polygon, on, on + Vec<2>(downhill(1), -downhill(0)), 0);
      if (polygon.Area() > clip_tolerance * whole)
        return;
    }
    polygon = Polygon();
  }

  /// Neighbouring master faces that are divided differently leave slits between their facets.
  double Stretch(const FacetMap & map) const {
    double area = 0, full = map.Outline().Area();
    bool divided = false;
    for (auto & piece : pieces) {
      area += piece.polygon.Area();
      divided = divided || master_facets.Of(piece.master->face).Size() > 1;
    }
    return divided && area > (1 - widest_slits) * full ? full / area : 1;
  }

  bool Covered(const FacetMap & map, double reach) const {
    double area = 0;
    for (auto & piece : pieces) {
      area += piece.polygon.Area();
      if (fabs(piece.Gap(piece.polygon.Centroid())) > 0.9 * reach)
        return false;
    }
    return area > (1 - 1e-6) * map.Outline().Area();
  }

  /// The normal ray from a point of the slave facet; NaN in the gap where it misses.
  PairPoint<3> Ray(const FacetMap & map, const Piece & piece, Vec<2> point, double weight) const {
    auto [xi, area] = map.Reference(point);
    int face = map.GetFacet().face;
    Vec<3> x;
    Mat<3, 2> dx;
    slave.Evaluate(face, xi, x, dx);
    Vec<3> normal = slave.Normal(face, dx);
    auto [eta, gap] = Shoot(x, normal, *piece.master);
    if (!isfinite(gap)) { // far away the rays spread; the piece was cut along the facet's normal
      normal = map.Normal();
      tie(eta, gap) = Shoot(x, normal, *piece.master);
    }
    return {xi, eta, stretch * weight * area * Measure(dx), gap, normal};
  }

  /// Master coordinates and gap where a ray meets a master face, by Newton's method.
  pair<Vec<2>, double> Shoot(Vec<3> x, Vec<3> normal, const Facet & target) const {
    constexpr double missed = numeric_limits<double>::quiet_NaN();
    Vec<3> t[2], y;
    Tangents(normal, t);
    Mat<3, 2> dy;
    Vec<2> eta = Start(x, t, target);
    double length = 1;
    for (int it = 0; it < 20; it++) {
      master.Evaluate(target.face, eta, y, dy);
      Vec<2> residual(InnerProduct(t[0], y - x), InnerProduct(t[1], y - x));
      Mat<2, 2> derivative;
      for (int i : Range(2))
        for (int k : Range(2))
          derivative(i, k) = InnerProduct(t[i], Vec<3>(dy.Col(k)));
      Vec<2> step = Inv(derivative) * residual;
      length = L2Norm(step);
      if (!isfinite(length))
        return {eta, missed};
      eta -= min(1.0, 1 / length) * step;
      if (length < 1e-9) // the next one would be at rounding errors
        break;
    }
    if (length > 1e-15)
      master.Evaluate(target.face, eta, y, dy);
    double gap = InnerProduct(normal, y - x);
    double off = L2Norm(y - x - gap * normal);
    // Pieces end at the limits of the search: nothing but the bulge of the faces lies beyond.
    bool hit = off <= 1e-9 * (target.size + fabs(gap)) && IsInside(eta, target.face) &&
               gap <= options.maxdist + target.size && gap >= -penetration - target.size &&
               options.MayFace(InnerProduct(normal, master.Normal(target.face, dy)));
    return {eta, hit ? gap : missed};
  }

  /// Where the ray meets the parallelogram with the sides of a facet, kept near the facet.
  static Vec<2> Start(Vec<3> x, const Vec<3> (&t)[2], const Facet & target) {
    Vec<3> sides[2] = {target.x[1] - target.x[0], target.x[target.n - 1] - target.x[0]};
    Mat<2, 2> map;
    for (int i : Range(2))
      for (int k : Range(2))
        map(i, k) = InnerProduct(t[i], sides[k]);
    x -= target.x[0];
    Vec<2> local = Inv(map) * Vec<2>(InnerProduct(t[0], x), InnerProduct(t[1], x));
    for (int k : Range(2))
      local(k) = min(1.0, max(0.0, local(k))); // also NaN
    return target.Reference(local);
  }

  bool IsInside(Vec<2> eta, int face) const {
    double least = min(eta(0), eta(1));
    double most = master.Type(face) == ET_TRIG ? eta(0) + eta(1) : max(eta(0), eta(1));
    return least >= -outside_tolerance && most <= 1 + outside_tolerance;
  }

  /// Does the search end there, and not the master?
  bool IsAtLimit(const FacetMap & map, const Piece & piece, Vec<2> point) const {
    double gap = piece.Gap(point), tolerance = Length(map, 1e-9);
    return fabs(gap - options.maxdist) < tolerance || fabs(gap + penetration) < tolerance;
  }

  /// Edges of the last segment beyond which the slave facet sees no master, or another face of it.
  void AddRim(const FacetMap & map, const Piece & piece, Pairing<3> & result) const {
    static const IntegrationRule rule(ET_SEGM, 3);
    bool divided = master_facets.Of(piece.master->face).Size() > 1;
    double distance = divided ? rim_distance_divided : rim_distance;
    ForEdges(map, piece, distance, [&](Vec<2> a, Vec<2> b, Vec<2> beyond) {
      if (!map.Outline().Contains(beyond) || IsAtLimit(map, piece, 0.5 * (a + b)))
        return;
      auto next = pieces.Covering(beyond);
      if (next && !CountsHere(map, piece, *next, 0.5 * (a + b)))
        return;
      if (!next && stretch != 1) // slits are all that is free
        return;
      Vec<2> from = map.Reference(a).first, to = map.Reference(b).first;
      Vec<2> outwards(to(1) - from(1), from(0) - to(0));
      if (InnerProduct(outwards, map.Reference(beyond).first - 0.5 * (from + to)) < 0)
        outwards *= -1;
      for (auto & ip : rule)
        AddRimPoint(map, piece, a + ip(0) * (b - a), ip.Weight() * outwards, next, result);
    });
  }

  /// Each edge between two pieces counts once: where the nearer one ends, if they are apart.
  static bool CountsHere(const FacetMap & map, const Piece & piece, const Piece & next,
                         Vec<2> point) {
    double step = fabs(next.Gap(point)) - fabs(piece.Gap(point));
    if (fabs(step) > 1e-2 * map.GetFacet().size)
      return step > 0;
    return next.master->face > piece.master->face;
  }

  void AddRimPoint(const FacetMap & map, const Piece & piece, Vec<2> point, Vec<2> outwards,
                   const Piece * next, Pairing<3> & result) const {
    RimPoint<3> rim{int(result.segments.Size()) - 1, Ray(map, piece, point, 0), outwards};
    if (!isfinite(rim.point.gap))
      return;
    if (next) {
      auto other = Ray(map, *next, point, 0);
      if (!isfinite(other.gap))
        return;
      rim.beyond = next->master->face, rim.eta = other.master;
      rim.step = other.gap - rim.point.gap;
      if (fabs(rim.step) <= 1e-2 * map.GetFacet().size) {
        rim.step = 0;
        if (!HaveKink(master, piece.master->face, rim.point.master, rim.beyond, rim.eta))
          return;
      }
    }
    result.rim.Append(rim);
  }

  /// False where all rays miss.
  bool AddSegment(const FacetMap & map, const Piece & piece, Pairing<3> & result) const {
    Segment segment{map.GetFacet().face, piece.master->face, result.points.Size(),
                    result.corners.Size()};
    auto & polygon = piece.polygon;
    auto & rule = rules.For(map.GetFacet(), *piece.master);
    for (int i = 1; i + 1 < polygon.Size(); i++) {
      Vec<2> a = polygon[i] - polygon[0], b = polygon[i + 1] - polygon[0];
      double twice = a(0) * b(1) - a(1) * b(0);
      if (!(twice > 0))
        continue;
      for (auto & ip : rule)
        if (auto ray = Ray(map, piece, polygon[0] + ip(0) * a + ip(1) * b, ip.Weight() * twice);
            isfinite(ray.gap))
          result.points.Append(ray);
    }
    if (segment.first == result.points.Size())
      return false;
    result.segments.Append(segment);
    for (int i : Range(polygon.Size())) {
      auto corner = Ray(map, piece, polygon[i], 0);
      if (!isfinite(corner.gap)) // at the rim of the master a ray may just miss
        corner.gap = piece.Gap(polygon[i]);
      result.corners.Append(corner);
    }
    return true;
  }
};
} // namespace

template <>
Pairing<3> Pair(const Surface<3> & slave, const Surface<3> & master,
                const PairingOptions & options) {
  static Timer timer("ngslac::Pair");
  RegionTimer reg(timer);
  Facets slave_facets(slave), master_facets(master);
  auto tree = FaceTree(master);

  Quadratures rules(options.order);
  return InPieces<3>(slave.Size(), [&](IntRange faces, Pairing<3> & part) {
    FacePairer pairer(slave, master, slave_facets, master_facets, tree, options, rules);
    for (auto f : faces)
      pairer.Do(f, part);
  });
}
} // namespace ngslac
