// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <algorithm>
#include <core/ngcore.hpp>
#include <gprim/geomobjects.hpp>

namespace ngslac {
using namespace ngcore;

/// A static tree of boxes: halves at the median of the longest axis, each node with the box around
/// all that is below it. Built in O(n log n); a query costs O(log n + hits) for separate boxes.
///
/// netgen's BoxTree neither balances (boundary faces come sorted, which turns it into a list) nor
/// keeps node boxes (a query visits the square root of its leaves).
template <int D>
class BoxTree {
  static constexpr int leafsize = 4;
  struct Node {
    netgen::Box<D> box;
    int first, last; // of the items below
    int right;       // second child, the first follows its parent; 0: leaf
  };
  Array<netgen::Box<D>> boxes;
  Array<Node> nodes;
  Array<int> items;

public:
  explicit BoxTree(Array<netgen::Box<D>> aboxes) : boxes(std::move(aboxes)), items(boxes.Size()) {
    for (int i : Range(items))
      items[i] = i;
    if (items.Size())
      Build(0, items.Size());
  }

  /// Calls f(item) for every item whose box intersects the query (any kind of box).
  template <typename Query, typename F>
  void Visit(const Query & query, F f) const {
    if (nodes.Size() == 0)
      return;
    ArrayMem<int, 100> stack;
    stack.Append(0);
    while (stack.Size()) {
      int i = stack.Last();
      stack.DeleteLast();
      auto & node = nodes[i];
      if (!query.Intersect(node.box))
        continue;
      if (node.right) {
        stack.Append(node.right);
        stack.Append(i + 1);
      } else
        for (int k : Range(node.first, node.last))
          if (query.Intersect(boxes[items[k]]))
            f(items[k]);
    }
  }

  /// Calls f(item) for the items whose boxes are nearer to a point than a limit (squared), which f
  /// may lower; mostly the nearer ones first.
  template <typename F>
  void VisitNear(const netgen::Point<D> & p, const double & limit, F f) const {
    ArrayMem<int, 100> stack;
    if (nodes.Size())
      stack.Append(0);
    while (stack.Size()) {
      int i = stack.Last();
      stack.DeleteLast();
      auto & node = nodes[i];
      if (Square(p, node.box) >= limit)
        continue;
      if (node.right) {
        bool left = Square(p, nodes[i + 1].box) < Square(p, nodes[node.right].box);
        stack.Append(left ? node.right : i + 1);
        stack.Append(left ? i + 1 : node.right);
      } else
        for (int k : Range(node.first, node.last))
          if (Square(p, boxes[items[k]]) < limit)
            f(items[k]);
    }
  }

private:
  /// Of the distance between a point and a box.
  static double Square(const netgen::Point<D> & p, const netgen::Box<D> & box) {
    double sum = 0;
    for (int k = 0; k < D; k++) {
      double apart = std::max({box.PMin()(k) - p(k), p(k) - box.PMax()(k), 0.0});
      sum += apart * apart;
    }
    return sum;
  }

  void Build(int first, int last) {
    netgen::Box<D> all(netgen::Box<D>::EMPTY_BOX), centers(netgen::Box<D>::EMPTY_BOX);
    for (int k : Range(first, last)) {
      auto & box = boxes[items[k]];
      all.Add(box.PMin()), all.Add(box.PMax());
      centers.Add(box.Center());
    }
    size_t me = nodes.Append(Node{all, first, last, 0}), axis = 0;
    if (last - first <= leafsize)
      return;
    for (int k : Range(D))
      if (centers.PMax()(k) - centers.PMin()(k) > centers.PMax()(axis) - centers.PMin()(axis))
        axis = k;
    int middle = (first + last) / 2;
    std::nth_element(items.begin() + first, items.begin() + middle, items.begin() + last,
                     [&](int a, int b) {
                       double x = boxes[a].Center()(axis), y = boxes[b].Center()(axis);
                       return x < y || (x == y && a < b); // the same tree on every machine
                     });
    Build(first, middle);
    nodes[me].right = nodes.Size();
    Build(middle, last);
  }
};
} // namespace ngslac
