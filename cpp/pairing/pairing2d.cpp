#include "orientedbox.hpp"
#include "pieces.hpp"

namespace ngslac {
namespace {
constexpr double merge_tolerance = 1e-13; // of reference coordinates
constexpr double rounding = 1e-14;        // of positions

/// Root of f in [a, b], where it changes sign. `f` returns value and (approximate) derivative.
template <typename F>
double FindRoot(F f, double a, double fa, double b, double fb) {
  double x = a + (b - a) * fa / (fa - fb);
  for (int it = 0; it < 100; it++) {
    auto [value, slope] = f(x);
    if (value == 0)
      return x;
    if ((value > 0) == (fa > 0))
      a = x;
    else
      b = x;
    double next = x - value / slope;
    if (!(next > min(a, b) && next < max(a, b)))
      next = 0.5 * (a + b);
    if (fabs(next - x) < 1e-16 || fabs(b - a) < 1e-16)
      return next;
    x = next;
  }
  return x;
}

/// A master face over an interval of the slave face.
struct Overlap {
  double begin, end;
  int master;
};

struct Hit {
  double eta, gap;
};

/// Pairs one slave face after the other; owns the buffers.
class FacePairer {
  const Surface<2> & slave;
  const Surface<2> & master;
  const BoxTree<2> & tree;
  const PairingOptions & options;
  const IntegrationRule & rule;

  int face;
  double size;
  double merge; // break points of the face nearer than this are one
  Array<int> candidates;
  Array<Overlap> overlaps;
  Array<double> breaks;

public:
  FacePairer(const Surface<2> & aslave, const Surface<2> & amaster, const BoxTree<2> & atree,
             const PairingOptions & aoptions, const IntegrationRule & arule)
      : slave(aslave), master(amaster), tree(atree), options(aoptions), rule(arule) {}

  void Do(int aface, Pairing<2> & result) {
    face = aface;
    size = slave.Diameter(face);
    if (!(size > 0))
      throw Exception("LACContact: boundary element " + ToString(slave.Element(face)) +
                      " of the slave surface has length " + ToString(size));
    double extent = L2Norm(slave.Point(face, 0.5)) + size;
    merge = max(merge_tolerance, rounding * extent / size);
    // The nearest partner is usually close: widen the search until the face is covered.
    double most = max(options.maxdist, options.penetration);
    for (double reach = size;; reach *= 4) {
      Search(reach);
      if (reach >= most || Covered(reach))
        break;
    }
    bool before = breaks.Size() && breaks[0] <= merge; // the neighbouring face goes on
    for (size_t i = 1; i < breaks.Size(); i++) {
      bool added = AddSegment(breaks[i - 1], breaks[i], result);
      if (added && !before)
        AddRim(-1, result);
      if (!added && before && i > 1)
        AddRim(1, result);
      before = added;
    }
    if (before && breaks.Size() > 1 && breaks.Last() < 1 - merge)
      AddRim(1, result);
  }

private:
  OrientedBox<2> SearchBox(double reach) const {
    Vec<2> points[3], normals[3];
    for (int i : Range(3)) {
      Mat<2, 1> dx;
      slave.Evaluate(face, 0.5 * i, points[i], dx);
      normals[i] = slave.Normal(face, dx);
    }
    Vec<2> n = normals[1];
    double ahead = min(reach, options.maxdist), behind = min(reach, options.penetration);
    OrientedBox<2> box{points[1] + 0.5 * (ahead - behind) * n, {n, Vec<2>(-n(1), n(0))}, {0, 0}};
    for (int i : Range(3))
      for (double d : {ahead, -behind})
        box.Add(points[i] + d * normals[i]);
    double margin = (0.05 + slave.Bulge(face)) * size +
                    0.1 * max(ahead, behind) * L2Norm(normals[2] - normals[0]);
    for (double & half : box.half)
      half += margin;
    return box;
  }

  void Search(double reach) {
    candidates.SetSize0();
    tree.Visit(SearchBox(reach), [&](int j) {
      if (!options.maypair || options.maypair(face, j))
        candidates.Append(j);
    });
    QuickSort(candidates);
    overlaps.SetSize0();
    breaks.SetSize0();
    for (int j : candidates) {
      double a = Project(master.Point(j, 0.0)), b = Project(master.Point(j, 1.0));
      if (a > b)
        Swap(a, b);
      if (b - a > merge && FindHit(j, 0.5 * (a + b))) {
        overlaps.Append(Overlap{a, b, j});
        breaks.Append(a);
        breaks.Append(b);
      }
    }
    QuickSort(breaks);
    size_t kept = 0;
    for (double b : breaks)
      if (kept == 0 || b - breaks[kept - 1] > merge)
        breaks[kept++] = b;
    breaks.SetSize(kept);
  }

  bool Covered(double reach) const {
    if (breaks.Size() < 2 || breaks[0] > 0 || breaks.Last() < 1)
      return false;
    for (size_t i = 1; i < breaks.Size(); i++) {
      auto hit = Nearest(0.5 * (breaks[i - 1] + breaks[i])).second;
      if (!hit || fabs(hit->gap) > 0.9 * reach)
        return false;
    }
    return true;
  }

  /// Slave coordinate whose normal ray meets the point, cut off at the ends of the face.
  double Project(Vec<2> point) const {
    auto f = [&](double xi) {
      Vec<2> x;
      Mat<2, 1> dx;
      slave.Evaluate(face, xi, x, dx);
      return make_pair(InnerProduct(Vec<2>(dx.Col(0)), point - x), -L2Norm2(dx.Col(0)));
    };
    double f0 = f(0).first, f1 = f(1).first;
    if (f0 <= 0)
      return 0;
    if (f1 >= 0)
      return 1;
    return FindRoot(f, 0, f0, 1, f1);
  }

  /// The point of master face j on the normal ray from xi, if it is within reach and looks back.
  optional<Hit> FindHit(int j, double xi) const {
    Vec<2> x, y;
    Mat<2, 1> dx, dy;
    slave.Evaluate(face, xi, x, dx);
    Vec<2> normal = slave.Normal(face, dx);
    Vec<2> tangent = (1 / L2Norm(dx.Col(0))) * Vec<2>(dx.Col(0));
    auto f = [&](double eta) {
      master.Evaluate(j, eta, y, dy);
      return make_pair(InnerProduct(tangent, y - x), InnerProduct(tangent, Vec<2>(dy.Col(0))));
    };
    double f0 = f(0).first, f1 = f(1).first;
    double eta = (f0 > 0) == (f1 > 0) ? (fabs(f0) < fabs(f1) ? 0 : 1) : FindRoot(f, 0, f0, 1, f1);
    // At the end of an overlap rounding may push the ray just past the last vertex.
    if (fabs(f(eta).first) > 1e-9 * (size + fabs(InnerProduct(normal, y - x))))
      return nullopt;
    double gap = InnerProduct(normal, y - x);
    if (gap > options.maxdist || gap < -options.penetration ||
        InnerProduct(normal, master.Normal(j, dy)) > facing_cosine)
      return nullopt;
    return Hit{eta, gap};
  }

  pair<int, optional<Hit>> Nearest(double xi) const {
    pair<int, optional<Hit>> best(-1, nullopt);
    for (auto & o : overlaps)
      if (o.begin <= xi && xi <= o.end)
        if (auto hit = FindHit(o.master, xi);
            hit && (!best.second || fabs(hit->gap) < fabs(best.second->gap)))
          best = {o.master, hit};
    return best;
  }

  /// The ray from xi to a master face, NaN in the gap where it misses.
  PairPoint<2> Ray(int partner, double xi, double weight) const {
    Vec<2> x;
    Mat<2, 1> dx;
    slave.Evaluate(face, xi, x, dx);
    auto hit = FindHit(partner, xi).value_or(Hit{0, numeric_limits<double>::quiet_NaN()});
    return {xi, hit.eta, weight * L2Norm(dx), hit.gap, slave.Normal(face, dx)};
  }

  /// The end of the last segment on one side is one of the master.
  static void AddRim(double side, Pairing<2> & result) {
    result.rim.Append(RimPoint<2>{int(result.segments.Size()) - 1,
                                  result.corners[result.corners.Size() - (side > 0 ? 1 : 2)],
                                  Vec<1>(side)});
  }

  /// False where there is no partner.
  bool AddSegment(double begin, double end, Pairing<2> & result) const {
    int partner = Nearest(0.5 * (begin + end)).first;
    if (partner < 0)
      return false;
    Segment segment{face, partner, result.points.Size(), result.corners.Size()};
    for (auto & ip : rule) {
      auto ray = Ray(partner, begin + (end - begin) * ip(0), ip.Weight() * (end - begin));
      if (isfinite(ray.gap))
        result.points.Append(ray);
    }
    if (segment.first == result.points.Size())
      return false;
    result.segments.Append(segment);
    for (auto [xi, inner] : {pair(begin, segment.first), pair(end, result.points.Size() - 1)}) {
      auto corner = Ray(partner, xi, 0);
      result.corners.Append(isfinite(corner.gap) ? corner : result.points[inner]);
    }
    return true;
  }
};

} // namespace

template <>
Pairing<2> Pair(const Surface<2> & slave, const Surface<2> & master,
                const PairingOptions & options) {
  static Timer timer("ngslac::Pair");
  RegionTimer reg(timer);
  auto tree = FaceTree(master);

  IntegrationRule rule(ET_SEGM, options.order);
  return InPieces<2>(slave.Size(), [&](IntRange faces, Pairing<2> & part) {
    FacePairer pairer(slave, master, tree, options, rule);
    for (auto f : faces)
      pairer.Do(f, part);
  });
}

} // namespace ngslac
