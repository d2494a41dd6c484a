// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include "macromotion.hpp"

namespace ngslac {
/// A slave and a master face whose scalar functions move: number D i + k is component k of function
/// i, those of the slave first. A tool has no faces.
template <int D>
class FacePair {
  const FaceShapes<D> & slave_shapes;
  const FaceShapes<D> * master_shapes;

public:
  const Segment & segment;
  int slaves, masters; // numbers of scalar functions
  FlatArray<int> at;   // positions of the dofs in the rows of the macro-element, slave first

  FacePair(const Scene<D> & now, const Segment & asegment, const MacroRows<D> & rows,
           LocalHeap & lh)
      : FacePair(now.slave_shapes, now.master_shapes, asegment, lh) {
    for (int j : Range(at))
      at[j] = rows.Position(Dof(j));
  }
  /// A pair that belongs to no rows; it has no master if its shapes are null.
  FacePair(const FaceShapes<D> & aslave_shapes, const FaceShapes<D> * amaster_shapes,
           const Segment & asegment, LocalHeap & lh)
      : slave_shapes(aslave_shapes), master_shapes(amaster_shapes), segment(asegment),
        slaves(slave_shapes.Size(segment.slave)),
        masters(master_shapes ? master_shapes->Size(segment.master) : 0),
        at(SlaveDofs().Size() + MasterDofs().Size(), lh) {}

  FlatArray<int> SlaveDofs() const { return slave_shapes.Dofs(segment.slave); }
  FlatArray<int> MasterDofs() const {
    return master_shapes ? master_shapes->Dofs(segment.master) : FlatArray<int>();
  }
  int Dof(int j) const {
    int n = SlaveDofs().Size();
    return j < n ? SlaveDofs()[j] : MasterDofs()[j - n];
  }
  /// of scalar functions times components
  int Size() const { return D * (slaves + masters); }

  /// Adds such columns to rows of the macro-element.
  void AddTo(FlatMatrix<> rows, FlatMatrix<> columns, double factor, LocalHeap & lh) const {
    auto of_dofs = OfDofs(columns, lh);
    for (int row : Range(of_dofs.Height()))
      for (int j : Range(at))
        rows(row, at[j]) += factor * of_dofs(row, j);
  }

  /// A column for each dof in place of each function and component.
  FlatMatrix<> OfDofs(FlatMatrix<> m, LocalHeap & lh) const {
    if (IsPlain())
      return m;
    FlatMatrix<> result(m.Height(), at.Size(), lh);
    result = m * Conversion(lh);
    return result;
  }
  /// The same for rows and columns.
  FlatMatrix<> BlockOfDofs(FlatMatrix<> m, LocalHeap & lh) const {
    if (IsPlain())
      return m;
    FlatMatrix<> result(at.Size(), at.Size(), lh);
    auto by_dof = OfDofs(m, lh);
    result = Trans(Conversion(lh)) * by_dof;
    return result;
  }

private:
  bool IsPlain() const {
    return slave_shapes.IsPlain(segment.slave) &&
           (!master_shapes || master_shapes->IsPlain(segment.master));
  }
  FlatMatrix<> Conversion(LocalHeap & lh) const {
    FlatMatrix<> result(Size(), at.Size(), lh);
    result = 0.0;
    int n1 = D * slaves, dofs1 = SlaveDofs().Size();
    Set(slave_shapes, segment.slave, result.Rows(0, n1).Cols(0, dofs1));
    if (master_shapes)
      Set(*master_shapes, segment.master, result.Rows(n1, Size()).Cols(dofs1, at.Size()));
    return result;
  }
  static void Set(const FaceShapes<D> & shapes, int face, SliceMatrix<> part) {
    if (shapes.IsPlain(face))
      part.Diag() = 1.0;
    else
      part = shapes.Conversion(face);
  }
};

/// By dof D i + k the unit normal of a slave face turns by  -n_k g_i  with these gradients g_i of
/// the scalar functions, a row each.
template <int D>
FlatMatrixFixWidth<D> Gradients(const Mat<D, D - 1> & dx,
                                const typename FaceShapes<D>::Values & shapes, LocalHeap & lh) {
  FlatMatrixFixWidth<D> result(shapes.value.Size(), lh);
  auto dual = DualBasis<D>(dx);
  for (int i : Range(shapes.value.Size()))
    for (int k : Range(D)) {
      double sum = 0;
      for (int a : Range(D - 1))
        sum += dual(k, a) * shapes.derivative(a, i);
      result(i, k) = sum;
    }
  return result;
}

/// A pair of points that once faced each other.
template <int D>
struct OldPair {
  Vec<D> x, apart; // of the slave; since then
  Vec<D> slave_normal, master_normal;
  double gap; // of then
  Mat<D, D - 1> dx, dy;
  ContactDirection<D> direction;

  OldPair(const MeshScene<D> & now, const Segment & segment, const PairPoint<D> & p) : gap(p.gap) {
    Vec<D> y;
    now.slave.Evaluate(segment.slave, p.slave, x, dx);
    now.master.Evaluate(segment.master, p.master, y, dy);
    slave_normal = now.slave.Normal(segment.slave, dx);
    master_normal = now.master.Normal(segment.master, dy);
    direction = ContactDirection<D>(slave_normal, master_normal, now.share);
    apart = x + gap * slave_normal - y;
  }
  Vec<D> Slip() const { return direction.Across() * apart; }
};
} // namespace ngslac
