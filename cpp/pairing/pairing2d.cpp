// SPDX-License-Identifier: LGPL-2.1-or-later
#include "orientedbox.hpp"
#include "pieces.hpp"

namespace ngslac {
namespace {
constexpr double merge_tolerance = 1e-13; // of reference coordinates

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

// Steepest gap along a slave face between faces that may touch: beyond that there is no limit.
constexpr double steepest = 6;

/// A master face over an interval of the slave face.
struct Overlap {
  double begin, end;
  int master;
};

struct Hit {
  double eta, gap;
};

/// Pairs one slave face after the other; owns the buffers.
class SegmentPairer {
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
  Array<double> limits; // those of the break points where a gap reaches a limit of the search
  Array<pair<int, optional<Hit>>> nearest; // from each break point to the next

public:
  SegmentPairer(const Surface<2> & aslave, const Surface<2> & amaster, const BoxTree<2> & atree,
                const PairingOptions & aoptions, const IntegrationRule & arule)
      : slave(aslave), master(amaster), tree(atree), options(aoptions), rule(arule) {}

  void Do(int aface, Pairing<2> & result) {
    face = aface;
    size = slave.Diameter(face);
    if (!(size > 0))
      throw Exception("LACContact: boundary element " + ToString(slave.Element(face)) +
                      " of the slave surface has length " + ToString(size));
    merge = max(merge_tolerance, slave.Rounding(face) / size);
    // The nearest partner is usually close: widen the search until the face is covered.
    double most = max(options.maxdist, options.Penetration(face));
    for (double reach = size;; reach *= 4) {
      Search(reach);
      if (reach >= most || Covered(reach))
        break;
    }
    LeaveFarParts();
    bool before = breaks.Size() && breaks[0] <= merge; // the neighbouring face goes on
    for (size_t i = 1; i < breaks.Size(); i++) {
      bool added = AddSegment(i, result);
      if (added && !before)
        AddRim(-1, breaks[i - 1], result);
      if (!added && before && i > 1)
        AddRim(1, breaks[i - 1], result);
      if (added && before && i > 1)
        AddKink(result);
      before = added;
    }
    if (before && breaks.Size() > 1 && breaks.Last() < 1 - merge)
      AddRim(1, breaks.Last(), result);
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
    double ahead = min(reach, options.maxdist), behind = min(reach, options.Penetration(face));
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
    limits.SetSize0();
    for (int j : candidates) {
      double a = Project(master.Point(j, 0.0)), b = Project(master.Point(j, 1.0));
      if (a > b)
        Swap(a, b);
      if (b - a > merge)
        AddOverlap(Overlap{a, b, j});
    }
    breaks += limits;
    SortBreaks();
    FindNearest();
  }

  /// Unless it is out of reach; where the gap reaches a limit there are break points, too.
  void AddOverlap(Overlap o) {
    constexpr int samples = 4; // the gap of curved faces need not be monotone
    auto middle = FindHit(o.master, 0.5 * (o.begin + o.end));
    if (!middle)
      return;
    bool within = IsWithin(middle->gap);
    for (double limit : {options.maxdist, -options.Penetration(face)}) {
      auto beyond = [&](double xi) {
        auto hit = FindHit(o.master, xi);
        return hit ? hit->gap - limit : numeric_limits<double>::quiet_NaN();
      };
      if (!(fabs(middle->gap - limit) < steepest * (o.end - o.begin) * size))
        continue;
      double a = o.begin, fa = beyond(a);
      for (int i = 1; i <= samples; i++) {
        double b = o.begin + i * (o.end - o.begin) / samples, fb = beyond(b);
        if (fa * fb < 0) {
          auto f = [&](double xi) { return make_pair(beyond(xi), (fb - fa) / (b - a)); };
          limits.Append(FindRoot(f, a, fa, b, fb));
          within = true;
        }
        a = b, fa = fb;
      }
    }
    if (!within)
      return;
    overlaps.Append(o);
    breaks.Append(o.begin);
    breaks.Append(o.end);
  }

  bool IsWithin(double gap) const {
    return gap <= options.maxdist && gap >= -options.Penetration(face);
  }

  void SortBreaks() {
    QuickSort(breaks);
    size_t kept = 0;
    for (double b : breaks)
      if (kept == 0 || b - breaks[kept - 1] > merge)
        breaks[kept++] = b;
    breaks.SetSize(kept);
  }

  /// Goes along the face with the overlaps that it is in.
  void FindNearest() {
    std::stable_sort(overlaps.begin(), overlaps.end(),
                     [](auto & a, auto & b) { return a.begin < b.begin; });
    nearest.SetSize0();
    Array<Overlap> here;
    size_t next = 0;
    for (size_t i = 1; i < breaks.Size(); i++) {
      double xi = 0.5 * (breaks[i - 1] + breaks[i]);
      for (; next < overlaps.Size() && overlaps[next].begin <= xi; next++)
        here.Append(overlaps[next]);
      here.SetSize(std::remove_if(here.begin(), here.end(), [&](auto & o) { return o.end < xi; }) -
                   here.begin());
      pair<int, optional<Hit>> best(-1, nullopt);
      for (auto & o : here)
        if (auto hit = FindHit(o.master, xi);
            hit && IsWithin(hit->gap) && (!best.second || fabs(hit->gap) < fabs(best.second->gap)))
          best = {o.master, hit};
      nearest.Append(best);
    }
  }

  /// A part of the slave that looks past the end of a master may see another one far behind. It is
  /// not about to touch that one, and in the average it would let the part before the end go
  /// through.
  void LeaveFarParts() {
    auto distance = [&](size_t i, double xi) {
      auto hit = nearest[i].second ? FindHit(nearest[i].first, xi) : nullopt;
      return hit ? fabs(hit->gap) : numeric_limits<double>::quiet_NaN();
    };
    Array<bool> left(nearest.Size());
    left = false;
    for (int step : {1, -1}) {
      bool leave = false;
      size_t n = nearest.Size();
      for (size_t k = 1; k < n; k++) {
        size_t i = step > 0 ? k : n - 1 - k, previous = i - step;
        double at = breaks[step > 0 ? i : i + 1];
        double jump = distance(i, at) - distance(previous, at);
        if (!isfinite(jump) || jump < -size)
          leave = false;
        else if (jump > size)
          leave = true;
        left[i] = left[i] || leave;
      }
    }
    for (size_t i : Range(nearest))
      if (left[i])
        nearest[i] = {-1, nullopt};
  }

  bool Covered(double reach) const {
    if (breaks.Size() < 2 || breaks[0] > 0 || breaks.Last() < 1)
      return false;
    return std::all_of(nearest.begin(), nearest.end(), [&](auto & partner) {
      return partner.second && fabs(partner.second->gap) <= 0.9 * reach;
    });
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

  /// The point of master face j on the normal ray from xi, if it looks back.
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
    if (!options.MayFace(InnerProduct(normal, master.Normal(j, dy))))
      return nullopt;
    return Hit{eta, InnerProduct(normal, y - x)};
  }

  /// The ray from xi to a master face, NaN in the gap where it misses.
  PairPoint<2> Ray(int partner, double xi, double weight) const {
    Vec<2> x;
    Mat<2, 1> dx;
    slave.Evaluate(face, xi, x, dx);
    auto hit = FindHit(partner, xi).value_or(Hit{0, numeric_limits<double>::quiet_NaN()});
    return {xi, hit.eta, weight * slave.AreaElement(x, dx), hit.gap, slave.Normal(face, dx)};
  }

  /// The end of the last segment on one side is one of the master, unless it is one of the search.
  void AddRim(double side, double end, Pairing<2> & result) const {
    if (std::any_of(limits.begin(), limits.end(), [&](double l) { return fabs(l - end) <= merge; }))
      return;
    result.rim.Append(RimPoint<2>{int(result.segments.Size()) - 1,
                                  result.corners[result.corners.Size() - (side > 0 ? 1 : 2)],
                                  Vec<1>(side)});
  }

  /// Between the last two segments, where their masters meet at an angle, or one ends before the
  /// other.
  void AddKink(Pairing<2> & result) const {
    int last = result.segments.Size() - 1;
    int here = result.segments[last - 1].master, beyond = result.segments[last].master;
    size_t corners = result.corners.Size();
    auto &end = result.corners[corners - 3], &begin = result.corners[corners - 2];
    if (here == beyond)
      return;
    double step = begin.gap - end.gap;
    if (fabs(step) <= 1e-6 * size) {
      if (HaveKink(master, here, end.master, beyond, begin.master))
        result.rim.Append(RimPoint<2>{last - 1, end, Vec<1>(1), beyond, begin.master});
    } else if (fabs(end.gap) <= fabs(begin.gap))
      result.rim.Append(RimPoint<2>{last - 1, end, Vec<1>(1), beyond, begin.master, step});
    else
      result.rim.Append(RimPoint<2>{last, begin, Vec<1>(-1), here, end.master, -step});
  }

  /// Up to the i-th break point; false where there is no partner.
  bool AddSegment(size_t i, Pairing<2> & result) const {
    int partner = nearest[i - 1].first;
    double begin = breaks[i - 1], end = breaks[i];
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
    SegmentPairer pairer(slave, master, tree, options, rule);
    for (auto f : faces)
      pairer.Do(f, part);
  });
}

} // namespace ngslac
