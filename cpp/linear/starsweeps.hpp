// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include "blockedrows.hpp"

namespace ngslac {
/// Sweeps over overlapping stars of nodes, each of which solves for all of a star at once.
///
/// A star holds a vertex and the nodes of edges, faces and elements around it; where that is the
/// vertex alone these are Gauss-Seidel sweeps. Stars resolve strong couplings inside of elements
/// that sweeps over single nodes miss, as where the stiffness jumps there. (Multiplicative Schwarz
/// method; for high order Schoeberl, Melenk, Pechstein, Zaglmayr, IMA J. Numer. Anal. 28 (2008)
/// 1-24.)
class StarSweeps {
public:
  using Node = BlockedRows::Node;

  /// Of the scalar dofs `which`. `members`: stars of dofs, each of which has `dim` entries; what is
  /// not in `which` does not count, and a node in no star makes one.
  StarSweeps(const Condensation & system, const BitArray & which, FlatTable<int> members, int dim)
      : order(system, which), rows(order.Size()) {
    static Timer timer("ngslac::StarSweeps - setup");
    RegionTimer reg(timer);
    FindStars(members, dim);
    condensed = Changed(system);
    SetTerms(system);
    ParallelFor(rows.Size(), [&](size_t row) { Fill(system, row); });
    Arrange();
    ParallelFor(stars.Size(), [&](size_t s) { Invert(stars[s]); });
  }

  /// Takes over a system whose rows differ from the last one only where either is condensed.
  void Update(const Condensation & system) {
    static Timer timer("ngslac::StarSweeps - update");
    RegionTimer reg(timer);
    if (size_t(system.VHeight()) != order.slot.Size())
      throw Exception("StarSweeps: the system has another size");
    auto now = Changed(system);
    SetTerms(system);
    Array<bool> differs(rows.Size());
    ParallelFor(rows.Size(), [&](size_t row) {
      differs[row] = (now[row] || condensed[row]) && Fill(system, row);
    });
    condensed = std::move(now);
    IndexMap found;
    for (size_t node : Range(differs))
      if (differs[node])
        for (int star : holding[node])
          found.Position(star);
    auto some = found.Indices();
    if (some.Size())
      Arrange(); // the order is that of a new setup
    ParallelFor(some.Size(), [&](size_t i) { Invert(stars[some[i]]); });
  }

  const NodeOrder & Order() const { return order; }
  const BlockedRows & Rows() const { return rows; }
  /// Of nodes and macro-elements.
  size_t NValues() const { return rows.Size() + terms.Size(); }
  /// Makes the values of macro-elements from those of the nodes.
  void SetMacroValues(FlatArray<Node> z) const {
    ParallelFor(terms.Size(), [&](size_t m) {
      Node sum{};
      for (size_t i : Range(terms[m].nodes))
        for (int l : Range(width))
          for (int k : Range(width))
            sum[k] += terms[m].right[width * (width * i + l) + k] * z[terms[m].nodes[i]][l];
      z[rows.Size() + m] = sum;
    });
  }

  /// Improves z in  A z = b, star by star, the other way round with `back`; keeps the values of
  /// macro-elements up to date.
  void Sweep(FlatArray<Node> b, FlatArray<Node> z, bool back) const {
    for (int colour : {int(back), int(!back)})
      ParallelJob(
          [&](TaskInfo info) {
            auto range = chunks[colour][info.task_nr];
            for (size_t i : Range(range.Size()))
              Solve(stars[sequence[back ? range.Next() - 1 - i : range.First() + i]], b, z);
          },
          chunks[colour].Size());
  }

  void Gather(FlatVector<> values, FlatArray<Node> nodes) const {
    ParallelFor(nodes.Size(), [&](size_t row) {
      nodes[row].fill(0);
      for (int k : Range(width))
        if (int dof = order.dofs[width * row + k]; dof >= 0)
          nodes[row][k] = float(values(dof));
    });
  }

  void Scatter(FlatArray<Node> nodes, FlatVector<> values) const {
    ParallelFor(values.Size(), [&](size_t i) {
      int s = order.slot[i];
      values(i) = s >= 0 ? nodes[s / width][s % width] : 0;
    });
  }

private:
  static constexpr int width = NodeOrder::width;

  struct Star {
    Array<int> nodes;
    Array<float> inverse; // column by column
  };

  void FindStars(FlatTable<int> members, int dim) {
    Array<bool> alone(order.Size());
    alone = true;
    for (auto dofs : members) {
      IndexMap nodes;
      for (int dof : dofs)
        for (int k : Range(dim))
          if (dof < 0 || size_t(dim) * dof + k >= order.slot.Size())
            throw Exception("StarSweeps: there is no dof " + ToString(dof) + " of a star");
          else if (int s = order.slot[dim * dof + k]; s >= 0)
            nodes.Position(s / width);
      for (int node : nodes.Indices())
        alone[node] = false;
      if (nodes.Indices().Size())
        stars.Append(Star{Array<int>(nodes.Indices()), Array<float>()});
    }
    for (int node : Range(alone))
      if (alone[node])
        stars.Append(Star{Array<int>{node}, Array<float>()});
    TableCreator<int> creator(order.Size());
    for (; !creator.Done(); creator++)
      for (int s : Range(stars))
        for (int node : stars[s].nodes)
          creator.Add(node, s);
    holding = creator.MoveTable();
  }

  /// The order of the stars, and which are swept at the same time: all even chunks, then all odd
  /// ones.
  void Arrange() {
    Array<Array<int>> neighbours(stars.Size());
    ParallelFor(stars.Size(), [&](size_t s) { neighbours[s] = Neighbours(s); });
    Levels levels(neighbours);
    sequence.SetSize0();
    for (int colour : Range(2)) {
      chunks[colour].SetSize0();
      for (size_t c = colour; c < levels.chunks.Size(); c += 2) {
        chunks[colour].Append(sequence.Size() + IntRange(0, levels.chunks[c].Size()));
        for (int s : levels.nodes.Range(levels.chunks[c]))
          sequence.Append(s);
      }
    }
  }

  /// Adds the local terms to a star's matrix.
  void AddTerms(const Star & star, Matrix<> & dense) const {
    IndexMap macros;
    for (int node : star.nodes)
      for (auto [macro, place] : links[node])
        macros.Position(macro);
    if (!macros.Indices().Size())
      return;
    Matrix<> left(dense.Height(), width * macros.Indices().Size());
    Matrix<> right(left.Width(), left.Height());
    left = 0.0;
    right = 0.0;
    for (int i : Range(star.nodes))
      for (auto [macro, place] : links[star.nodes[i]]) {
        int m = macros.Find(macro), first = width * width * place;
        for (int k : Range(width))
          for (int l : Range(width)) {
            left(width * i + l, width * m + k) = terms[macro].left[first + width * k + l];
            right(width * m + k, width * i + l) = terms[macro].right[first + width * l + k];
          }
      }
    dense += left * right;
  }

  void Invert(Star & star) const {
    size_t n = width * star.nodes.Size();
    Matrix<> dense(n, n);
    dense = 0.0;
    IndexMap places;
    for (int node : star.nodes)
      places.Position(node);
    for (int i : Range(star.nodes)) {
      auto columns = rows.Columns(star.nodes[i]);
      for (size_t j : Range(rows.InBulk(star.nodes[i])))
        if (int column = places.Find(columns[j]); column >= 0)
          for (int l : Range(width))
            for (int k : Range(width))
              dense(width * i + k, width * column + l) =
                  rows.Block(star.nodes[i], j)[width * l + k];
    }
    AddTerms(star, dense);
    CalcInverse(dense);
    star.inverse.SetSize(n * n);
    for (size_t j : Range(n))
      for (size_t i : Range(n))
        star.inverse[n * j + i] = float(dense(i, j));
  }

  void Solve(const Star & star, FlatArray<Node> b, FlatArray<Node> z) const {
    size_t n = width * star.nodes.Size();
    ArrayMem<float, 256> left(n), step(n);
    for (int i : Range(star.nodes)) {
      Node product = rows.Times(star.nodes[i], z);
      for (int k : Range(width))
        left[width * i + k] = b[star.nodes[i]][k] - product[k];
    }
    step = 0.0f;
    for (size_t j : Range(n)) {
      const float * column = &star.inverse[n * j];
      for (size_t i = 0; i < n; i++)
        step[i] += column[i] * left[j];
    }
    for (int i : Range(star.nodes))
      rows.Step(star.nodes[i], {step[width * i], step[width * i + 1], step[width * i + 2], 0}, z);
  }

  /// Stars with a node in the rows of this one, or in one of its macro-elements.
  Array<int> Neighbours(int star) const {
    IndexMap others;
    for (int node : stars[star].nodes)
      for (size_t column : rows.Columns(node))
        for (int other : column < rows.Size() ? holding[column] : sharing[column - rows.Size()])
          if (other != star)
            others.Position(other);
    return Array<int>(others.Indices());
  }

  /// Nodes with a row to which macro-elements add something.
  Array<bool> Changed(const Condensation & system) const {
    Array<bool> changed(order.Size());
    ParallelFor(changed.Size(), [&](size_t row) {
      changed[row] = false;
      for (int dof : order.dofs.Range(width * row, width * (row + 1)))
        changed[row] = changed[row] || (dof >= 0 && system.Changes(dof));
    });
    return changed;
  }

  /// Takes over the local terms, and finds the nodes and stars of each.
  void SetTerms(const Condensation & system) {
    auto local = system.Terms();
    terms.SetSize(local.Size());
    ParallelFor(terms.Size(), [&](size_t m) { terms[m] = NodeTerm(local[m], order); });
    TableCreator<BlockedRows::Link> linker(rows.Size());
    for (; !linker.Done(); linker++)
      for (int m : Range(terms))
        for (int i : Range(terms[m].nodes))
          linker.Add(terms[m].nodes[i], BlockedRows::Link{m, i});
    links = linker.MoveTable();
    TableCreator<int> sharer(terms.Size());
    for (; !sharer.Done(); sharer++)
      for (int m : Range(terms)) {
        IndexMap found;
        for (int node : terms[m].nodes)
          for (int star : holding[node])
            found.Position(star);
        for (int star : found.Indices())
          sharer.Add(m, star);
      }
    sharing = sharer.MoveTable();
  }

  bool Fill(const Condensation & system, size_t row) {
    return rows.Fill(system, order, row, terms, links[row]);
  }

  NodeOrder order;
  BlockedRows rows;
  Array<NodeTerm> terms;          // of the macro-elements
  Table<BlockedRows::Link> links; // of each node
  Array<bool> condensed; // nodes of the present system to which macro-elements add something
  Array<Star> stars;
  Table<int> holding;  // the stars of each node
  Table<int> sharing;  // the stars of each macro-element
  Array<int> sequence; // of the stars
  Array<IntRange> chunks[2];
};
} // namespace ngslac
