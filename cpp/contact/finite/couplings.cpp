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

/// Sets the coupling of a macro-element, unless it is the same as before; says whether it changed.
template <int D>
bool Update(const Scene<D> & scene, const MacroPoints<D> * start, size_t macro, bool pushes,
            Coupling & coupling) {
  // Unknowns of a tool have a diagonal whatever touches, where the solver may hold them.
  auto & unknowns = scene.unknowns;
  bool exists = scene.points->area[macro] > 0 || unknowns.Size();
  pushes = pushes || unknowns.Size();
  auto key = exists ? KeyOf(*scene.points, start, macro, pushes) : Array<int>();
  if (key == coupling.key)
    return false;
  coupling = Coupling();
  coupling.key = std::move(key);
  if (!exists)
    return true;
  coupling.pushes = pushes;
  Array<int> slaves, masters;
  auto add = [&](const MacroPoints<D> & from) {
    for (int s : from.segments[macro]) {
      slaves.Append(from.pairing->segments[s].slave);
      if (scene.master_shapes)
        masters.Append(from.pairing->segments[s].master);
    }
  };
  auto dofs = [&] {
    auto result = DofsOf(scene.slave_shapes, slaves);
    if (scene.master_shapes)
      result += DofsOf(*scene.master_shapes, masters);
    result += unknowns;
    SortUnique(result);
    return result;
  };
  add(*scene.points);
  coupling.turning = dofs();
  if (pushes)
    coupling.masters = masters;
  if (start)
    add(*start);
  coupling.dofs = dofs();
  return true;
}
} // namespace

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
  const FaceShapes<D> * master;
  FlatArray<int> lamdof;
  const Table<int> & macros;
  const Table<int> & faces;
  IndexMap found; // columns of a row
  std::unordered_map<size_t, int> known;

public:
  RowFinder(FlatArray<Coupling> acouplings, const FaceShapes<D> * amaster, FlatArray<int> alamdof,
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
      if (couplings[m].pushes)
        for (int column : couplings[m].turning)
          found.Position(column);
    }
    for (int face : faces[row])
      for (int column : master->Dofs(face))
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

/// A zero matrix of size n with the entries for all macro-elements.
template <int D>
shared_ptr<SparseMatrix<double>> MatrixOf(FlatArray<Coupling> couplings,
                                          const FaceShapes<D> * master, FlatArray<int> lamdof,
                                          size_t n) {
  size_t nmacros = couplings.Size();
  auto macros = Owners(n, nmacros, [&](size_t m, TableCreator<int> & creator) {
    for (int dof : couplings[m].dofs)
      creator.Add(dof, m);
  });
  auto faces = Owners(n, nmacros, [&](size_t m, TableCreator<int> & creator) {
    for (int face : couplings[m].masters)
      for (int dof : master->Dofs(face))
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
} // namespace

template <int D>
shared_ptr<SparseMatrix<double>>
Couplings::Matrix(const Scene<D> & scene, FlatArray<const MacroPoints<D> *> start,
                  FlatArray<Vec<D>> tractions, FlatArray<int> lamdof, size_t n) {
  couplings.SetSize(start.Size());
  std::atomic<bool> same = last && last->Height() == n;
  ParallelFor(start.Size(), [&](size_t m) {
    if (Update(scene, start[m], m, IsTraction(tractions[m]), couplings[m]))
      same = false;
  });
  if (same) {
    last = make_shared<SparseMatrix<double>>(static_cast<const MatrixGraph &>(*last));
    last->SetZero();
  } else
    last = MatrixOf<D>(couplings, scene.master_shapes, lamdof, n);
  return last;
}

template shared_ptr<SparseMatrix<double>> Couplings::Matrix(const Scene<2> &,
                                                            FlatArray<const MacroPoints<2> *>,
                                                            FlatArray<Vec<2>>, FlatArray<int>,
                                                            size_t);
template shared_ptr<SparseMatrix<double>> Couplings::Matrix(const Scene<3> &,
                                                            FlatArray<const MacroPoints<3> *>,
                                                            FlatArray<Vec<3>>, FlatArray<int>,
                                                            size_t);
} // namespace ngslac
