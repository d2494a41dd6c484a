// SPDX-License-Identifier: LGPL-2.1-or-later
#include "surface.hpp"
#include "bernstein.hpp"

namespace ngslac {
namespace {
/// The middle of a mesh, or 0 if the mesh is near 0. It is rounded to a multiple of a power of 2,
/// so that differences from it have no errors.
template <int D>
Vec<D> OriginOf(const MeshAccess & ma) {
  netgen::Box<D> box(netgen::Box<D>::EMPTY_BOX);
  for (size_t v : Range(ma.GetNV())) {
    auto x = ma.GetPoint<D>(v);
    netgen::Point<D> p;
    for (int k : Range(D))
      p(k) = x(k);
    box.Add(p);
  }
  double unit = 8 * exp2(ceil(log2(box.Diam())));
  Vec<D> origin;
  for (int k : Range(D))
    origin(k) = unit * round(box.Center()(k) / unit);
  return origin;
}

} // namespace

template <>
FlatArray<Vec<1>> Corners(ELEMENT_TYPE) {
  static Array<Vec<1>> segm{Vec<1>(0.0), Vec<1>(1.0)};
  return segm;
}

template <>
FlatArray<Vec<2>> Corners(ELEMENT_TYPE type) {
  static Array<Vec<2>> trig{Vec<2>(0, 0), Vec<2>(1, 0), Vec<2>(0, 1)};
  static Array<Vec<2>> quad{Vec<2>(0, 0), Vec<2>(1, 0), Vec<2>(1, 1), Vec<2>(0, 1)};
  return type == ET_TRIG ? trig : quad;
}

template <int D>
Surface<D>::Surface(const Region & region, shared_ptr<CoefficientFunction> displacement, int order)
    : faces(region), base(faces.Size()) {
  static Timer timer("ngslac::Surface");
  RegionTimer reg(timer);
  auto ma = region.Mesh();
  origin = OriginOf<D>(*ma);
  degree = max(1, ma->GetCurveOrder());
  if (auto def = ma->GetDeformation())
    degree = max(degree, def->GetFESpace()->GetOrder());
  degree = max(degree, order);
  simplex_sites = ControlSites<D - 1>(D == 2 ? ET_SEGM : ET_TRIG, degree);
  if (D == 3)
    quad_sites = ControlSites<D - 1>(ET_QUAD, degree);

  first.Append(0);
  for (size_t f : Range(Size())) {
    types.Append(ma->GetElType(faces.Id(f)));
    first.Append(first.Last() + NControlPoints(types.Last(), degree));
  }
  control.SetSize(first.Last());
  orientation.SetSize(Size());

  LocalHeap heap(1000 * 1000, "ngslac-surface", true);
  ParallelForRange(Size(), [&](IntRange range) {
    LocalHeap lh = heap.Split();
    for (auto f : range)
      AddFace(f, *ma, displacement.get(), lh);
  });
  CheckFinite();
}

template <int D>
void Surface<D>::AddFace(size_t face, MeshAccess & ma, CoefficientFunction * displacement,
                         LocalHeap & lh) {
  HeapReset hr(lh);
  constexpr int R = D - 1;
  struct Interpolation {
    Array<Vec<R>> points;
    Matrix<> control;
  };
  auto interpolate = [](ELEMENT_TYPE type, int degree) {
    return Interpolation{InterpolationPoints<R>(type, degree), ControlFromValues<R>(type, degree)};
  };
  thread_local int known_degree = -1; // computed once for many faces
  thread_local Interpolation known[2];
  if (known_degree != degree) {
    known[0] = interpolate(D == 2 ? ET_SEGM : ET_TRIG, degree);
    if (D == 3)
      known[1] = interpolate(ET_QUAD, degree);
    known_degree = degree;
  }
  auto & [points, tocontrol] = known[types[face] == ET_QUAD];

  auto & trafo = ma.GetTrafo(faces.Id(face), lh);
  orientation[face] = faces.Outward<D>(face, lh);
  if (orientation[face] == 0)
    throw Exception("boundary '" + faces.Name(face) + "' has " +
                    (faces.Behind(face).Size()
                         ? "material on both sides: contact needs two surfaces that share no nodes "
                           "(mesh the bodies separately, do not glue them)"
                         : "no body behind it: contact acts on bodies (mesh the volume as well)"));

  FlatMatrixFixWidth<D> values(points.Size(), lh);
  for (int i : Range(points)) {
    MappedIntegrationPoint<R, D> mip(ToIntegrationPoint(points[i]), trafo);
    values.Row(i) = mip.GetPoint() - origin;
    if (displacement) {
      Vec<D> u;
      displacement->Evaluate(mip, u);
      values.Row(i) += u;
    }
  }
  for (int i : Range(points)) {
    Vec<D> & c = control[first[face] + i];
    c = Trans(values) * tocontrol.Row(i);
  }
}

template <int D>
void Surface<D>::Repeat(const Vec<D> & shift) {
  faces.Repeat(base);
  for (size_t f : Range(base)) {
    types.Append(ELEMENT_TYPE(types[f]));
    orientation.Append((signed char)(orientation[f]));
    for (size_t i : Range(first[f], first[f + 1]))
      control.Append(Vec<D>(control[i] + shift));
    first.Append(control.Size());
  }
}

template <int D>
void Surface<D>::CheckFinite() const {
  for (size_t f : Range(Size()))
    for (auto & c : Control(f))
      if (!isfinite(L2Norm2(c)))
        throw Exception("boundary '" + faces.Name(f) +
                        "': the configuration to pair in holds NaN or infinite coordinates");
}

template <int D>
double Surface<D>::Diameter(size_t face) const {
  auto corners = Corners<D - 1>(types[face]);
  double diameter = 0;
  for (int i : Range(corners))
    for (int j : Range(i))
      diameter = max(diameter, L2Norm(Point(face, corners[i]) - Point(face, corners[j])));
  return diameter;
}

template <int D>
double Surface<D>::Rounding(size_t face) const {
  constexpr double digits = 32 * std::numeric_limits<double>::epsilon();
  return digits * (L2Norm(origin + Control(face)[0]) + Diameter(face));
}

template <int D>
double Surface<D>::Bulge(size_t face) const {
  if (degree == 1)
    return 0;
  auto corners = Corners<D - 1>(types[face]);
  Vec<D> c[4];
  for (int i : Range(corners))
    c[i] = Point(face, corners[i]);
  auto sites = Sites(face);
  auto points = Control(face);
  double bulge = 0;
  for (int i : Range(sites)) {
    double s = sites[i](0), t = D == 3 ? sites[i](D - 2) : 0;
    Vec<D> straight = (1 - s - t) * c[0] + s * c[1] + t * c[D == 3 ? 2 : 0];
    if (types[face] == ET_QUAD)
      straight = (1 - t) * ((1 - s) * c[0] + s * c[1]) + t * ((1 - s) * c[3] + s * c[2]);
    bulge = max(bulge, L2Norm(points[i] - straight));
  }
  return bulge / Diameter(face);
}

template <int D>
bool Surface<D>::IsFlat(size_t face) const {
  if (Bulge(face) > 1e-14)
    return false;
  auto corners = Corners<D - 1>(types[face]);
  Vec<D> normals[2], x;
  Mat<D, D - 1> dx;
  for (int i : {0, 1}) {
    Evaluate(face, corners[i ? corners.Size() / 2 : 0], x, dx);
    normals[i] = Normal(face, dx);
  }
  return L2Norm(normals[1] - normals[0]) < 1e-13;
}

template <int D>
netgen::Box<D> Surface<D>::Bounds(size_t face) const {
  netgen::Box<D> box(netgen::Box<D>::EMPTY_BOX);
  for (auto & c : Control(face)) {
    netgen::Point<D> p;
    for (int k : Range(D))
      p(k) = c(k);
    box.Add(p);
  }
  return box;
}

template <int D>
void Surface<D>::Evaluate(size_t face, Vec<D - 1> xi, Vec<D> & x, Mat<D, D - 1> & dx) const {
  EvaluateBernstein<D>(types[face], degree, Control(face), xi, x, dx);
}

template <int D>
Mat<D - 1, D - 1> Surface<D>::Hessian(size_t face, Vec<D - 1> xi, Vec<D> direction) const {
  auto points = Control(face);
  ArrayMem<double, 36> memory(points.Size());
  FlatVector<> along(points.Size(), memory.Data());
  for (int i : Range(points))
    along(i) = InnerProduct(direction, points[i]);
  return BernsteinHessian<D - 1>(types[face], degree, along, xi);
}

template <int D>
Vec<D> Surface<D>::Point(size_t face, Vec<D - 1> xi) const {
  Vec<D> x;
  Mat<D, D - 1> dx;
  Evaluate(face, xi, x, dx);
  return x;
}

template <int D>
Vec<D> Surface<D>::Normal(size_t face, const Mat<D, D - 1> & dx) const {
  Vec<D> n = AreaVector(dx);
  return (orientation[face] / L2Norm(n)) * n;
}

template class Surface<2>;
template class Surface<3>;
} // namespace ngslac
