// SPDX-License-Identifier: LGPL-2.1-or-later
#include "faceshapes.hpp"
#include "linear/addscaled.hpp"
#include "surface/bernstein.hpp"

namespace ngslac {
namespace {
template <int R>
struct Interpolation {
  Array<Vec<R>> points;
  Matrix<> control;
  Interpolation(ELEMENT_TYPE type, int degree)
      : points(InterpolationPoints<R>(type, degree)), control(ControlFromValues<R>(type, degree)) {}
};

/// The only component that a column of values (D rows per point) has; -1: several.
template <int D>
int OnlyComponent(FlatMatrix<> values, int column) {
  int only = -1;
  for (int i : Range(values.Height()))
    if (values(i, column) != 0) {
      if (only >= 0 && only != i % D)
        return -1;
      only = i % D;
    }
  return only;
}

/// A scalar as a vector whose components move by the same dofs, each of which counts D times.
template <int D>
Matrix<> AsVector(const Matrix<> & scalar) {
  Matrix<> result(D * scalar.Height(), D * scalar.Width());
  result = 0.0;
  for (int i : Range(scalar.Height()))
    for (int j : Range(scalar.Width()))
      for (int k : Range(D))
        result(D * i + k, D * j + k) = scalar(i, j);
  return result;
}

template <int D>
Array<int> Repeated(FlatArray<int> numbers) {
  Array<int> result;
  for (int number : numbers)
    for ([[maybe_unused]] int k : Range(D))
      result.Append(number);
  return result;
}

/// Columns ordered so that number D i + k is component k of scalar function i; empty: impossible.
template <int D>
Array<int> PlainOrder(FlatMatrix<> values) {
  ArrayMem<int, 50> of[D];
  for (int j : Range(values.Width())) {
    int component = OnlyComponent<D>(values, j);
    if (component < 0)
      return Array<int>();
    of[component].Append(j);
  }
  Array<int> order;
  for (int i : Range(of[0]))
    for (int k : Range(D)) {
      if (of[k].Size() != of[0].Size())
        return Array<int>();
      for (int l = 0; l < values.Height(); l += D)
        if (values(l + k, of[k][i]) != values(l, of[0][i]))
          return Array<int>();
      order.Append(of[k][i]);
    }
  return order;
}
} // namespace

template <int D>
FaceShapes<D>::FaceShapes(const ProxyInfo & u, const Surface<D> & surface, int adegree,
                          const BitArray * wanted)
    : degree(adegree), types(surface.Size()), dofs(surface.Size()), functions(surface.Size()),
      conversion(surface.Size()) {
  static Timer timer("ngslac::FaceShapes");
  RegionTimer reg(timer);
  constexpr int R = D - 1;
  Interpolation<R> simplex(D == 2 ? ET_SEGM : ET_TRIG, degree);
  Interpolation<R> square(D == 2 ? ET_SEGM : ET_QUAD, degree);
  int block = u.fes->GetDimension();
  LocalHeap heap(1000 * 1000, "ngslac-faceshapes", true);
  ParallelForRange(surface.Size(), [&](IntRange faces) {
    LocalHeap lh = heap.Split();
    Array<DofId> numbers;
    Array<int> used_numbers, columns;
    for (auto f : faces) {
      types[f] = surface.Type(f);
      if (wanted && !wanted->Test(f))
        continue;
      HeapReset hr(lh);
      ElementId ei(BND, surface.Element(f));
      auto & [points, control] = types[f] == ET_QUAD ? square : simplex;
      auto & fel = u.fes->GetFE(ei, lh);
      auto & trafo = u.fes->GetMeshAccess()->GetTrafo(ei, lh);
      u.fes->GetDofNrs(ei, numbers);
      if (size_t(fel.GetNDof()) != numbers.Size())
        throw Exception("LACContact: a space of type " + u.component->GetClassName() +
                        " has no degrees of freedom of its own on boundaries; give a continuous "
                        "one, such as H1 or VectorH1");
      int dim = u.evaluator->Dim();
      FlatMatrix<double, ColMajor> shape(dim, block * numbers.Size(), lh);
      Matrix<> values(dim * points.Size(), shape.Width()); // large for high orders
      values = 0.0;
      IntRange used = u.evaluator->UsedDofs(fel);
      for (int i : Range(points)) {
        HeapReset hr(lh);
        u.evaluator->CalcMatrix(fel, trafo(ToIntegrationPoint(points[i]), lh), shape, lh);
        values.Rows(dim * i, dim * (i + 1)).Cols(used) = shape.Cols(used);
      }
      used_numbers.SetSize0(), columns.SetSize0();
      for (int j : used)
        if (IsRegularDof(numbers[j / block]) && L2Norm2(values.Col(j)) > 0) {
          columns.Append(j);
          used_numbers.Append(block * numbers[j / block] + j % block);
        }
      Matrix<> wanted_values(values.Height(), columns.Size());
      for (int j : Range(columns))
        wanted_values.Col(j) = values.Col(columns[j]);
      if (dim == D)
        SetFace(f, wanted_values, used_numbers, control);
      else if (columns.Size())
        SetFace(f, AsVector<D>(wanted_values), Repeated<D>(used_numbers), control);
      else // a scalar field may be defined in one body alone
        functions[f].SetSize(control.Height(), 0);
    }
  });
}

template <int D>
void FaceShapes<D>::SetFace(size_t face, FlatMatrix<> values, FlatArray<int> numbers,
                            const Matrix<> & control) {
  int n = control.Height(), m = values.Width();
  if (auto order = PlainOrder<D>(values); order.Size()) {
    dofs[face] = Array<int>(numbers[order]);
    functions[face].SetSize(n, m / D);
    functions[face] = 0.0;
    for (int i : Range(n))
      for (int l : Range(n))
        for (int j : Range(m / D))
          functions[face](i, j) += control(i, l) * values(D * l, order[D * j]);
    return;
  }
  dofs[face] = Array<int>(numbers);
  functions[face].SetSize(n, n);
  functions[face] = 0.0;
  functions[face].Diag() = 1.0;
  conversion[face].SetSize(D * n, m);
  conversion[face] = 0.0;
  for (int i : Range(n))
    for (int l : Range(n))
      conversion[face].Rows(D * i, D * (i + 1)) += control(i, l) * values.Rows(D * l, D * (l + 1));
}

template <int D>
void FaceShapes<D>::Repeat(size_t first) {
  for (size_t f : Range(first)) {
    types.Append(ELEMENT_TYPE(types[f]));
    dofs.Append(Array<int>(dofs[f]));
    functions.Append(Matrix<>(functions[f]));
    conversion.Append(Matrix<>(conversion[f]));
  }
}

template <int D>
Surface<D> FaceShapes<D>::Displaced(const Surface<D> & reference, FlatVector<> x) const {
  Surface<D> result = reference;
  ParallelFor(reference.Size(), [&](size_t f) { AddDisplacement(f, x, result.Control(f)); });
  return result;
}

template <int D>
void FaceShapes<D>::AddDisplacement(size_t face, FlatVector<> x, FlatArray<Vec<D>> control) const {
  auto & numbers = dofs[face];
  auto & e = functions[face];
  if (IsPlain(face)) {
    for (int i : Range(control))
      for (int j : Range(e.Width()))
        for (int k : Range(D))
          control[i](k) += e(i, j) * x(numbers[D * j + k]);
    return;
  }
  for (int i : Range(control))
    for (int j : Range(numbers))
      for (int k : Range(D))
        control[i](k) += conversion[face](D * i + k, j) * x(numbers[j]);
}

template <int D>
typename FaceShapes<D>::Values FaceShapes<D>::Calc(size_t face, Vec<D - 1> xi,
                                                   LocalHeap & lh) const {
  auto & e = functions[face];
  Values result{FlatVector<>(e.Width(), lh), FlatMatrix<>(D - 1, e.Width(), lh)};
  HeapReset hr(lh);
  Values basis{FlatVector<>(e.Height(), lh), FlatMatrix<>(D - 1, e.Height(), lh)};
  CalcBasis(face, xi, basis.value, basis.derivative);
  result.value = Trans(e) * basis.value;
  result.derivative = basis.derivative * e;
  return result;
}

template <int D>
void FaceShapes<D>::CalcBasis(size_t face, Vec<D - 1> xi, FlatVector<> value,
                              FlatMatrix<> derivative) const {
  ArrayMem<double, 72> memory((D - 1) * value.Size());
  FlatMatrixFixWidth<D - 1> by_function(value.Size(), memory.Data());
  CalcBernstein<D - 1>(types[face], degree, xi, value, by_function);
  for (int a : Range(D - 1))
    for (int i : Range(value))
      derivative(a, i) = by_function(i, a);
}

template <int D>
void FaceShapes<D>::CalcBasis(size_t face, Vec<D - 1> xi, FlatVector<> value) const {
  CalcBernstein<D - 1>(types[face], degree, xi, value);
}

template <int D>
void FaceShapes<D>::AddValues(size_t face, Vec<D - 1> xi, double factor, FlatVector<> sum,
                              LocalHeap & lh) const {
  HeapReset hr(lh);
  auto & e = functions[face];
  FlatVector<> basis(e.Height(), lh);
  CalcBernstein<D - 1>(types[face], degree, xi, basis);
  for (int i : Range(e.Height()))
    AddScaled(factor * basis(i), &e(i, 0), sum.Data(), e.Width());
}

template <int D>
void FaceShapes<D>::AddForces(size_t face, FlatMatrixFixWidth<D> forces, Scatter & y,
                              LocalHeap & lh) const {
  FlatVector<> by_dofs(dofs[face].Size(), lh);
  if (IsPlain(face)) {
    FlatMatrixFixWidth<D> by_functions(Size(face), by_dofs.Data());
    by_functions = Trans(functions[face]) * forces;
  } else
    by_dofs = Trans(conversion[face]) * forces.AsVector();
  for (int j : Range(dofs[face]))
    y.Add(dofs[face][j], by_dofs(j));
}

template <int D>
FaceDisplacement<D>::FaceDisplacement(const ProxyInfo & u, const Surface<D> & surface,
                                      const BitArray & wanted, FlatVector<> x)
    : shapes(u, surface, max(1, u.Order(surface)), &wanted), control(surface.Size()) {
  ParallelFor(surface.Size(), [&](size_t f) {
    if (!wanted.Test(f))
      return;
    control[f].SetSize(shapes.Functions(f).Height());
    control[f] = Vec<D>(0.0);
    shapes.AddDisplacement(f, x, control[f]);
  });
}

template <int D>
Vec<D> FaceDisplacement<D>::At(size_t face, Vec<D - 1> xi) const {
  ArrayMem<double, 40> memory(control[face].Size());
  FlatVector<> values(memory.Size(), memory.Data());
  shapes.CalcBasis(face, xi, values);
  Vec<D> sum = 0.0;
  for (int i : Range(values))
    sum += values(i) * control[face][i];
  return sum;
}

template class FaceShapes<2>;
template class FaceShapes<3>;
template class FaceDisplacement<2>;
template class FaceDisplacement<3>;
} // namespace ngslac
