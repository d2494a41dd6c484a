// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include "faceshapes.hpp"
#include "kinematics.hpp"

namespace ngslac {
/// The integral of a scalar field over one side of a macro-element, as a function of its dofs.
struct ScalarRow {
  Array<int> dofs; // sorted
  Array<double> integrals;

  double Of(FlatVector<> x) const {
    double sum = 0;
    for (size_t j : Range(dofs))
      sum += integrals[j] * x(dofs[j]);
    return sum;
  }
};

/// Scalar fields on both sides of macro-elements, and what flows between them.
///
/// Number 2 f of the means is that of field f on the slave, 2 f + 1 that on the master, at the
/// points that face each other.
template <int D>
class InterfaceFlow {
  struct Field {
    ProxyInfo trial;
    unique_ptr<FaceShapes<D>> on[2]; // slave and master; no master: null
  };
  shared_ptr<MacroLaw<D>> law;
  std::vector<Field> fields;
  Array<bool> looks;                    // does anything depend on the means?
  shared_ptr<const Pairing<D>> pairing; // of the last look
  Table<int> segments;                  // of its macro-elements
  Array<ScalarRow> rows;
  Array<double> means;

public:
  double share; // of what flows in residual and matrices

  InterfaceFlow(const ContactSetup & setup, shared_ptr<MacroLaw<D>> alaw, const ProxyInfo & u)
      : law(alaw), share(setup.flowshare) {
    auto & functions = setup.fields;
    looks.SetSize(2 * functions.scalars.size());
    looks = false;
    for (auto & [name, slopes] : functions.slopes)
      for (size_t i : Range(looks))
        looks[i] = looks[i] || slopes[slopes.size() - looks.Size() + i];
    for (auto & scalar : functions.scalars) {
      fields.push_back({ProxyInfo(*scalar, "a scalar field"), {}});
      auto & trial = fields.back().trial;
      if (trial.fes != u.fes || trial.evaluator->Dim() != 1)
        throw Exception("LACContact: a field on the interface must be a scalar trial function of "
                        "the product space of u and lam");
    }
  }

  std::vector<pair<shared_ptr<FESpace>, size_t>> Spaces() const {
    std::vector<pair<shared_ptr<FESpace>, size_t>> spaces;
    for (auto & field : fields)
      spaces.push_back({field.trial.component, field.trial.offset});
    return spaces;
  }
  size_t NMeans() const { return 2 * fields.size(); }
  /// Means of a macro-element at the last evaluation; 0 without a partner.
  FlatVector<> Means(size_t m) { return {NMeans(), means.Data() + NMeans() * m}; }
  /// Slave less master of a scalar field at the last evaluation; 0 before the first one.
  double JumpOf(size_t m, size_t field) const {
    size_t at = NMeans() * m + 2 * field;
    return at + 1 < means.Size() ? means[at] - means[at + 1] : 0;
  }

  void Look(const Kinematics<D> & kinematics, const LACSpace & space, FlatVector<> x) {
    if (fields.empty())
      return;
    TakePairing(kinematics, space);
    rows.SetSize(NMeans() * kinematics.Size()), means.SetSize(rows.Size());
    LocalHeap heap(1000 * 1000, "ngslac-flow", true);
    ParallelForRange(kinematics.Size(), [&](IntRange range) {
      LocalHeap lh = heap.Split();
      for (size_t m : range)
        for (size_t i : Range(NMeans())) {
          HeapReset hr(lh);
          double area = kinematics.Jump().area[m];
          auto & row = rows[NMeans() * m + i];
          row = area > 0 ? RowOf(kinematics, m, i, lh) : ScalarRow();
          means[NMeans() * m + i] = area > 0 ? row.Of(x) / area : 0;
        }
    });
  }

  /// Adds the flows out of the slave and into the master to a residual.
  void AddFlows(size_t m, FlatVector<> y) const {
    for (auto & flow : law->Flows()) {
      auto &slave = RowOf(m, 2 * flow.field), &master = RowOf(m, 2 * flow.field + 1);
      double out = share * law->Flowing(flow, "out", m);
      double in = share * law->Flowing(flow, "in", m);
      for (size_t j : Range(slave.dofs))
        y(slave.dofs[j]) += out * slave.integrals[j];
      for (size_t j : Range(master.dofs))
        y(master.dofs[j]) -= in * master.integrals[j];
    }
  }

  /// How the flows of a macro-element, and its multipliers' rows, change with all that moves.
  struct Lines {
    Array<int> dofs; // sorted: all that anything depends on
    Matrix<> means, jump, normal, traction;

    size_t At(int dof) const {
      return std::lower_bound(dofs.begin(), dofs.end(), dof) - dofs.begin();
    }
  };

  /// A macro-element with its place, its traction and the law's answer.
  struct Macro {
    size_t m;
    MacroPlace<D> place;
    const Vec<D> & traction;
    const Answer<D> & answer;
    const PlaceRows<D> & rows;
  };
  /// alone: the traction is not that of the multipliers, it follows jump and normal as the answer.
  BlockSum LinesOf(const Kinematics<D> & kinematics, const Macro & macro, bool alone,
                   FlatVector<> x, LocalHeap & lh) const {
    auto & [m, place, traction, answer, rows] = macro;
    BlockSum sum;
    if (place.area == 0)
      return sum;
    auto own = law->Dofs(m);
    auto lines = StartLines(kinematics, m, rows, own, lh);
    FillPlace(lines, rows, answer, own, alone);
    for (size_t i : Range(NMeans())) {
      auto & row = RowOf(m, i);
      for (size_t j : Range(row.dofs))
        lines.means(i, lines.At(row.dofs[j])) += row.integrals[j] / place.area;
    }
    AddMoves(lines, kinematics, m, place.area, x, sum, lh);
    for (auto & flow : law->Flows())
      for (bool in : {false, true}) {
        auto slope = law->SlopeOf(flow.name + (in ? "in" : "out"), m, place, traction);
        Vector<> change = Trans(lines.means) * slope.by_scalars;
        change += Trans(lines.jump) * slope.by_jump + Trans(lines.normal) * slope.by_normal;
        change += Trans(lines.traction) * slope.by_traction;
        auto & row = RowOf(m, 2 * flow.field + in);
        Matrix<> block(row.dofs.Size(), lines.dofs.Size());
        for (size_t j : Range(row.dofs))
          block.Row(j) = (in ? -share : share) * row.integrals[j] * change;
        sum.Add(row.dofs, lines.dofs, std::move(block));
      }
    if (!alone && answer.by_scalars.Width()) {
      Mat<D, D> factor = law->RowFactor(m, place);
      Matrix<> by_scalars = factor * answer.by_scalars;
      sum.Add(own, lines.dofs, Matrix<>(by_scalars * lines.means));
    }
    return sum;
  }

private:
  const ScalarRow & RowOf(size_t m, size_t i) const { return rows[NMeans() * m + i]; }
  const FaceShapes<D> * Shapes(size_t i) const { return fields[i / 2].on[i % 2].get(); }

  void TakePairing(const Kinematics<D> & kinematics, const LACSpace & space) {
    auto & surfaces = kinematics.Surfaces();
    if (pairing == surfaces.pairing)
      return;
    for (size_t i : Range(NMeans())) {
      auto & field = fields[i / 2];
      if (auto * surface = i % 2 ? surfaces.master.get() : surfaces.slave.get())
        field.on[i % 2] = ShapesOn(field.trial, *surface);
      CheckSeen(i, *surfaces.pairing);
    }
    segments = SegmentsOfMacros<D>(space, *surfaces.slave, *surfaces.pairing);
    pairing = surfaces.pairing;
  }

  /// Throws where a coefficient uses a field that does not exist there.
  void CheckSeen(size_t i, const Pairing<D> & pairs) const {
    for (auto & segment : pairs.segments)
      if (int face = i % 2 ? segment.master : segment.slave;
          looks[i] && Shapes(i) && face >= 0 && Shapes(i)->HasNone(face))
        throw Exception(
            string("LACContact: a flux or a coefficient looks at a scalar field on the ") +
            (i % 2 ? "master" : "slave") +
            ", where that is not defined; give its value there as a number or a "
            "function of place");
  }

  static unique_ptr<FaceShapes<D>> ShapesOn(const ProxyInfo & trial, const Surface<D> & surface) {
    return make_unique<FaceShapes<D>>(trial, surface, max(1, trial.Order(surface)));
  }

  ScalarRow RowOf(const Kinematics<D> & kinematics, size_t m, size_t i, LocalHeap & lh) const {
    std::map<int, double> sums;
    auto * shapes = Shapes(i);
    for (int s : segments[m]) {
      HeapReset hr(lh);
      auto & segment = pairing->segments[s];
      int face = i % 2 ? segment.master : segment.slave;
      if (!shapes || face < 0)
        continue;
      FlatVector<> sum(shapes->Size(face), lh);
      sum = 0.0;
      for (size_t p : pairing->Points(s)) {
        auto & point = pairing->points[p];
        if (point.weight != 0)
          shapes->AddValues(face, i % 2 ? kinematics.Partner(p) : point.slave, point.weight, sum,
                            lh);
      }
      for (int j : Range(sum))
        sums[shapes->Dofs(face)[D * j]] += sum(j);
    }
    ScalarRow row;
    for (auto [dof, integral] : sums)
      row.dofs.Append(dof), row.integrals.Append(integral);
    return row;
  }

  Lines StartLines(const Kinematics<D> & kinematics, size_t m, const PlaceRows<D> & rows,
                   FlatArray<int> own, LocalHeap & lh) const {
    Lines lines;
    lines.dofs += rows.dofs;
    lines.dofs += own;
    for (size_t i : Range(NMeans()))
      lines.dofs += RowOf(m, i).dofs;
    for (int s : segments[m])
      for (size_t p : pairing->Points(s)) {
        HeapReset hr(lh);
        auto motion = kinematics.MovesOf(pairing->segments[s], p, lh);
        if (motion.moves.Width())
          lines.dofs += motion.dofs;
        break; // the points of a segment move by the same dofs
      }
    SortUnique(lines.dofs);
    size_t n = lines.dofs.Size();
    lines.means.SetSize(NMeans(), n);
    lines.jump.SetSize(D, n), lines.normal.SetSize(D, n), lines.traction.SetSize(D, n);
    lines.means = 0.0, lines.jump = 0.0, lines.normal = 0.0, lines.traction = 0.0;
    return lines;
  }

  static void FillPlace(Lines & lines, const PlaceRows<D> & rows, const Answer<D> & answer,
                        FlatArray<int> own, bool alone) {
    for (int j : Range(rows.dofs)) {
      size_t at = lines.At(rows.dofs[j]);
      lines.jump.Col(at) = rows.jump.Col(j);
      if (rows.normal.Height())
        lines.normal.Col(at) = rows.normal.Col(j);
    }
    if (alone)
      lines.traction = answer.by_jump * lines.jump + answer.by_normal * lines.normal;
    else
      for (int k : Range(D))
        lines.traction(k, lines.At(own[k])) = 1;
  }

  /// Of the points on the master: their values change, and so does where a flow enters.
  void AddMoves(Lines & lines, const Kinematics<D> & kinematics, size_t m, double area,
                FlatVector<> x, BlockSum & sum, LocalHeap & lh) const {
    Array<double> entering(fields.size());
    entering = 0.0;
    for (auto & flow : law->Flows())
      entering[flow.field] += share * law->Flowing(flow, "in", m);
    for (int s : segments[m]) {
      auto & segment = pairing->segments[s];
      Array<Matrix<>> shifts(fields.size());
      Array<int> dofs; // by which all points of a segment move
      for (size_t p : pairing->Points(s)) {
        HeapReset hr(lh);
        auto motion = kinematics.MovesOf(segment, p, lh);
        if (!motion.moves.Width())
          return;
        dofs = motion.dofs;
        double weight = pairing->points[p].weight;
        for (size_t f : Range(fields.size())) {
          auto & shapes = *fields[f].on[1];
          auto own = shapes.Dofs(segment.master);
          auto derivative = shapes.Calc(segment.master, kinematics.Partner(p), lh).derivative;
          Vec<D - 1> gradient = 0.0;
          for (int i : Range(derivative.Width()))
            gradient += x(own[D * i]) * derivative.Col(i);
          FlatVector<> change(dofs.Size(), lh);
          change = weight / area * Trans(motion.moves) * gradient;
          for (int j : Range(dofs))
            lines.means(2 * f + 1, lines.At(dofs[j])) += change(j);
          if (!shifts[f].Height())
            shifts[f].SetSize(derivative.Width(), dofs.Size()), shifts[f] = 0.0;
          if (entering[f] != 0)
            shifts[f] -= entering[f] * weight * Trans(derivative) * motion.moves;
        }
      }
      for (size_t f : Range(dofs.Size() ? fields.size() : 0))
        AddShift(fields[f].on[1]->Dofs(segment.master), shifts[f], dofs, sum);
    }
  }

  /// A dof may come twice, where both faces share it.
  static void AddShift(FlatArray<int> own, const Matrix<> & shift, FlatArray<int> dofs,
                       BlockSum & sum) {
    Array<int> rows, columns(dofs);
    SortUnique(columns);
    Matrix<> block(shift.Height(), columns.Size());
    block = 0.0;
    for (int j : Range(dofs)) {
      auto at = std::lower_bound(columns.begin(), columns.end(), dofs[j]) - columns.begin();
      block.Col(at) += shift.Col(j);
    }
    for (int i : Range(shift.Height()))
      rows.Append(own[D * i]);
    sum.Add(rows, columns, std::move(block));
  }
};
} // namespace ngslac
