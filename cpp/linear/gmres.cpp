// SPDX-License-Identifier: LGPL-2.1-or-later
#include "gmres.hpp"

namespace ngslac {
namespace {
constexpr size_t chunk = 2048; // numbers: sums do not depend on the number of threads
constexpr double rounding = 1e-14;

/// Calls f(range, k) for the k-th chunk of n numbers, in parallel.
template <typename F>
void ForChunks(size_t n, F f) {
  ParallelFor((n + chunk - 1) / chunk,
              [&](size_t k) { f(IntRange(k * chunk, min(n, (k + 1) * chunk)), k); });
}

/// Adds a combination of the first vectors.
void Combine(FlatArray<shared_ptr<BaseVector>> vectors, const Vector<> & factors, FlatVector<> w) {
  ForChunks(w.Size(), [&](IntRange range, size_t) {
    for (size_t i : Range(factors))
      w.Range(range) += factors(i) * vectors[i]->FV<double>().Range(range);
  });
}

/// Orthonormal vectors on the free dofs.
class Basis {
  Array<shared_ptr<BaseVector>> vectors;
  const PreconditionedProduct & product;
  const BitArray & free;

public:
  Basis(const PreconditionedProduct & aproduct, const BitArray & afree)
      : product(aproduct), free(afree) {}

  const BaseVector & Last() const { return *vectors.Last(); }

  void Restrict(FlatVector<> w) const {
    ForChunks(w.Size(), [&](IntRange range, size_t) {
      for (size_t i : range)
        if (!free.Test(i))
          w(i) = 0;
    });
  }

  double Norm(FlatVector<> w) const {
    Vector<> squares((w.Size() + chunk - 1) / chunk);
    ForChunks(w.Size(), [&](IntRange range, size_t k) { squares(k) = L2Norm2(w.Range(range)); });
    Vector<> sum(1);
    sum = 0.0;
    for (double square : squares)
      sum(0) += square;
    product.Total(sum);
    return sqrt(sum(0));
  }

  void Append(shared_ptr<BaseVector> w, double norm) {
    *w *= 1 / norm;
    vectors.Append(std::move(w));
  }

  /// Takes off w what the vectors span, and adds its coefficients to h.
  void Project(FlatVector<> w, FlatVector<> h) const {
    size_t m = vectors.Size();
    Matrix<> parts((w.Size() + chunk - 1) / chunk, m);
    ForChunks(w.Size(), [&](IntRange range, size_t k) {
      for (size_t i : Range(m))
        parts(k, i) = InnerProduct(vectors[i]->FV<double>().Range(range), w.Range(range));
    });
    Vector<> sums(m);
    sums = 0.0;
    for (size_t k : Range(parts.Height()))
      sums += parts.Row(k);
    product.Total(sums);
    Combine(vectors, -sums, w);
    h.Range(0, m) += sums;
  }

  /// Makes w orthogonal to the vectors, by coefficients h; returns its norm, 0 where that is
  /// rounding.
  double Orthogonalise(FlatVector<> w, FlatVector<> h) const {
    double size = Norm(w), before = size, after = 0;
    h = 0.0;
    for (int pass = 0; pass < 2 && !(after > 0.5 * before); pass++) {
      before = pass ? after : size;
      Project(w, h);
      after = Norm(w);
    }
    return after > rounding * size ? after : 0;
  }
};

/// Least squares problem of GMRES, turned to a triangle by Givens's rotations.
class Triangle {
  Array<Vector<>> columns;
  Array<double> cosines, sines;
  Array<double> right; // the last one is the residual

public:
  explicit Triangle(double norm) { right.Append(norm); }

  double Residual() const { return fabs(right.Last()); }

  /// Adds a column of the Hessenberg matrix; false if it depends on the others.
  bool Append(Vector<> column) {
    size_t k = columns.Size();
    double size = L2Norm(column);
    for (size_t i : Range(k)) {
      double upper = column(i), below = column(i + 1);
      column(i) = cosines[i] * upper + sines[i] * below;
      column(i + 1) = cosines[i] * below - sines[i] * upper;
    }
    double length = std::hypot(column(k), column(k + 1));
    if (!(length > rounding * size) || !std::isfinite(length))
      return false;
    cosines.Append(column(k) / length);
    sines.Append(column(k + 1) / length);
    column(k) = length;
    columns.Append(std::move(column));
    double last = right.Last();
    right.Last() = cosines[k] * last;
    right.Append(-sines[k] * last);
    return true;
  }

  Vector<> Solution() const {
    Vector<> y(columns.Size());
    for (size_t k = columns.Size(); k-- > 0;) {
      y(k) = right[k];
      for (size_t j : Range(k + 1, columns.Size()))
        y(k) -= columns[j](k) * y(j);
      y(k) /= columns[k](k);
    }
    return y;
  }
};

bool Stalls(FlatArray<double> residuals, size_t patience) {
  size_t n = residuals.Size();
  return patience && n > patience && residuals.Last() > 0.5 * residuals[n - 1 - patience];
}

void CheckSizes(const BaseVector & x, const BaseVector & image, const BaseVector & rhs,
                const BitArray & free) {
  size_t n = x.FV<double>().Size();
  if (image.FV<double>().Size() != n || rhs.FV<double>().Size() != n || free.Size() != n)
    throw Exception("GMRes: the matrix, the right hand side and the free dofs differ in size");
}
} // namespace

GMResSolution GMRes(const PreconditionedProduct & product, const BaseVector & rhs,
                    const BitArray & free, const GMResLimits & limits,
                    const function<void()> & look) {
  static Timer timer("ngslac::GMRes");
  RegionTimer reg(timer);
  shared_ptr<BaseVector> x = product.MakeVector(), start = product.MakeVector();
  CheckSizes(*x, *start, rhs, free);
  *x = 0.0;
  *start = rhs;
  Basis basis(product, free);
  basis.Restrict(start->FV<double>());
  double norm = basis.Norm(start->FV<double>());
  GMResSolution found{x, {norm}, norm == 0};
  if (norm == 0 || !std::isfinite(norm))
    return found;
  basis.Append(start, norm);
  Triangle triangle(norm);
  Array<shared_ptr<BaseVector>> moves; // M^-1 q
  for (int k = 0; k < limits.maxiter && !found.converged; k++) {
    look();
    shared_ptr<BaseVector> next = product.MakeVector();
    moves.Append(product.MakeVector());
    product.Apply(basis.Last(), *moves.Last(), *next);
    auto w = next->FV<double>();
    basis.Restrict(w);
    Vector<> h(k + 2);
    h(k + 1) = basis.Orthogonalise(w, h.Range(0, k + 1));
    if (!triangle.Append(h))
      break;
    found.residuals.Append(triangle.Residual());
    found.converged = found.residuals.Last() <= limits.tol * norm;
    if (h(k + 1) == 0 || Stalls(found.residuals, limits.patience))
      break;
    basis.Append(next, h(k + 1));
  }
  Combine(moves, triangle.Solution(), x->FV<double>());
  return found;
}
} // namespace ngslac
