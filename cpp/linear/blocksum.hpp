// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <la.hpp>

namespace ngslac {
using namespace ngla;

inline void SortUnique(Array<int> & numbers) {
  QuickSort(numbers);
  numbers.SetSize(std::unique(numbers.begin(), numbers.end()) - numbers.begin());
}

/// Rows and columns that a matrix couples.
struct GraphBlock {
  Array<int> rows, columns; // without duplicates
};

/// A zero matrix of size n with the entries of these blocks.
shared_ptr<SparseMatrix<double>> ZeroMatrix(size_t n, FlatArray<GraphBlock> blocks);

/// Blocks to be added to a matrix later, in rows to which others add, too.
class BlockSum {
  struct Block {
    Array<int> rows, columns; // of these the columns are sorted
    Matrix<> values;
  };
  Array<Block> blocks;

public:
  /// The columns have to be sorted.
  void Add(FlatArray<int> rows, FlatArray<int> columns, Matrix<> && values) {
    blocks.Append(Block{Array<int>(rows), Array<int>(columns), std::move(values)});
  }
  void Clear() { blocks.SetSize0(); }
  /// Appends the rows and columns of its blocks.
  void AppendGraph(Array<GraphBlock> & graph) const {
    for (auto & block : blocks)
      graph.Append(GraphBlock{Array<int>(block.rows), Array<int>(block.columns)});
  }
  /// Adds the rows of one part out of `parts`, which do not meet.
  void AddTo(SparseMatrix<double> & mat, int part, int parts) const;
};

/// A matrix of size n with these blocks, added up in their order.
shared_ptr<SparseMatrix<double>> MatrixOf(size_t n, FlatArray<BlockSum> sums);

/// The sum of two square matrices of the same size.
shared_ptr<SparseMatrix<double>> Sum(const SparseMatrix<double> & a,
                                     const SparseMatrix<double> & b);

/// Size of a heap for blocks of the dofs of two faces, which grows with their degree.
template <int D>
size_t BlockHeap(int degree) {
  size_t functions = D * size_t(pow(degree + 1, D - 1));
  return 20 * 1000 * 1000 + 300 * sqr(functions);
}

/// Runs f(i, heap, sum) for 0 <= i < n in threads, and adds up in the order of i: sums in the order
/// in which threads arrive would differ in the last bits from run to run. Blocks wait only until
/// their batch is complete.
template <typename F>
void AddBlocksInOrder(size_t n, SparseMatrix<double> & mat, size_t heapsize, F f) {
  LocalHeap heap(heapsize, "ngslac-blocks", true);
  int threads = TaskManager::GetNumThreads();
  Array<BlockSum> sums(32 * threads);
  for (size_t first = 0; first < n; first += sums.Size()) {
    auto batch = IntRange(first, min(n, first + sums.Size()));
    ParallelFor(
        batch.Size(),
        [&](size_t k) {
          LocalHeap lh = heap.Split();
          sums[k].Clear();
          f(first + k, lh, sums[k]);
        },
        batch.Size());
    ParallelFor(
        threads,
        [&](int part) {
          for (size_t k : Range(batch.Size()))
            sums[k].AddTo(mat, part, threads);
        },
        threads);
  }
}
} // namespace ngslac
