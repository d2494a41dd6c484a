#include "faceshapes.hpp"
#include "surface/bernstein.hpp"

namespace ngslac {
template <int D>
FaceShapes<D>::FaceShapes(const ProxyInfo & u, const Surface<D> & reference)
    : dofs(reference.Size()), coefficients(reference.Size()) {
  static Timer timer("ngslac::FaceShapes");
  RegionTimer reg(timer);
  constexpr int R = D - 1;
  struct Interpolation {
    Array<Vec<R>> points;
    Matrix<> control;
    Interpolation(ELEMENT_TYPE type, int degree)
        : points(InterpolationPoints<R>(type, degree)),
          control(ControlFromValues<R>(type, degree)) {}
  };
  int degree = reference.Degree();
  Interpolation simplex(D == 2 ? ET_SEGM : ET_TRIG, degree);
  Interpolation square(D == 2 ? ET_SEGM : ET_QUAD, degree);
  int block = u.fes->GetDimension();
  LocalHeap heap(1000 * 1000, "ngslac-faceshapes", true);
  ParallelForRange(reference.Size(), [&](IntRange faces) {
    LocalHeap lh = heap.Split();
    Array<DofId> numbers;
    for (auto f : faces) {
      HeapReset hr(lh);
      ElementId ei(BND, reference.Element(f));
      auto & [points, control] = reference.Type(f) == ET_QUAD ? square : simplex;
      auto & fel = u.fes->GetFE(ei, lh);
      auto & trafo = u.fes->GetMeshAccess()->GetTrafo(ei, lh);
      u.fes->GetDofNrs(ei, numbers);
      FlatMatrix<double, ColMajor> shape(D, block * numbers.Size(), lh);
      FlatMatrix<> values(D * points.Size(), shape.Width(), lh);
      values = 0.0;
      IntRange used = u.evaluator->UsedDofs(fel);
      for (int i : Range(points)) {
        HeapReset hr(lh);
        u.evaluator->CalcMatrix(fel, trafo(ToIntegrationPoint(points[i]), lh), shape, lh);
        values.Rows(D * i, D * (i + 1)).Cols(used) = shape.Cols(used);
      }
      Array<int> columns;
      for (int j : used)
        if (IsRegularDof(numbers[j / block]) && L2Norm2(values.Col(j)) > 0) {
          columns.Append(j);
          dofs[f].Append(block * numbers[j / block] + j % block);
        }
      auto & result = coefficients[f];
      result.SetSize(values.Height(), columns.Size());
      result = 0.0;
      for (int j : Range(columns))
        for (int i : Range(points))
          for (int l : Range(points))
            for (int k : Range(D))
              result(D * i + k, j) += control(i, l) * values(D * l + k, columns[j]);
    }
  });
}

template <int D>
Surface<D> FaceShapes<D>::Displaced(const Surface<D> & reference, FlatVector<> x) const {
  Surface<D> result = reference;
  ParallelFor(reference.Size(), [&](size_t f) {
    auto control = result.Control(f);
    for (int i : Range(control))
      for (int j : Range(dofs[f]))
        for (int k : Range(D))
          control[i](k) += coefficients[f](D * i + k, j) * x(dofs[f][j]);
  });
  return result;
}

template <int D>
typename FaceShapes<D>::Values FaceShapes<D>::Calc(const Surface<D> & surface, size_t face,
                                                   Vec<D - 1> xi, LocalHeap & lh) const {
  auto & e = coefficients[face];
  Values result(e.Width(), lh);
  HeapReset hr(lh);
  int n = e.Height() / D;
  FlatVector<> basis(n, lh);
  FlatMatrixFixWidth<D - 1> derivative(n, lh);
  CalcBernstein<D - 1>(surface.Type(face), surface.Degree(), xi, basis, derivative);
  result.value = 0.0;
  for (auto & d : result.derivative)
    d = 0.0;
  for (int i : Range(n))
    for (int k : Range(D)) {
      auto row = e.Row(D * i + k);
      result.value.Row(k) += basis(i) * row;
      for (int a : Range(D - 1))
        result.derivative[a].Row(k) += derivative(i, a) * row;
    }
  return result;
}

template class FaceShapes<2>;
template class FaceShapes<3>;
} // namespace ngslac
