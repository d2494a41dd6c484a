#include "surface.hpp"

namespace ngslac {
namespace {
/// Bernstein coefficients from values at the interpolation points.
Matrix<> BernsteinFromValues(FlatArray<double> points) {
  int n = points.Size() - 1;
  Matrix<> basis(n + 1, n + 1);
  for (int i : Range(n + 1))
    for (int j : Range(n + 1)) {
      double value = 1;
      for (int k : Range(j))
        value *= points[i] * (n - k) / (k + 1.0);
      for (int k = j; k < n; k++)
        value *= 1 - points[i];
      basis(i, j) = value;
    }
  CalcInverse(basis);
  return basis;
}

Array<double> LobattoPoints(int degree) {
  Array<double> points(degree + 1);
  for (int i : Range(degree + 1))
    points[i] = 0.5 - 0.5 * cos(M_PI * i / degree);
  points[0] = 0, points[degree] = 1;
  return points;
}

/// A point inside of the only volume element of a boundary face.
template <int D>
Vec<D> InnerPoint(MeshAccess & ma, ElementId face, LocalHeap & lh) {
  Array<int> volumes;
  ma.GetFacetElements(ma.GetElement(face).Facets()[0], volumes);
  if (volumes.Size() != 1)
    throw Exception("boundary '" + string(ma.GetMaterial(face)) + "' has material on " +
                    (volumes.Size() ? "both sides" : "no side") +
                    ": contact needs two surfaces that share no nodes (mesh the bodies "
                    "separately, do not glue them)");
  auto & trafo = ma.GetTrafo(ElementId(VOL, volumes[0]), lh);
  auto type = trafo.GetElementType();
  Vec<3> center = 0.0;
  auto vertices = ElementTopology::GetVertices(type);
  int nv = ElementTopology::GetNVertices(type);
  for (int i : Range(nv))
    for (int k : Range(3))
      center(k) += vertices[i][k] / nv;
  Vec<D> x;
  trafo.CalcPoint(IntegrationPoint(center(0), center(1), center(2), 0), x);
  return x;
}

Vec<2> Rotated(Vec<2> t) {
  return Vec<2>(t(1), -t(0));
}
} // namespace

template <>
Surface<2>::Surface(const Region & region, shared_ptr<CoefficientFunction> displacement,
                    int order) {
  static Timer timer("ngslac::Surface");
  RegionTimer reg(timer);
  auto ma = region.Mesh();
  for (size_t i : Range(ma->GetNE(BND)))
    if (region.Mask().Test(ma->GetElIndex(ElementId(BND, i))))
      elements.Append(i);

  degree = max(1, ma->GetCurveOrder());
  if (auto def = ma->GetDeformation())
    degree = max(degree, def->GetFESpace()->GetOrder());
  if (displacement)
    degree = max(degree, order);
  auto points = LobattoPoints(degree);
  auto interpolate = BernsteinFromValues(points);
  control.SetSize(elements.Size() * (degree + 1));
  orientation.SetSize(elements.Size());

  LocalHeap heap(1000 * 1000, "ngslac-surface", true);
  ParallelForRange(elements.Size(), [&](IntRange range) {
    LocalHeap lh = heap.Split();
    for (auto f : range) {
      HeapReset hr(lh);
      ElementId ei(BND, elements[f]);
      auto & trafo = ma->GetTrafo(ei, lh);
      FlatMatrixFixWidth<2> values(degree + 1, lh);
      for (int i : Range(degree + 1)) {
        MappedIntegrationPoint<1, 2> mip(IntegrationPoint(points[i], 0, 0, 0), trafo);
        values.Row(i) = mip.GetPoint();
        if (i == 0)
          orientation[f] = InnerProduct(Rotated(Vec<2>(mip.GetJacobian().Col(0))),
                                        InnerPoint<2>(*ma, ei, lh) - mip.GetPoint()) < 0
                               ? 1
                               : -1;
        if (displacement) {
          Vec<2> u;
          displacement->Evaluate(mip, u);
          values.Row(i) += u;
        }
      }
      for (int i : Range(degree + 1)) {
        Vec<2> & c = control[f * (degree + 1) + i];
        c = Trans(values) * interpolate.Row(i);
        if (!isfinite(c(0)) || !isfinite(c(1)))
          throw Exception("boundary '" + string(ma->GetMaterial(ei)) +
                          "': the configuration to pair in holds NaN or infinite coordinates");
      }
    }
  });
}

template <>
double Surface<2>::Diameter(size_t face) const {
  auto c = Control(face);
  return L2Norm(c[degree] - c[0]);
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

template <>
void Surface<2>::Evaluate(size_t face, Vec<1> xi, Vec<2> & x, Mat<2, 1> & dx) const {
  auto c = Control(face);
  ArrayMem<Vec<2>, 12> b(degree + 1);
  b = c;
  double s = xi(0);
  for (int level = degree; level > 1; level--)
    for (int i : Range(level))
      b[i] = (1 - s) * b[i] + s * b[i + 1];
  x = (1 - s) * b[0] + s * b[1];
  dx.Col(0) = degree * (b[1] - b[0]);
}

template <int D>
Vec<D> Surface<D>::Point(size_t face, Vec<D - 1> xi) const {
  Vec<D> x;
  Mat<D, D - 1> dx;
  Evaluate(face, xi, x, dx);
  return x;
}

template <>
Vec<2> Surface<2>::Normal(size_t face, const Mat<2, 1> & dx) const {
  Vec<2> n = Rotated(Vec<2>(dx.Col(0)));
  return (orientation[face] / L2Norm(n)) * n;
}

template class Surface<2>;
} // namespace ngslac
