// SPDX-License-Identifier: LGPL-2.1-or-later
#include "indexmap.hpp"
#include "numpy.hpp"

namespace ngslac {
using namespace ngla;

namespace {
/// Elimination of dofs inside of elements from a matrix, exactly, as static condensation does it.
///
/// With inner dofs I, which come in groups that are not coupled to each other, and all others B:
/// what is left is  K_BB - K_BI K_II^-1 K_IB.
class InnerElimination {
  /// Larger groups are none of single elements.
  static constexpr size_t largest = 3000;

public:
  /// Throws where the matrix of a group is singular.
  InnerElimination(shared_ptr<SparseMatrix<double>> amat, const BitArray & inner)
      : mat(amat), isinner(inner) {
    static Timer timer("ngslac::InnerElimination");
    RegionTimer reg(timer);
    if (isinner.Size() != mat->Height() || mat->Height() != mat->Width())
      throw Exception("InnerElimination: " + ToString(isinner.Size()) + " bits for a matrix of " +
                      ToString(mat->Height()) + " rows and " + ToString(mat->Width()) + " columns");
    FindGroups();
    ParallelFor(groups.Size(), [&](size_t g) {
      groups[g].inverse = Block(groups[g].inner, groups[g].inner);
      CalcInverse(groups[g].inverse);
    });
    AllocateLeft();
    for (auto & group : groups)
      Subtract(group);
  }

  /// What is left; inner rows and columns have their diagonal alone.
  shared_ptr<SparseMatrix<double>> Left() const { return left; }
  /// The right hand side of the others, zero on inner dofs.
  void Reduce(FlatVector<> rhs, FlatVector<> reduced) const {
    VVector<> solved(rhs.Size()), image(rhs.Size());
    solved.FV() = 0.0;
    AddInner(rhs, solved.FV());
    mat->Mult(solved, image);
    for (size_t i : Range(rhs))
      reduced(i) = isinner.Test(i) ? 0.0 : rhs(i) - image.FV()(i);
  }

  /// Fills in the inner dofs of a solution.
  void Expand(FlatVector<> rhs, FlatVector<> x) const {
    VVector<> outer(rhs.Size()), image(rhs.Size());
    for (size_t i : Range(x))
      outer.FV()(i) = x(i) = isinner.Test(i) ? 0.0 : x(i);
    mat->Mult(outer, image);
    image.FV() = rhs - image.FV();
    AddInner(image.FV(), x);
  }

private:
  struct Group {
    Array<int> inner, outer; // its dofs, and those they are coupled to, in ascending order
    Matrix<> inverse;        // of its own matrix
  };

  void FindGroups() {
    Array<bool> found(mat->Height());
    found = false;
    for (int i : Range(found))
      if (isinner.Test(i) && !found[i])
        groups.Append(GroupOf(i, found));
  }

  Group GroupOf(int first, Array<bool> & found) const {
    Group group;
    IndexMap outer;
    group.inner.Append(first);
    found[first] = true;
    for (size_t next = 0; next < group.inner.Size(); next++) {
      if (group.inner.Size() > largest)
        throw Exception("InnerElimination: dofs of many elements are coupled");
      for (int j : mat->GetRowIndices(group.inner[next]))
        if (!isinner.Test(j))
          outer.Position(j);
        else if (!found[j]) {
          found[j] = true;
          group.inner.Append(j);
        }
    }
    group.outer = outer.Indices();
    QuickSort(group.inner);
    QuickSort(group.outer);
    return group;
  }

  Matrix<> Block(FlatArray<int> rows, FlatArray<int> columns) const {
    Matrix<> block(rows.Size(), columns.Size());
    block = 0.0;
    for (size_t i : Range(rows)) {
      auto indices = mat->GetRowIndices(rows[i]);
      auto values = mat->GetRowValues(rows[i]);
      for (size_t j = 0, k = 0; j < columns.Size() && k < indices.Size();)
        if (indices[k] == columns[j])
          block(i, j++) = values(k++);
        else
          indices[k] < columns[j] ? k++ : j++;
    }
    return block;
  }

  /// The part of the matrix that is not inner: elements couple all of their dofs.
  void AllocateLeft() {
    auto keeps = [&](int i, int j) { return i == j || !(isinner.Test(i) || isinner.Test(j)); };
    Array<int> sizes(mat->Height());
    ParallelFor(sizes.Size(), [&](size_t i) {
      sizes[i] = 0;
      for (int j : mat->GetRowIndices(i))
        sizes[i] += keeps(i, j);
    });
    left = make_shared<SparseMatrix<double>>(sizes, sizes.Size());
    ParallelFor(sizes.Size(), [&](size_t i) {
      auto indices = mat->GetRowIndices(i);
      auto values = mat->GetRowValues(i);
      for (size_t k = 0, at = 0; k < indices.Size(); k++)
        if (keeps(i, indices[k])) {
          left->GetRowIndices(i)[at] = indices[k];
          left->GetRowValues(i)(at++) = values(k);
        }
    });
  }

  void Subtract(const Group & group) {
    Matrix<> factors = Block(group.outer, group.inner) * group.inverse;
    Matrix<> product = factors * Block(group.inner, group.outer);
    for (size_t i : Range(group.outer)) {
      auto indices = left->GetRowIndices(group.outer[i]);
      auto values = left->GetRowValues(group.outer[i]);
      size_t k = 0;
      for (size_t j : Range(group.outer)) {
        while (k < indices.Size() && indices[k] < group.outer[j])
          k++;
        if (k == indices.Size() || indices[k] != group.outer[j])
          throw Exception("InnerElimination: an element does not couple all of its dofs");
        values(k) -= product(i, j);
      }
    }
  }

  /// x += K_II^-1 r
  void AddInner(FlatVector<> r, FlatVector<> x) const {
    ParallelFor(groups.Size(), [&](size_t g) {
      auto & [inner, outer, inverse] = groups[g];
      Vector<> part(inner.Size());
      for (size_t i : Range(inner))
        part(i) = r(inner[i]);
      Vector<> solved = inverse * part;
      for (size_t i : Range(inner))
        x(inner[i]) += solved(i);
    });
  }

  shared_ptr<SparseMatrix<double>> mat, left;
  BitArray isinner;
  Array<Group> groups;
};

size_t Size(const InnerElimination & self) {
  return self.Left()->VHeight();
}
} // namespace

void ExportInner(py::module & m) {
  py::class_<InnerElimination, shared_ptr<InnerElimination>>(
      m, "InnerElimination",
      "Exact elimination of `inner` dofs, which are coupled within elements only, from a real\n"
      "sparse matrix. Throws where they cannot be eliminated.")
      .def(py::init([](shared_ptr<BaseMatrix> mat, const BitArray & inner) {
             auto sparse = dynamic_pointer_cast<SparseMatrix<double>>(mat);
             if (!sparse || dynamic_pointer_cast<SparseMatrixSymmetric<double>>(mat))
               throw Exception("InnerElimination: the matrix must be sparse, real and scalar");
             py::gil_scoped_release release;
             return make_shared<InnerElimination>(sparse, inner);
           }),
           py::arg("mat").none(false), py::arg("inner"))
      .def_property_readonly(
          "mat",
          [](const InnerElimination & self) -> shared_ptr<BaseMatrix> { return self.Left(); },
          "Matrix of the other dofs; the inner ones have their diagonal alone.")
      .def(
          "Reduce",
          [](const InnerElimination & self, Numbers<double> rhs) {
            Numbers<double> reduced(rhs.size());
            auto from = View(rhs, Size(self)), to = View(reduced, Size(self));
            py::gil_scoped_release release;
            self.Reduce(from, to);
            return reduced;
          },
          py::arg("rhs"), "Right hand side of `mat`, zero on inner dofs.")
      .def(
          "Expand",
          [](const InnerElimination & self, Numbers<double> rhs, Numbers<double> x) {
            Numbers<double> solution(x.size());
            auto from = View(rhs, Size(self)), part = View(x, Size(self));
            auto to = View(solution, Size(self));
            py::gil_scoped_release release;
            to = part;
            self.Expand(from, to);
            return solution;
          },
          py::arg("rhs"), py::arg("x"), "Solution on all dofs from one of `mat`.");
}
} // namespace ngslac
