// SPDX-License-Identifier: LGPL-2.1-or-later
#include "bodycompliance.hpp"

namespace ngslac {
namespace {
/// Adds the integrals of the shape functions of one face, a row for each component.
template <int D>
void AddIntegrals(const FaceShapes<D> & shapes, const Surface<D> & surface, int face,
                  FlatMatrix<> sums, LocalHeap & lh) {
  const IntegrationRule rule(surface.Type(face), 2 * surface.Degree());
  FlatVector<> functions(shapes.Size(face), lh);
  functions = 0.0;
  for (auto & ip : rule) {
    Vec<D - 1> xi;
    for (int k : Range(D - 1))
      xi(k) = ip(k);
    Vec<D> x;
    Mat<D, D - 1> dx;
    surface.Evaluate(face, xi, x, dx);
    shapes.AddValues(face, xi, ip.Weight() * surface.AreaElement(x, dx), functions, lh);
  }
  auto dofs = shapes.Dofs(face);
  for (int i : Range(functions))
    for (int k : Range(D)) {
      if (shapes.IsPlain(face))
        sums(k, dofs[D * i + k]) += functions(i);
      else
        for (int j : Range(dofs))
          sums(k, dofs[j]) += functions(i) * shapes.Conversion(face)(D * i + k, j);
    }
}

} // namespace

template <int D>
Vector<> DiagonalOfNodes(const FaceShapes<D> & shapes, const Surface<D> & surface,
                         FlatVector<> diagonal) {
  Vector<> means(diagonal);
  for (size_t face : Range(surface.BaseSize()))
    if (auto dofs = shapes.Dofs(face); shapes.IsPlain(face))
      for (size_t i = 0; i < dofs.Size(); i += D) {
        double sum = 0;
        for (int k : Range(D))
          sum += diagonal(dofs[i + k]);
        for (int k : Range(D))
          means(dofs[i + k]) = sum / D;
      }
  return means;
}

namespace {
/// How the body behind a surface gives way, up to a factor that does not depend on the mesh. What
/// is prescribed does not give way.
template <int D>
double BodyCompliance(const ProxyInfo & u, SurfaceShapes<D> side, FlatVector<> diagonal) {
  Matrix<> integrals(D, diagonal.Size());
  integrals = 0.0;
  LocalHeap lh(10 * 1000 * 1000, "ngslac-compliance");
  for (size_t face : Range(side.surface.BaseSize())) {
    HeapReset hr(lh);
    AddIntegrals(side.shapes, side.surface, face, integrals, lh);
  }
  auto free = u.fes->GetFreeDofs();
  auto stiffness = DiagonalOfNodes<D>(side.shapes, side.surface, diagonal);
  double compliance = 0, squares = 0, sum = 0;
  for (size_t i : Range(stiffness)) {
    double square = L2Norm2(integrals.Col(i));
    squares += square, sum += sqrt(square);
    bool moves = !free || free->Test(i / u.fes->GetDimension());
    if (moves && stiffness(i) > 0)
      compliance += square / stiffness(i);
  }
  if (squares == 0)
    return 0;
  // The diagonal grows with the size of elements to the power D - 2.
  double size = pow(squares / sum, 1.0 / (D - 1));
  return compliance / squares * pow(size, D - 2);
}
} // namespace

template <int D>
double MasterShare(const ProxyInfo & u, SurfaceShapes<D> slave, SurfaceShapes<D> master,
                   FlatVector<> diagonal) {
  double of_slave = BodyCompliance(u, slave, diagonal);
  double of_master = BodyCompliance(u, master, diagonal);
  return of_slave + of_master > 0 ? of_slave / (of_slave + of_master) : 0.5;
}

template Vector<> DiagonalOfNodes(const FaceShapes<2> &, const Surface<2> &, FlatVector<>);
template Vector<> DiagonalOfNodes(const FaceShapes<3> &, const Surface<3> &, FlatVector<>);
template double MasterShare(const ProxyInfo &, SurfaceShapes<2>, SurfaceShapes<2>, FlatVector<>);
template double MasterShare(const ProxyInfo &, SurfaceShapes<3>, SurfaceShapes<3>, FlatVector<>);
} // namespace ngslac
