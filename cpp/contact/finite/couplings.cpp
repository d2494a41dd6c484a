// SPDX-License-Identifier: LGPL-2.1-or-later
#include "couplings.hpp"
#include "linear/indexmap.hpp"
#include <unordered_map>

namespace ngslac {
namespace {
void SortUnique(Array<int> & numbers) {
  std::sort(numbers.begin(), numbers.end());
  numbers.SetSize(std::unique(numbers.begin(), numbers.end()) - numbers.begin());
}

template <int D>
Array<int> DofsOf(const FaceShapes<D> & shapes, Array<int> & faces) {
  SortUnique(faces);
  Array<int> dofs;
  for (int face : faces)
    dofs += shapes.Dofs(face);
  return dofs;
}

/// Do its forces act, and which faces face each other, now and where slip counts from?
template <int D>
Array<int> KeyOf(const MacroPoints<D> & points, const MacroPoints<D> * start, size_t macro,
                 bool pushes) {
  Array<int> key;
  if (points.area[macro] == 0)
    return key;
  key.Append(pushes);
  for (auto * from : {&points, start})
    if (from) {
      key.Append(from->segments[macro].Size());
      for (int s : from->segments[macro]) {
        key.Append(from->pairing->segments[s].slave);
        key.Append(from->pairing->segments[s].master);
      }
    }
  return key;
}
} // namespace

template <int D>
bool UpdateCoupling(const FaceShapes<D> & slave, const FaceShapes<D> & master,
                    const MacroPoints<D> & points, const MacroPoints<D> * start, size_t macro,
                    bool pushes, Coupling & coupling) {
  auto key = KeyOf(points, start, macro, pushes);
  if (key == coupling.key)
    return false;
  coupling = Coupling();
  coupling.key = std::move(key);
  if (points.area[macro] == 0)
    return true;
  Array<int> slaves, masters;
  auto add = [&](const MacroPoints<D> & from) {
    for (int s : from.segments[macro]) {
      slaves.Append(from.pairing->segments[s].slave);
      masters.Append(from.pairing->segments[s].master);
    }
  };
  add(points);
  coupling.turning = DofsOf(slave, slaves);
  coupling.turning += DofsOf(master, masters);
  SortUnique(coupling.turning);
  if (pushes)
    coupling.masters = masters;
  if (start)
    add(*start);
  coupling.dofs = DofsOf(slave, slaves);
  coupling.dofs += DofsOf(master, masters);
  SortUnique(coupling.dofs);
  return true;
}

namespace {
/// Columns of a range of rows, one row after the other.
struct RowColumns {
  IntRange rows;
  Array<int> columns;
  Array<size_t> first;
};

/// Finds the columns of the rows of displacements; rows of the same macro-elements and faces (those
/// of one node and its neighbours) share the work.
template <int D>
class RowFinder {
  FlatArray<Coupling> couplings;
  const FaceShapes<D> & master;
  FlatArray<int> lamdof;
  const Table<int> & macros;
  const Table<int> & faces;
  IndexMap found; // columns of a row
  std::unordered_map<size_t, int> known;

public:
  RowFinder(FlatArray<Coupling> acouplings, const FaceShapes<D> & amaster, FlatArray<int> alamdof,
            const Table<int> & amacros, const Table<int> & afaces)
      : couplings(acouplings), master(amaster), lamdof(alamdof), macros(amacros), faces(afaces) {}

  void AddRow(int row, RowColumns & result) {
    auto of_row = macros[row];
    size_t begin = result.columns.Size();
    if (auto same = known.find(Key(row)); same != known.end() && macros[same->second] == of_row &&
                                          faces[same->second] == faces[row]) {
      size_t other = same->second - result.rows.First();
      auto columns = Range(result.first[other], result.first[other + 1]);
      result.columns.SetSize(begin + columns.Size());
      result.columns.Range(begin, result.columns.Size()) = result.columns.Range(columns);
      return;
    }
    found.Clear();
    for (int m : of_row) {
      for (int column : lamdof.Range(D * m, D * (m + 1)))
        found.Position(column);
      if (couplings[m].masters.Size())
        for (int column : couplings[m].turning)
          found.Position(column);
    }
    for (int face : faces[row])
      for (int column : master.Dofs(face))
        found.Position(column);
    result.columns += found.Indices();
    std::sort(result.columns.begin() + begin, result.columns.end());
    known[Key(row)] = row;
  }

private:
  size_t Key(int row) const {
    size_t key = 0;
    for (auto list : {macros[row], faces[row]})
      for (int number : list)
        key = 1000003 * key + number + 1;
    return key;
  }
};

/// For each dof the macro-elements (or faces) that have it, sorted.
template <typename F>
Table<int> Owners(size_t n, size_t nmacros, F f) {
  TableCreator<int> creator(n);
  for (; !creator.Done(); creator++)
    ParallelFor(nmacros, [&](size_t m) { f(m, creator); });
  auto table = creator.MoveTable();
  ParallelFor(n, [&](size_t i) {
    if (table[i].Size() > 1)
      std::sort(table[i].begin(), table[i].end());
  });
  return table;
}
} // namespace

template <int D>
shared_ptr<SparseMatrix<double>> MatrixOf(FlatArray<Coupling> couplings,
                                          const FaceShapes<D> & master, FlatArray<int> lamdof,
                                          size_t n) {
  size_t nmacros = couplings.Size();
  auto macros = Owners(n, nmacros, [&](size_t m, TableCreator<int> & creator) {
    for (int dof : couplings[m].dofs)
      creator.Add(dof, m);
  });
  auto faces = Owners(n, nmacros, [&](size_t m, TableCreator<int> & creator) {
    for (int face : couplings[m].masters)
      for (int dof : master.Dofs(face))
        creator.Add(dof, face);
  });
  Array<int> macro_of(n), sizes(n);
  macro_of = -1;
  for (size_t i : Range(lamdof))
    macro_of[lamdof[i]] = i / D;

  Array<RowColumns> parts(4 * TaskManager::GetNumThreads());
  ParallelFor(
      parts.Size(),
      [&](size_t i) {
        auto & part = parts[i];
        part.rows = IntRange(n).Split(i, parts.Size());
        part.first.Append(0);
        RowFinder<D> finder(couplings, master, lamdof, macros, faces);
        for (int row : part.rows) {
          if (int m = macro_of[row]; m >= 0) {
            size_t begin = part.columns.Size();
            part.columns += lamdof.Range(D * m, D * (m + 1));
            part.columns += couplings[m].dofs;
            std::sort(part.columns.begin() + begin, part.columns.end());
          } else if (macros[row].Size())
            finder.AddRow(row, part);
          part.first.Append(part.columns.Size());
          sizes[row] = part.columns.Size() - part.first[part.first.Size() - 2];
        }
      },
      parts.Size());
  auto mat = make_shared<SparseMatrix<double>>(sizes, n);
  ParallelFor(parts.Size(), [&](size_t i) {
    auto & part = parts[i];
    for (int row : part.rows) {
      size_t k = row - part.rows.First();
      mat->GetRowIndices(row) = part.columns.Range(part.first[k], part.first[k + 1]);
      mat->GetRowValues(row) = 0.0;
    }
  });
  return mat;
}

#define INSTANTIATE(D)                                                                             \
  template bool UpdateCoupling(const FaceShapes<D> &, const FaceShapes<D> &,                       \
                               const MacroPoints<D> &, const MacroPoints<D> *, size_t, bool,       \
                               Coupling &);                                                        \
  template shared_ptr<SparseMatrix<double>> MatrixOf(FlatArray<Coupling>, const FaceShapes<D> &,   \
                                                     FlatArray<int>, size_t);
INSTANTIATE(2)
INSTANTIATE(3)
} // namespace ngslac
