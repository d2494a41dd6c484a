// SPDX-License-Identifier: LGPL-2.1-or-later
#include "periods.hpp"

namespace ngslac {
namespace {
constexpr double same_translation = 1e-6; // of translations, relative to their length
// Images are searched within this distance of the nearest one: a body that flies away in a trial
// step needs none.
constexpr int farthest_image = 20;

template <int D>
BitArray VerticesOf(const Surface<D> & surface, const MeshAccess & ma) {
  BitArray vertices(ma.GetNV());
  vertices.Clear();
  for (size_t f : Range(surface.BaseSize()))
    for (int v : ma.GetElement(ElementId(BND, surface.Element(f))).Vertices())
      vertices.SetBit(v);
  return vertices;
}

/// Do two vertices move together?
bool AreOne(const FESpace & fes, int v, int w) {
  Array<DofId> one, other;
  fes.GetDofNrs(NodeId(NT_VERTEX, v), one);
  fes.GetDofNrs(NodeId(NT_VERTEX, w), other);
  return one.Size() && one == other;
}

/// The translations on a surface; identifications that are none throw, or are left out.
template <int D>
Array<Vec<D>> TranslationsOn(const ProxyInfo & u, const Surface<D> & surface, bool strict) {
  auto & ma = *u.fes->GetMeshAccess();
  auto on_surface = VerticesOf(surface, ma);
  Array<Vec<D>> translations;
  for (int id : Range(ma.GetNPeriodicIdentifications())) {
    optional<Vec<D>> all;
    bool differ = false, touches = false;
    for (auto [v, w] : ma.GetPeriodicNodes(NT_VERTEX, id)) {
      if (v == w || !AreOne(*u.component, v, w))
        continue;
      touches = touches || on_surface.Test(v) || on_surface.Test(w);
      Vec<D> way = ma.GetPoint<D>(w) - ma.GetPoint<D>(v);
      differ = differ || (all && !(L2Norm(way - *all) <= same_translation * L2Norm(*all)));
      all = all ? *all : way;
    }
    if (!touches)
      continue;
    if (differ && strict)
      throw Exception("LACContact: the displacement is periodic on boundary '" +
                      surface.MeshFaces().Name(0) +
                      "' by an identification that is no translation, such as a rotation; large "
                      "sliding beyond its seam is not known. Remedy: a whole body in place of a "
                      "sector, or small sliding (finite=False) that stays off the seam");
    if (all && !differ)
      translations.Append(*all);
  }
  return translations;
}

/// Those that do not follow from others.
template <int D>
Array<Vec<D>> Independent(FlatArray<Vec<D>> translations) {
  Array<Vec<D>> basis, across; // across: made orthogonal
  for (auto & way : translations) {
    Vec<D> rest = way;
    for (auto & a : across)
      rest -= InnerProduct(rest, a) / L2Norm2(a) * a;
    if (L2Norm(rest) <= same_translation * L2Norm(way))
      continue;
    basis.Append(way);
    across.Append(rest);
  }
  return basis;
}

template <int D>
netgen::Box<D> BoxOf(const Surface<D> & surface) {
  netgen::Box<D> box(netgen::Box<D>::EMPTY_BOX);
  for (size_t f : Range(surface.BaseSize())) {
    auto bounds = surface.Bounds(f);
    box.Add(bounds.PMin());
    box.Add(bounds.PMax());
  }
  return box;
}

template <int D>
Vec<D> CenterOf(const netgen::Box<D> & box) {
  Vec<D> center;
  for (int k : Range(D))
    center(k) = box.Center()(k);
  return center;
}
} // namespace

template <int D>
Periods<D>::Periods(const ProxyInfo & u, const Surface<D> & slave, const Surface<D> & master,
                    bool strict) {
  auto own = TranslationsOn(u, slave, strict), other = TranslationsOn(u, master, strict);
  periods = Independent<D>(other.Size() ? other : own);
}

template <int D>
bool Periods<D>::Find(const Surface<D> & slave, const Surface<D> & master) {
  if (periods.Size() == 0)
    return false;
  auto near = BoxOf(slave), box = BoxOf(master);
  double longest = 0;
  for (auto & period : periods)
    longest = max(longest, L2Norm(period));
  double radius = 0.5 * (near.Diam() + box.Diam() + longest);
  // How many periods the bodies are apart, and how many of them reach across both.
  int n = periods.Size();
  Matrix<> gram(n, n);
  Vector<> along(n), apart(n);
  for (int i : Range(n)) {
    along(i) = InnerProduct(periods[i], Vec<D>(CenterOf(near) - CenterOf(box)));
    for (int j : Range(n))
      gram(i, j) = InnerProduct(periods[i], periods[j]);
  }
  CalcInverse(gram);
  apart = gram * along;
  size_t before = numbers.Size();
  std::array<int, D> number{}, begin{}, end{};
  for (int i : Range(n)) {
    if (!isfinite(apart(i)) || fabs(apart(i)) > 1e8)
      return false;
    int reach = int(min(double(farthest_image), ceil(radius * sqrt(gram(i, i)))));
    begin[i] = int(round(apart(i))) - reach, end[i] = int(round(apart(i))) + reach;
  }
  near.Increase(0.5 * longest);
  for (number = begin;;) {
    Vec<D> shift = 0.0;
    for (int i : Range(n))
      shift += double(number[i]) * periods[i];
    netgen::Vec<D> by;
    for (int k : Range(D))
      by(k) = shift(k);
    netgen::Box<D> moved(box.PMin() + by, box.PMax() + by);
    if (L2Norm2(shift) > 0 && near.Intersect(moved) && !numbers.Contains(number)) {
      numbers.Append(number);
      shifts.Append(shift);
    }
    int i = 0;
    while (i < n && ++number[i] > end[i])
      number[i] = begin[i], i++;
    if (i == n)
      break;
  }
  return numbers.Size() > before;
}

template <int D>
void Periods<D>::Complete(Surface<D> & master, FaceShapes<D> * shapes) const {
  for (size_t i = master.Size() / max(size_t(1), master.BaseSize()) - 1; i < shifts.Size(); i++) {
    master.Repeat(shifts[i]);
    if (shapes)
      shapes->Repeat(master.BaseSize());
  }
}

template class Periods<2>;
template class Periods<3>;
} // namespace ngslac
