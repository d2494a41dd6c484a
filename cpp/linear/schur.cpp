// SPDX-License-Identifier: LGPL-2.1-or-later
#include "addscaled.hpp"
#include "blocksum.hpp"
#include "numpy.hpp"
#include <triangular.hpp>

namespace ngslac {
using namespace ngla;

namespace {
/// The factors A = L D L^T of NGSolve's sparse Cholesky factorisation, one after the other.
///
/// Vectors of Forward and Backward are in the order of elimination, those of the matrix in its own.
class CholeskyFactors {
  shared_ptr<const SparseCholeskyTM<double>> factors;
  Array<int> blockof; // in the order of elimination

public:
  /// Throws unless `inverse` is such a factorisation of a real scalar matrix.
  explicit CholeskyFactors(shared_ptr<BaseMatrix> inverse)
      : factors(dynamic_pointer_cast<const SparseCholeskyTM<double>>(inverse)) {
    if (!factors)
      throw Exception("SchurComplement: the inverse must be a real scalar 'sparsecholesky'");
    blockof.SetSize(Size());
    for (int nr : Range(NBlocks()))
      blockof[Block(nr)] = nr;
  }

  size_t Height() const { return factors->VHeight(); }
  size_t Size() const { return factors->GetNUsed(); } // eliminated dofs
  size_t NEntries() const { return factors->GetLFact().Size(); }
  size_t NBlocks() const { return factors->GetBlocks().Size() - 1; }
  /// Rows of L that share what is below them.
  IntRange Block(int nr) const { return factors->BlockDofs(nr); }
  FlatArray<int> Below(int nr) const { return factors->BlockExtDofs(nr); }
  int BlockOf(int i) const { return blockof[i]; }
  /// Place of a dof in the order of elimination, -1 where it has none.
  int Place(int dof) const { return factors->GetOrder()[dof]; }
  /// 1 / D
  FlatArray<double> InverseDiagonal() const { return factors->GetDiag(); }
  /// Entries of a column of L below the diagonal: the rest of its block, then what is below.
  FlatVector<> Column(int i) const {
    auto first = factors->GetFirstInRow();
    return {first[i + 1] - first[i], &factors->GetLFact()[first[i]]};
  }

  /// L^-1 of a vector of the matrix.
  Vector<> Forward(FlatVector<> rhs) const {
    Vector<> y(Size());
    for (int i : Range(y))
      y(i) = rhs(factors->GetInvOrder()[i]);
    Array<double> local;
    for (int nr : Range(NBlocks())) {
      auto block = Block(nr);
      auto below = Below(nr);
      int size = block.Size(), all = size + below.Size();
      local.SetSize(all);
      local = 0.0;
      for (int i : Range(size))
        local[i] = y(block.First() + i);
      for (int i : Range(size))
        AddScaled(-local[i], Column(block.First() + i).Data(), &local[i] + 1, all - i - 1);
      for (int i : Range(size))
        y(block.First() + i) = local[i];
      for (int i : Range(below))
        y(below[i]) += local[size + i];
    }
    return y;
  }

  /// L^-T D^-1 y as a vector of the matrix; y is used up.
  Vector<> Backward(FlatVector<> y) const {
    for (int i : Range(y))
      y(i) *= InverseDiagonal()[i];
    Array<double> local;
    for (int nr = int(NBlocks()) - 1; nr >= 0; nr--) {
      auto block = Block(nr);
      auto below = Below(nr);
      int size = block.Size(), all = size + below.Size();
      local.SetSize(all);
      for (int i : Range(size))
        local[i] = y(block.First() + i);
      for (int i : Range(below))
        local[size + i] = y(below[i]);
      for (int i = size - 1; i >= 0; i--) {
        auto column = Column(block.First() + i);
        local[i] -= InnerProduct(column, FlatVector<>(column.Size(), &local[i] + 1));
        y(block.First() + i) = local[i];
      }
    }
    Vector<> x(Height());
    x = 0.0;
    for (int i : Range(y))
      x(factors->GetInvOrder()[i]) = y(i);
    return x;
  }
};

/// A sparse matrix by columns: those of column j are [starts[j], starts[j+1]).
struct SparseColumns {
  Array<size_t> starts;
  Array<int> rows;
  Array<double> values;
  size_t Size() const { return starts.Size() - 1; }
};

/// C^T A^-1 C for sparse columns C, from the factors A = L D L^T.
///
/// Y = L^-1 C has entries where the elimination tree leads from those of C to its root only: a few
/// per column and level in 2D. They are computed block by block of L, all columns at once.
class SchurComplement {
  static constexpr size_t few = 1'000'000;

  /// Rows of Y in a block of L, and the columns that may have entries there.
  struct Part {
    int block;
    Array<int> columns; // sorted
    Matrix<> values;
  };
  CholeskyFactors factors;
  size_t size;
  Array<Part> parts;   // in the order of elimination
  Array<int> partof;   // of the blocks, or -1
  Matrix<> complement; // (size, size)

public:
  /// Throws where Y or the product had more entries than L, and more than a few.
  SchurComplement(shared_ptr<BaseMatrix> cholesky, const SparseColumns & columns)
      : factors(cholesky), size(columns.Size()) {
    static Timer timer("ngslac::SchurComplement");
    RegionTimer reg(timer);
    CheckSize(size * size);
    FindParts(columns);
    Fill(columns);
    complement.SetSize(size, size);
    complement = 0.0;
    for (auto & part : parts) {
      Eliminate(part);
      AddSquare(part);
      PassOn(part);
    }
  }

  size_t Height() const { return factors.Height(); }
  size_t Size() const { return size; }
  const Matrix<> & Complement() const { return complement; }
  const CholeskyFactors & Factors() const { return factors; }
  /// C^T A^-1 f from y = L^-1 f
  Vector<> Trace(FlatVector<> y) const {
    Vector<> trace(size);
    trace = 0.0;
    for (auto & part : parts)
      for (int i : Range(part.values.Height())) {
        int row = factors.Block(part.block).First() + i;
        double factor = factors.InverseDiagonal()[row] * y(row);
        for (int k : Range(part.columns))
          trace(part.columns[k]) += factor * part.values(i, k);
      }
    return trace;
  }

  /// y -= L^-1 C x
  void Subtract(FlatVector<> x, FlatVector<> y) const {
    Vector<> local(size);
    for (auto & part : parts) {
      auto own = local.Range(0, part.columns.Size());
      for (int k : Range(part.columns))
        own(k) = x(part.columns[k]);
      for (int i : Range(part.values.Height()))
        y(factors.Block(part.block).First() + i) -= InnerProduct(part.values.Row(i), own);
    }
  }

private:
  void FindParts(const SparseColumns & columns) {
    Array<Array<int>> found(factors.NBlocks());
    for (int j : Range(size))
      for (auto k : Range(columns.starts[j], columns.starts[j + 1])) {
        int place = factors.Place(columns.rows[k]);
        if (place < 0)
          throw Exception("SchurComplement: a column has an entry where nothing is free");
        found[factors.BlockOf(place)].Append(j);
      }
    partof.SetSize(found.Size());
    partof = -1;
    size_t entries = 0;
    for (int nr : Range(found)) {
      auto & own = found[nr];
      if (!own.Size())
        continue;
      SortUnique(own);
      entries += own.Size() * factors.Block(nr).Size();
      CheckSize(entries);
      int last = -1;
      for (int i : factors.Below(nr))
        if (int next = factors.BlockOf(i); next != last) {
          found[next] += own;
          last = next;
        }
      partof[nr] = parts.Size();
      parts.Append(Part{nr, std::move(own), {}});
    }
  }

  void CheckSize(size_t entries) const {
    if (entries > max(factors.NEntries(), few))
      throw Exception("SchurComplement: the interface is too large");
  }
  void Fill(const SparseColumns & columns) {
    for (auto & part : parts) {
      part.values.SetSize(factors.Block(part.block).Size(), part.columns.Size());
      part.values = 0.0;
    }
    for (int j : Range(size))
      for (auto k : Range(columns.starts[j], columns.starts[j + 1])) {
        int place = factors.Place(columns.rows[k]), block = factors.BlockOf(place);
        auto & part = parts[partof[block]];
        auto at = std::lower_bound(part.columns.begin(), part.columns.end(), j);
        part.values(place - factors.Block(block).First(), at - part.columns.begin()) +=
            columns.values[k];
      }
  }

  void Eliminate(Part & part) {
    auto block = factors.Block(part.block);
    int n = block.Size();
    Matrix<> lower(n, n);
    for (int i : Range(n))
      lower.Col(i).Range(i + 1, n) = factors.Column(block.First() + i).Range(0, n - i - 1);
    TriangularSolve<LowerLeft, Normalized>(lower, part.values);
  }

  void AddSquare(const Part & part) {
    auto block = factors.Block(part.block);
    auto & y = part.values;
    Matrix<> divided = y;
    for (int i : Range(block.Size()))
      divided.Row(i) *= factors.InverseDiagonal()[block.First() + i];
    Matrix<> square = Trans(y) * divided;
    for (int k : Range(part.columns))
      for (int l : Range(part.columns))
        complement(part.columns[k], part.columns[l]) += square(k, l);
  }

  void PassOn(const Part & part) {
    auto block = factors.Block(part.block);
    auto below = factors.Below(part.block);
    int n = block.Size();
    Matrix<> lower(below.Size(), n);
    for (int i : Range(n))
      lower.Col(i) = factors.Column(block.First() + i).Range(n - i - 1, n - i - 1 + below.Size());
    Matrix<> passed = lower * part.values;
    Array<int> place(part.columns.Size());
    for (int r = 0, last = -1; r < below.Size(); r++) {
      int next = factors.BlockOf(below[r]);
      auto & target = parts[partof[next]];
      if (next != last) {
        auto at = target.columns.begin();
        for (int k : Range(place)) {
          at = std::lower_bound(at, target.columns.end(), part.columns[k]);
          place[k] = at - target.columns.begin();
        }
        last = next;
      }
      auto row = target.values.Row(below[r] - factors.Block(next).First());
      for (int k : Range(place))
        row(place[k]) -= passed(r, k);
    }
  }
};

SparseColumns Columns(const Numbers<size_t> & starts, const Numbers<int> & rows,
                      const Numbers<double> & values, int height) {
  SparseColumns columns{FromNumPy(starts), FromNumPy(rows), FromNumPy(values)};
  auto fits = [&](int row) { return row >= 0 && row < height; };
  if (!columns.starts.Size() || columns.starts[0] != 0 ||
      !std::is_sorted(columns.starts.begin(), columns.starts.end()) ||
      columns.starts.Last() != columns.rows.Size() ||
      columns.rows.Size() != columns.values.Size() ||
      !std::all_of(columns.rows.begin(), columns.rows.end(), fits))
    throw Exception("SchurComplement: starts, rows and values are no sparse columns");
  return columns;
}
} // namespace

void ExportSchur(py::module & m) {
  py::class_<SchurComplement, shared_ptr<SchurComplement>>(
      m, "SchurComplement",
      "C^T A^-1 C for sparse columns C, from a 'sparsecholesky' A = L D L^T.\n\n"
      "The columns are those of a scipy csc_matrix; throws where L^-1 C had more entries than L.")
      .def(py::init([](shared_ptr<BaseMatrix> inverse, Numbers<size_t> starts, Numbers<int> rows,
                       Numbers<double> values) {
             auto columns = Columns(starts, rows, values, inverse->VHeight());
             py::gil_scoped_release release;
             return make_shared<SchurComplement>(inverse, columns);
           }),
           py::arg("inverse").none(false), py::arg("starts"), py::arg("rows"), py::arg("values"))
      .def_property_readonly(
          "complement",
          [](const SchurComplement & self) {
            auto & c = self.Complement();
            return Numbers<double>(std::vector<size_t>{c.Height(), c.Width()}, c.Data());
          },
          "(m, m): C^T A^-1 C")
      .def(
          "Forward",
          [](const SchurComplement & self, Numbers<double> rhs) {
            return ToNumPy(self.Factors().Forward(View(rhs, self.Height())));
          },
          py::arg("rhs"), "y = L^-1 rhs, in the order of elimination.")
      .def(
          "Trace",
          [](const SchurComplement & self, Numbers<double> y) {
            return ToNumPy(self.Trace(View(y, self.Factors().Size())));
          },
          py::arg("y"), "C^T A^-1 rhs from y = L^-1 rhs.")
      .def(
          "Solve",
          [](const SchurComplement & self, Numbers<double> y, Numbers<double> x) {
            Vector<> left = View(y, self.Factors().Size());
            self.Subtract(View(x, self.Size()), left);
            return ToNumPy(self.Factors().Backward(left));
          },
          py::arg("y"), py::arg("x"), "A^-1 (rhs - C x) from y = L^-1 rhs.");
}
} // namespace ngslac
