#include "orthogonal.hpp"

namespace ngslac {
namespace {
/// Of the constraints, in units of the diagonal of K: three times as stiff as the latter takes the
/// fewest iterations, 1 and 10 take a fifth more.
constexpr double penalty = 3;
/// Error of a product with a lift, relative: constraints that depend on each other leave more.
constexpr double inexact = 1e-6;
const char * dependent = "ngslac: constraints of macro-elements depend on each other";

Vector<> Times(const BaseMatrix & mat, FlatVector<> r) {
  Vector<> y(r.Size());
  VFlatVector<double> in(r.Size(), r.Data()), out(y.Size(), y.Data());
  mat.Mult(in, out);
  return y;
}

/// Products of the rows of all macro-elements with each other.
shared_ptr<SparseMatrix<double>> Gram(FlatArray<LocalBlock> blocks, FlatArray<Matrix<>> rows,
                                      FlatArray<int> first, const Table<int> & touching) {
  Array<SparseRow> products(first.Last());
  ForEachSum(blocks.Size(), [&](int m, RowSum & sum) {
    for (size_t q : Range(rows[m].Height())) {
      for (int j : Range(blocks[m].dofs))
        if (double e = rows[m](q, j); e != 0)
          for (int k : touching[blocks[m].dofs[j]])
            if (rows[k].Height())
              for (int p = 0, at = blocks[k].Position(blocks[m].dofs[j]); p < int(rows[k].Height());
                   p++)
                sum.Add(first[k] + p, e * rows[k](p, at));
      products[first[m] + q] = TakeRow(sum);
    }
  });
  Array<int> sizes(products.Size());
  for (int i : Range(products))
    sizes[i] = products[i].columns.Size();
  auto gram = make_shared<SparseMatrix<double>>(sizes, products.Size());
  ParallelFor(products.Size(), [&](size_t i) {
    auto & [columns, values] = products[i];
    auto to = gram->GetRowIndices(i);
    to = columns;
    QuickSort(to);
    for (int j : Range(columns))
      (*gram)(i, columns[j]) = values[j];
  });
  return gram;
}

/// Cholesky factorisation; throws where the matrix is singular.
shared_ptr<BaseMatrix> Inverse(const SparseMatrix<double> & gram) {
  gram.SetInverseType("sparsecholesky");
  auto inverse = gram.InverseMatrix();
  Vector<> x(gram.Height());
  for (size_t i : Range(x))
    x(i) = 1 + 0.5 * cos(double(i));
  Vector<> error = Times(gram, Times(*inverse, x)) - x;
  if (!(L2Norm(error) <= inexact * L2Norm(x)))
    throw Exception(dependent);
  return inverse;
}
} // namespace

OrthogonalCondensation::OrthogonalCondensation(shared_ptr<SparseMatrix<double>> amat,
                                               FlatArray<int> multipliers, int d,
                                               const BitArray & afree)
    : Condensation(amat, multipliers, d, afree) {
  static Timer timer("ngslac::Condense");
  RegionTimer reg(timer);
  E.SetSize(blocks.Size());
  Gt.SetSize(blocks.Size());
  penalised.SetSize(blocks.Size());
  std::atomic<bool> fails = false;
  ParallelFor(blocks.Size(), [&](size_t m) {
    try {
      SplitBlock(blocks[m], *mat, [&](const Matrix<> &) { return FreeDofs(m); });
      FillLocal(m);
    } catch (const Exception &) {
      fails = true;
    }
  });
  if (fails)
    throw Exception(dependent);
  NumberConstraints();
  if (first.Last()) {
    gram = Gram(blocks, E, first, touching);
    inverse = Inverse(*gram);
    gramleft = HasSymmetricContact() ? gram : Gram(blocks, Gt, first, touching);
    inverseleft = gramleft == gram ? inverse : Inverse(*gramleft);
  }
  FillRows();
}

void OrthogonalCondensation::FillRows() {
  Array<bool> changes(mat->Height());
  ParallelFor(changes.Size(), [&](size_t i) {
    changes[i] = false;
    if (!ismultiplier[i])
      for (int m : touching[i])
        changes[i] = changes[i] || blocks[m].NConstraints() || blocks[m].slides;
  });
  StoreRows(Where(changes), [&](int row, RowSum & sum) { SumRow(row, sum); });
}

/// Positions.
Array<int> OrthogonalCondensation::FreeDofs(int m) const {
  Array<int> found;
  for (int j : Range(blocks[m].dofs))
    if (free->Test(blocks[m].dofs[j]))
      found.Append(j);
  return found;
}

void OrthogonalCondensation::FillLocal(int m) {
  auto & block = blocks[m];
  E[m] = block.E2;
  Gt[m] = Trans(block.G2);
  for (int j : Range(block.dofs))
    if (!free->Test(block.dofs[j])) {
      E[m].Col(j) = 0.0;
      Gt[m].Col(j) = 0.0;
    }
  if (block.NConstraints() == 0)
    return;
  Matrix<> right = E[m] * Trans(E[m]), left = Gt[m] * Trans(Gt[m]);
  CalcInverse(right);
  CalcInverse(left);
  Matrix<> product = Gt[m] * Trans(E[m]);
  Matrix<> stiffness = penalty * left * Matrix<>(product * right);
  penalised[m] = stiffness * block.E2;
}

/// Sums up a row of  K + G2 S E2.
void OrthogonalCondensation::SumRow(int row, RowSum & sum) const {
  AddRow(row, 1, sum);
  for (int m : touching[row]) {
    auto & block = blocks[m];
    int pos = block.Position(row);
    for (int k : Range(block.NConstraints()))
      if (double force = block.G2(pos, k); force != 0)
        for (int j : Range(block.dofs))
          if (double e = penalised[m](k, j); e != 0)
            sum.Add(block.dofs[j], force * e);
  }
}

void OrthogonalCondensation::AddLift(double s, FlatVector<> r, FlatVector<> u) const {
  if (!inverse)
    return;
  Vector<> y = Times(*inverse, r);
  for (int m : Range(blocks))
    if (E[m].Height()) {
      Vector<> local = Trans(E[m]) * y.Range(ConstraintsOf(m));
      for (int j : Range(local))
        u(blocks[m].dofs[j]) += s * local(j);
    }
}

Vector<> OrthogonalCondensation::Reactions(FlatVector<> forces) const {
  Vector<> sums(first.Last());
  ParallelFor(blocks.Size(), [&](size_t m) {
    if (Gt[m].Height())
      sums.Range(ConstraintsOf(m)) = Gt[m] * Gather(blocks[m].dofs, forces);
  });
  return inverseleft ? Times(*inverseleft, sums) : sums;
}

void OrthogonalCondensation::ToImage(FlatVector<> z, FlatVector<> image) const {
  static Timer timer("ngslac::Condensation - Project");
  RegionTimer reg(timer);
  if (!inverse)
    return;
  Vector<> lifted(z.Size());
  lifted = 0.0;
  AddLift(-1, Jumps(z), lifted);
  ParallelFor(near.Size(), [&](size_t k) {
    auto columns = Columns(near[k]);
    auto values = Values(near[k]);
    for (size_t j : Range(columns))
      image(near[k]) += values(j) * lifted(columns[j]);
  });
  SubtractReactions(Reactions(image), image);
  ParallelFor(image.Size(), [&](size_t i) {
    if (!free->Test(i))
      image(i) = 0;
  });
}

void OrthogonalCondensation::MultAdd(double s, const BaseVector & x, BaseVector & y) const {
  Vector<> image(x.Size());
  image = 0.0;
  AddProduct(1, x.FV<double>(), image);
  ToImage(x.FV<double>(), image);
  y.FV<double>() += s * image;
}
} // namespace ngslac
