// SPDX-License-Identifier: LGPL-2.1-or-later
#include "bernstein.hpp"

namespace ngslac {
int NControlPoints(ELEMENT_TYPE type, int degree) {
  switch (type) {
  case ET_SEGM:
    return degree + 1;
  case ET_TRIG:
    return (degree + 1) * (degree + 2) / 2;
  case ET_QUAD:
    return (degree + 1) * (degree + 1);
  default:
    throw Exception("a boundary face is a segment, a triangle or a quadrilateral");
  }
}

namespace {
/// The points of a face with the positions `line` on each edge.
template <int R>
Array<Vec<R>> PointsFromLine(ELEMENT_TYPE type, FlatArray<double> line) {
  int n = line.Size() - 1;
  Array<Vec<R>> points;
  if constexpr (R == 1)
    for (double s : line)
      points.Append(Vec<1>(s));
  else
    for (int j : Range(n + 1))
      for (int i : Range(type == ET_TRIG ? n + 1 - j : n + 1)) {
        double s = line[i], t = line[j], r = line[max(0, n - i - j)];
        // On a triangle the three barycentric coordinates have to add up to one (Blyth and
        // Pozrikidis 2006).
        points.Append(type == ET_TRIG ? Vec<2>((1 + 2 * s - t - r) / 3, (1 + 2 * t - s - r) / 3)
                                      : Vec<2>(s, t));
      }
  return points;
}
} // namespace

template <int R>
Array<Vec<R>> ControlSites(ELEMENT_TYPE type, int degree) {
  Array<double> line(degree + 1);
  for (int i : Range(degree + 1))
    line[i] = double(i) / degree;
  return PointsFromLine<R>(type, line);
}

template <int R>
Array<Vec<R>> InterpolationPoints(ELEMENT_TYPE type, int degree) {
  Array<double> line(degree + 1);
  for (int i : Range(degree + 1))
    line[i] = 0.5 - 0.5 * cos(M_PI * i / degree);
  line[0] = 0, line[degree] = 1;
  return PointsFromLine<R>(type, line);
}

template <int R>
Matrix<> ControlFromValues(ELEMENT_TYPE type, int degree) {
  constexpr int D = R + 1;
  auto points = InterpolationPoints<R>(type, degree);
  int n = points.Size();
  Matrix<> basis(n, n);
  Array<Vec<D>> unit(n);
  for (int j : Range(n)) {
    unit = Vec<D>(0.0);
    unit[j](0) = 1;
    for (int i : Range(n)) {
      Vec<D> x;
      Mat<D, R> dx;
      EvaluateBernstein<D>(type, degree, unit, points[i], x, dx);
      basis(i, j) = x(0);
    }
  }
  CalcInverse(basis);
  return basis;
}

namespace {
/// Calls f with the degree: the frequent ones as constants, by which loops are unrolled.
template <typename F>
void WithDegree(int degree, F f) {
  switch (degree) {
  case 1:
    return f(std::integral_constant<int, 1>());
  case 2:
    return f(std::integral_constant<int, 2>());
  default:
    f(degree);
  }
}

/// All B^n_i(s) = binomial(n, i) s^i (1 - s)^(n - i), by their recursion.
template <typename INT>
void CalcLine(INT degree, double s, double * b) {
  b[0] = 1;
  for (int n = 1; n <= degree; n++) {
    b[n] = s * b[n - 1];
    for (int i = n - 1; i > 0; i--)
      b[i] = (1 - s) * b[i] + s * b[i - 1];
    b[0] *= 1 - s;
  }
}

/// Derivatives from the polynomials of one degree less.
template <typename INT>
void CalcLineDerivative(INT degree, double s, double * db) {
  ArrayMem<double, 12> lower(degree);
  CalcLine(int(degree) - 1, s, lower.Data());
  for (int i = 0; i <= degree; i++)
    db[i] = degree * ((i > 0 ? lower[i - 1] : 0) - (i < degree ? lower[i] : 0));
}

/// Second derivatives from the polynomials of two degrees less.
void CalcLineSecondDerivative(int degree, double s, FlatVector<> ddb) {
  ddb = 0.0;
  if (degree < 2)
    return;
  ArrayMem<double, 12> lower(degree - 1);
  CalcLine(degree - 2, s, lower.Data());
  for (int i : Range(degree - 1))
    for (auto [k, factor] : {pair(i, 1), pair(i + 1, -2), pair(i + 2, 1)})
      ddb(k) += factor * degree * (degree - 1) * lower[i];
}

int TrigNumber(int degree, int i, int j) {
  return j * (degree + 1) - j * (j - 1) / 2 + i;
}

/// B^n_ij by the recursion over the degree.
void CalcTrig(int degree, Vec<2> xi, FlatVector<> b) {
  double s = xi(0), t = xi(1), r = 1 - s - t;
  if (degree == 2) { // the most frequent one
    b(0) = r * r, b(1) = 2 * r * s, b(2) = s * s;
    b(3) = 2 * r * t, b(4) = 2 * s * t, b(5) = t * t;
    return;
  }
  ArrayMem<double, 36> old(b.Size());
  b(0) = 1;
  for (int n = 1; n <= degree; n++) {
    for (int k : Range(NControlPoints(ET_TRIG, n - 1)))
      old[k] = b(k);
    for (int j : Range(n + 1))
      for (int i : Range(n + 1 - j)) {
        double value = 0;
        if (i > 0)
          value += s * old[TrigNumber(n - 1, i - 1, j)];
        if (j > 0)
          value += t * old[TrigNumber(n - 1, i, j - 1)];
        if (i + j < n)
          value += r * old[TrigNumber(n - 1, i, j)];
        b(TrigNumber(n, i, j)) = value;
      }
  }
}

void CalcTrigDerivative(int degree, Vec<2> xi, FlatMatrixFixWidth<2> db) {
  ArrayMem<double, 36> memory(NControlPoints(ET_TRIG, degree - 1));
  FlatVector<> lower(memory.Size(), memory.Data());
  CalcTrig(degree - 1, xi, lower);
  for (int j : Range(degree + 1))
    for (int i : Range(degree + 1 - j)) {
      double along = i + j < degree ? lower(TrigNumber(degree - 1, i, j)) : 0;
      int k = TrigNumber(degree, i, j);
      db(k, 0) = degree * ((i > 0 ? lower(TrigNumber(degree - 1, i - 1, j)) : 0) - along);
      db(k, 1) = degree * ((j > 0 ? lower(TrigNumber(degree - 1, i, j - 1)) : 0) - along);
    }
}
} // namespace

template <>
void CalcBernstein(ELEMENT_TYPE, int degree, Vec<1> xi, FlatVector<> basis) {
  CalcLine(degree, xi(0), basis.Data());
}

template <>
void CalcBernstein(ELEMENT_TYPE type, int degree, Vec<2> xi, FlatVector<> basis) {
  if (type == ET_TRIG)
    return CalcTrig(degree, xi, basis);
  WithDegree(degree, [&](auto degree) {
    ArrayMem<double, 12> s(degree + 1), t(degree + 1);
    CalcLine(degree, xi(0), s.Data());
    CalcLine(degree, xi(1), t.Data());
    double * b = basis.Data();
    for (int j = 0; j <= degree; j++)
      for (int i = 0; i <= degree; i++)
        *b++ = s[i] * t[j];
  });
}

template <>
void CalcBernstein(ELEMENT_TYPE, int degree, Vec<1> xi, FlatVector<> basis,
                   FlatMatrixFixWidth<1> derivative) {
  CalcLine(degree, xi(0), basis.Data());
  CalcLineDerivative(degree, xi(0), derivative.Data());
}

template <>
void CalcBernstein(ELEMENT_TYPE type, int degree, Vec<2> xi, FlatVector<> basis,
                   FlatMatrixFixWidth<2> derivative) {
  if (type == ET_TRIG) {
    CalcTrig(degree, xi, basis);
    CalcTrigDerivative(degree, xi, derivative);
    return;
  }
  WithDegree(degree, [&](auto degree) {
    ArrayMem<double, 12> s(degree + 1), t(degree + 1), ds(degree + 1), dt(degree + 1);
    CalcLine(degree, xi(0), s.Data());
    CalcLine(degree, xi(1), t.Data());
    CalcLineDerivative(degree, xi(0), ds.Data());
    CalcLineDerivative(degree, xi(1), dt.Data());
    double *b = basis.Data(), *db = derivative.Data();
    for (int j = 0; j <= degree; j++)
      for (int i = 0; i <= degree; i++) {
        *b++ = s[i] * t[j];
        *db++ = ds[i] * t[j];
        *db++ = s[i] * dt[j];
      }
  });
}

template <>
void EvaluateBernstein(ELEMENT_TYPE, int degree, FlatArray<Vec<2>> control, Vec<1> xi, Vec<2> & x,
                       Mat<2, 1> & dx) {
  ArrayMem<Vec<2>, 12> b(degree + 1);
  b = control;
  double s = xi(0);
  for (int level = degree; level > 1; level--)
    for (int i : Range(level))
      b[i] = (1 - s) * b[i] + s * b[i + 1];
  x = (1 - s) * b[0] + s * b[1];
  dx.Col(0) = degree * (b[1] - b[0]);
}

namespace {
void EvaluateTrig(int degree, FlatArray<Vec<3>> control, Vec<2> xi, Vec<3> & x, Mat<3, 2> & dx) {
  double s = xi(0), t = xi(1), r = 1 - s - t;
  ArrayMem<Vec<3>, 36> b(degree > 2 ? control.Size() : 3);
  if (degree > 2)
    b = control;
  else if (degree == 2) { // the most frequent one
    b[0] = r * control[0] + s * control[1] + t * control[3];
    b[1] = r * control[1] + s * control[2] + t * control[4];
    b[2] = r * control[3] + s * control[4] + t * control[5];
  } else
    b = control.Range(0, 3);
  for (int level = degree; level > 1 && degree > 2; level--) {
    int from = 0, to = 0; // rows get shorter: the result never overtakes what it needs
    for (int j : Range(level)) {
      int above = from + level + 1 - j;
      for (int i : Range(level - j))
        b[to++] = s * b[from + i + 1] + t * b[above + i] + r * b[from + i];
      from = above;
    }
  }
  x = r * b[0] + s * b[1] + t * b[2];
  dx.Col(0) = degree * (b[1] - b[0]);
  dx.Col(1) = degree * (b[2] - b[0]);
}

template <typename INT>
void EvaluateQuad(INT degree, const Vec<3> * control, Vec<2> xi, Vec<3> & x, Mat<3, 2> & dx) {
  double s = xi(0), t = xi(1);
  ArrayMem<Vec<3>, 12> row(degree + 1), left(degree + 1), right(degree + 1);
  for (int j = 0; j <= degree; j++) {
    for (int i = 0; i <= degree; i++)
      row[i] = *control++;
    for (int level = degree; level > 1; level--)
      for (int i = 0; i < level; i++)
        row[i] = (1 - s) * row[i] + s * row[i + 1];
    left[j] = row[0], right[j] = row[1];
  }
  for (int level = degree; level > 1; level--)
    for (int j = 0; j < level; j++) {
      left[j] = (1 - t) * left[j] + t * left[j + 1];
      right[j] = (1 - t) * right[j] + t * right[j + 1];
    }
  Vec<3> across0 = right[0] - left[0], across1 = right[1] - left[1];
  x = (1 - t) * (left[0] + s * across0) + t * (left[1] + s * across1);
  dx.Col(0) = int(degree) * ((1 - t) * across0 + t * across1);
  dx.Col(1) = int(degree) * ((1 - s) * (left[1] - left[0]) + s * (right[1] - right[0]));
}
} // namespace

template <>
void EvaluateBernstein(ELEMENT_TYPE type, int degree, FlatArray<Vec<3>> control, Vec<2> xi,
                       Vec<3> & x, Mat<3, 2> & dx) {
  if (type == ET_TRIG)
    return EvaluateTrig(degree, control, xi, x, dx);
  WithDegree(degree, [&](auto degree) { EvaluateQuad(degree, control.Data(), xi, x, dx); });
}

template <>
Mat<1, 1> BernsteinHessian(ELEMENT_TYPE, int degree, FlatVector<> control, Vec<1> xi) {
  ArrayMem<double, 12> memory(degree + 1);
  FlatVector<> second(degree + 1, memory.Data());
  CalcLineSecondDerivative(degree, xi(0), second);
  return Mat<1, 1>(InnerProduct(second, control));
}

namespace {
/// By a degree two less, whose control points are second differences.
Mat<2, 2> TrigHessian(int degree, FlatVector<> control, Vec<2> xi) {
  Mat<2, 2> result = 0.0;
  if (degree < 2)
    return result;
  ArrayMem<double, 36> memory(NControlPoints(ET_TRIG, degree - 2));
  FlatVector<> lower(memory.Size(), memory.Data());
  CalcTrig(degree - 2, xi, lower);
  for (int j : Range(degree - 1))
    for (int i : Range(degree - 1 - j)) {
      auto c = [&](int k, int l) { return control(TrigNumber(degree, i + k, j + l)); };
      double factor = degree * (degree - 1) * lower(TrigNumber(degree - 2, i, j));
      result(0, 0) += factor * (c(2, 0) - 2 * c(1, 0) + c(0, 0));
      result(1, 1) += factor * (c(0, 2) - 2 * c(0, 1) + c(0, 0));
      result(0, 1) += factor * (c(1, 1) - c(1, 0) - c(0, 1) + c(0, 0));
    }
  result(1, 0) = result(0, 1);
  return result;
}

Mat<2, 2> QuadHessian(int degree, FlatVector<> control, Vec<2> xi) {
  int n = degree + 1;
  ArrayMem<double, 72> memory(6 * n);
  FlatMatrix<> s(3, n, &memory[0]), t(3, n, &memory[3 * n]); // of each derivative
  for (auto [line, at] : {pair(s, xi(0)), pair(t, xi(1))}) {
    CalcLine(degree, at, &line(0, 0));
    CalcLineDerivative(degree, at, &line(1, 0));
    CalcLineSecondDerivative(degree, at, line.Row(2));
  }
  auto sum = [&](int k, int l) {
    double value = 0;
    for (int j : Range(n))
      for (int i : Range(n))
        value += s(k, i) * t(l, j) * control(j * n + i);
    return value;
  };
  Mat<2, 2> result;
  result(0, 0) = sum(2, 0), result(1, 1) = sum(0, 2);
  result(0, 1) = result(1, 0) = sum(1, 1);
  return result;
}
} // namespace

template <>
Mat<2, 2> BernsteinHessian(ELEMENT_TYPE type, int degree, FlatVector<> control, Vec<2> xi) {
  return type == ET_TRIG ? TrigHessian(degree, control, xi) : QuadHessian(degree, control, xi);
}

template Array<Vec<1>> ControlSites(ELEMENT_TYPE, int);
template Array<Vec<2>> ControlSites(ELEMENT_TYPE, int);
template Array<Vec<1>> InterpolationPoints(ELEMENT_TYPE, int);
template Array<Vec<2>> InterpolationPoints(ELEMENT_TYPE, int);
template Matrix<> ControlFromValues<1>(ELEMENT_TYPE, int);
template Matrix<> ControlFromValues<2>(ELEMENT_TYPE, int);
} // namespace ngslac
