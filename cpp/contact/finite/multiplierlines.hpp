// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include "contact/macrolaw.hpp"
#include "linear/blocksum.hpp"
#include "macromotion.hpp"

namespace ngslac {
/// Rows and columns of the multipliers in the matrix, where gap, slip and normals are nonlinear.
template <int D>
class MultiplierLines {
  const MacroLaw<D> & law;
  SparseMatrix<double> & mat;

public:
  MultiplierLines(const MacroLaw<D> & alaw, SparseMatrix<double> & amat) : law(alaw), mat(amat) {}

  void SetMultiplierBlock(size_t m, const Vec<D> & normal, double rowarea,
                          const ngbla::Mat<D, D> & derivative) {
    auto by_lam = law.MultiplierBlock(m, normal, rowarea, derivative);
    for (int k : Range(D))
      for (int l : Range(D))
        mat(law.dofs[D * m + k], law.dofs[D * m + l]) = by_lam(k, l);
  }

  /// The columns of a macro-element's multipliers.
  void SetForceColumns(size_t m, const Vec<D> & normal, const MacroRows<D> & rows) {
    ngbla::Mat<D, D> across = Id<D>() - normal * Trans(normal);
    for (int j : Range(rows.dofs)) {
      Vec<D> force = across * Vec<D>(rows.force.Col(j)) + rows.squeeze(j) * normal;
      for (int k : Range(D))
        mat(rows.dofs[j], law.dofs[D * m + k]) = -force(k);
    }
  }

  /// The rows of a macro-element's multipliers by all that it moves with.
  void AddConstraints(size_t m, const MacroGap<D> & mean, const Vec<D> & slip, double area,
                      FlatVector<> x, const Projection<D> & p, const MacroRows<D> & rows,
                      BlockSum & sum) const {
    auto & normal = mean.normal;
    Vec<D> multiplier = law.Multiplier(m, x);
    ngbla::Mat<D, D> across = Id<D>() - normal * Trans(normal);
    auto compliance = law.ComplianceOf(m);
    double c = law.c[m], gap = mean.gap + law.Clearance(m);
    Matrix<> entries(D, rows.dofs.Size());
    for (int j : Range(rows.dofs)) {
      Vec<D> turn = rows.normal.Col(j);
      Vec<D> moved = across * Vec<D>(rows.slip.Col(j));
      moved -= InnerProduct(normal, slip) * turn + InnerProduct(turn, slip) * normal;
      moved -= rows.gap(j) * normal + gap * turn;
      moved += 1 / c * compliance.Turned(normal, turn, multiplier);
      entries.Col(j) = area / c * (p.by_normal * turn) - area * (p.derivative * moved);
    }
    sum.Add(law.dofs.Range(D * m, D * (m + 1)), rows.dofs, std::move(entries));
  }
};
} // namespace ngslac
