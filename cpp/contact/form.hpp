// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include "kinematics.hpp"

namespace ngslac {
/// A contact form: a law, and the kinematics that tells where macro-elements are.
template <int D>
class Form final : public ContactForm {
public:
  explicit Form(const ContactSetup & asetup);

  void Update(shared_ptr<GridFunction> gf, const NamedNumbers * history) override;
  void Follow(const BaseVector & x) override;
  void SetStiffness(FlatVector<> diagonal, double factor) override;
  void LearnStiffness(FlatVector<> diagonal) override;
  void LearnStiffness(const BilinearForm & bulk) override;
  void SetConstant(double value) override { law->c = law->end_c = value; }
  void AddApply(const BaseVector & x, BaseVector & y) override;
  void AssembleLinearization(const BaseVector & x) override;
  void AssembleStep(const BaseVector & x, BaseVector & residual) override;
  void BeginSolve() override { law->BeginSolve(); }
  void Evaluate(const BaseVector & x) override;
  void Lean(FlatArray<double> vectors) override;
  void SetEven(bool even) override { law->has_ends = setup.active && !even; }
  void Commit(const BaseVector & x) override;
  void Restore() override;
  NamedNumbers History() const override;
  void SetHistory(const NamedNumbers & history) override;
  void AddForces(const BaseVector & x, FlatArray<double> tractions, BaseVector & y) override;
  shared_ptr<SparseMatrix<double>> Matrix(const BaseVector & x, FlatArray<double> tractions,
                                          FlatArray<double> stiffness) override;
  void Close(const BitArray & macros, BaseVector & x) override;
  void AddScale(FlatVector<> scale) override;
  shared_ptr<SparseMatrix<double>> JumpMatrix(Side side) override;
  NamedNumbers Table() const override;
  NamedNumbers Resultants() const override;
  void Reevaluate() override { law->Reevaluate(); }
  SegmentTable Segments() const override;
  Array<double> Points() const override;
  size_t NSegments() const override;
  Array<double> Depths() const override;
  Array<double> Overlaps() const override;
  Array<double> GapRanges(FlatVector<> x) override;
  FlatArray<int> MultiplierDofs() const override { return law->dofs; }
  void SetActive(bool active) override;
  FlatArray<int> ToolDofs() const override { return tool ? tool->Dofs() : FlatArray<int>(); }
  Array<double> ToolRows() const override;
  bool IsCurrent() const override;

private:
  void Start(shared_ptr<GridFunction> gf, Meeting meeting);
  /// Switched off, there is no partner.
  MacroPlace<D> Place(size_t m) const;
  /// Everything as it is now is that of a committed step.
  void Accept();
  /// Throws unless these are the entries of a vector on the space that was paired.
  void CheckSize(size_t entries) const;
  /// Throws where a pairing could not be made: of mesh, space and gf.
  void CheckUpdated(const shared_ptr<GridFunction> & gf) const;
  /// The scale c of macro-elements with a partner, 0 for the others.
  void SetScales(const MacroJump<D> & jump, FlatVector<> diagonal, double factor);
  void FillScales(double otherwise);
  /// Looks at x, with scales for the law.
  void Prepare(const BaseVector & x);
  Array<Answer<D>> Answers(FlatVector<> x, bool step);
  /// Those of a law in place of the compiled one.
  Array<Answer<D>> GivenAnswers(FlatVector<> x) const;
  Array<Vec<D>> Tractions(FlatArray<double> flat) const;
  void AddResidual(FlatVector<> x, FlatArray<Answer<D>> answers, FlatVector<> y);
  void AddForces(FlatArray<Vec<D>> tractions, FlatVector<> y);
  void Linearize(FlatArray<Answer<D>> answers, FlatArray<Vec<D>> tractions, Rim rim);
  shared_ptr<SparseMatrix<double>> WithoutMultipliers() const;
  void AddLines(size_t m, const Answer<D> & answer, const PlaceRows<D> & rows,
                BlockSum & sum) const;
  /// Integral over a macro-element of how an unknown of the tool moves it.
  Vec<D> ToolIntegral(size_t m, int unknown) const;
  /// Numbers of boundary elements and of vertices.
  std::array<size_t, 2> MeshSize() const;
  /// Entries of a vector on the product space.
  size_t NScalars() const { return u.fes->GetNDof() * u.fes->GetDimension(); }

  shared_ptr<MacroLaw<D>> law;
  shared_ptr<ToolPath<D>> tool; // null: there is none
  unique_ptr<Kinematics<D>> kinematics;
  Array<Vec<D>> normal;           // of the macro-elements at the last evaluation
  size_t nscalars = 0;            // entries of a vector on the product space that was paired
  std::array<size_t, 2> meshsize; // faces and vertices of the mesh that was paired
  struct {
    Array<Vec<D>> normal;
    Array<MacroState> states;
  } accepted; // at the last committed step
};
} // namespace ngslac
