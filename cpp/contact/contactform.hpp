// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include "jump.hpp"
#include "law.hpp"
#include "tool/motion.hpp"
#include <map>

namespace ngslac {
/// Arrays of numbers by name.
using NamedNumbers = std::map<string, Array<double>>;

/// A function of the places of all macro-elements: `normal`, `gap`, `slip`, `jump`, `x`, `area`,
/// `c`, `trial` and what was kept of the last step, vectors and matrices row by row.
using ContactLaw = std::function<NamedNumbers(const NamedNumbers &)>;

/// A flow from the slave to the master, such as heat: of a scalar field, per area.
struct Flow {
  size_t field;                              // number among the scalars
  string name;                               // of both functions, "out" and "in" appended
  shared_ptr<CoefficientFunction> out, into; // of the slave, into the master
};

/// Fields of a contact on which its coefficients may depend: numbers of the macro-elements.
struct ContactFields {
  /// A number that the contact remembers: its field when the step begins, and its value at the end.
  using History = std::pair<shared_ptr<GridFunction>, shared_ptr<CoefficientFunction>>;

  /// The components of the slip, gap, pressure, the components of the traction, and the means of
  /// each scalar field on slave and master.
  std::vector<shared_ptr<GridFunction>> values;
  std::vector<shared_ptr<CoefficientFunction>> scalars; // trial functions
  std::vector<Flow> flows;
  /// Derivatives by these trial functions (null: 0) of flows, and of "friction", "tresca" and
  /// "offset" where these depend on fields.
  std::map<string, std::vector<shared_ptr<CoefficientFunction>>> slopes;
  std::map<string, History> memory;
};

/// What a contact form needs besides the two fields.
struct ContactSetup {
  shared_ptr<CoefficientFunction> u, lam; // trial functions
  optional<Region> master;
  shared_ptr<CoefficientFunction> obstacle;  // gap along the slave normal, in place of a master
  shared_ptr<CoefficientFunction> friction;  // Coulomb's coefficient, null: frictionless
  shared_ptr<CoefficientFunction> threshold; // Tresca's bound, null: none
  shared_ptr<CoefficientFunction> offset;    // added to the gap, null: nothing
  shared_ptr<RigidTool> tool;                // a rigid one in place of a master
  bool tied = false;
  bool bilateral = false; // surfaces slide, but do not separate
  bool finite = false;    // sliding and deformation may be large
  bool edges = false;     // pressure goes to where contact ends inside of macro-elements
  double adjust = 0;      // gaps of the start up to this count as zero
  double maxdist = 0;     // 0: chosen from the size of the surfaces
  double penetration = 0; // 0: chosen from the size of the surfaces
  bool active = true;     // off: no partners, no forces
  ContactLaw law;         // in place of the compiled one: tractions and derivatives, see ownlaw.hpp
  ContactFields fields;   // on which the coefficients depend
  NamedNumbers kept;      // the memory of a macro-element before the first step
  double flowshare = 1;   // factor of what flows, as the bulk form has one in its rows
};

/// Values of one macro-element after an evaluation.
struct MacroState {
  double pressure, gap;
  Vec<3> traction, slip;
  Status status;
};

/// Appends its numbers: pressure, gap, status, traction, slip.
void AppendState(Array<double> & flat, const MacroState & state);

/// Contact of one slave with one master surface as a nonlinear form on the product space.
///
/// Residual, for the displacement and for the multipliers (rows scaled by the paired area):
///   R_v = - sum_m lambda_m . int [v1 - v2]
///   R_m = A_m / c_m (P_m(lambda_m - c_m j_m) - lambda_m)
/// with the projection P of the contact law and j = mean (gap along n, slip increment). With small
/// sliding partners, weights and normals are those of the last Update, gap and slip are linear, and
/// the matrix is symmetric where all macro-elements stick. With finite sliding all of them follow
/// the displacement. Dof numbers count the scalar entries of the vectors.
class ContactForm {
public:
  virtual ~ContactForm() = default;
  static shared_ptr<ContactForm> Create(const ContactSetup & setup);

  /// Pairs in the configuration of `gf` (null: reference); slip counts from there, or is that of a
  /// saved history. A failure leaves everything as it was.
  virtual void Update(shared_ptr<GridFunction> gf, const NamedNumbers * history) = 0;
  /// Throws unless the surfaces are paired, on the present mesh and space.
  void CheckPaired() const;
  /// Finite sliding: pairs anew at x. The points on the slave faces and the partners stay until the
  /// next call. Nothing to do with small sliding.
  virtual void Follow(const BaseVector & x) = 0;
  /// Chooses c of every macro-element from the diagonal of the bulk matrix.
  virtual void SetStiffness(FlatVector<> diagonal, double factor) = 0;
  /// Determines which body is the stiffer one, from such a diagonal or from a form, which has
  /// neither condensation nor inertia.
  virtual void LearnStiffness(FlatVector<> diagonal) = 0;
  virtual void LearnStiffness(const BilinearForm & bulk) = 0;
  virtual void SetConstant(double c) = 0;
  virtual void AddApply(const BaseVector & x, BaseVector & y) = 0;
  virtual void AssembleLinearization(const BaseVector & x) = 0;
  /// Matrix and residual of the next Newton step. Same as AddApply and AssembleLinearization, but
  /// a macro-element whose slip direction turned round since the last call has to pass stick.
  /// convex: the matrix leaves out the softening of laws.
  virtual void AssembleStep(const BaseVector & x, BaseVector & residual, bool convex) = 0;
  /// Does a law soften anywhere at x?
  virtual bool Softens(const BaseVector & x) = 0;
  /// Forgets the slip directions of the last iteration.
  virtual void BeginSolve() = 0;
  virtual void Evaluate(const BaseVector & x) = 0;
  /// Finite sliding: from now on -p times the vector of the macro-element is added to each traction
  /// with the pressure p; empty: nothing is added.
  virtual void Lean(FlatArray<double> vectors) = 0;
  /// Makes pressures uniform on macro-elements, also where contact ends inside of them, until it is
  /// called with false: for methods that use means only.
  virtual void SetEven(bool even) = 0;
  /// Accepts x as the end of a step: the next slip increment counts from there.
  virtual void Commit(const BaseVector & x) = 0;
  /// Pairing, motion and states as at the last Commit, or Update if none came after it.
  virtual void Restore() = 0;
  /// The state that a later solve depends on, besides the configuration of the pairing.
  virtual NamedNumbers GetHistory() = 0;
  virtual void SetHistory(NamedNumbers history) = 0;
  /// Subtracts the virtual work of tractions at x, d numbers for each macro-element, and of loads
  /// on a tool. Pressures are even.
  virtual void AddForces(const BaseVector & x, FlatArray<double> tractions, BaseVector & y) = 0;
  /// Matrix of the displacements alone at x where these tractions act, and fall by a stiffness
  /// (d x d, row by row) times the jump; `Mat` has the rows by which they follow.
  virtual shared_ptr<SparseMatrix<double>> Matrix(const BaseVector & x, FlatArray<double> tractions,
                                                  FlatArray<double> stiffness) = 0;
  /// Sets the factor of all flows in the residual and in matrices.
  virtual void SetFlowShare(double share) = 0;
  /// Sets closing multipliers on the macro-elements that are set.
  virtual void Close(const BitArray & macros, BaseVector & x) = 0;
  /// Factors that bring the rows and columns of the multipliers to the size of the bulk's.
  virtual void AddScale(FlatVector<> scale) = 0;
  virtual shared_ptr<SparseMatrix<double>> JumpMatrix(Side side) = 0;
  /// The number of its rows: the matrix is the same as long as this number is.
  virtual size_t JumpNumber() const = 0;

  /// Of all macro-elements, the components of vectors fastest: the values of the last evaluation,
  /// and those that stay until the next pairing.
  virtual NamedNumbers Table() const = 0;
  /// The memory of coefficients and laws, as of the last evaluation.
  virtual NamedNumbers Kept() const = 0;
  /// Takes over the memory of another form on the same macro-elements.
  virtual void KeepFrom(const ContactForm & other) = 0;
  /// Resultants of the tractions of the last evaluation, and their moments (3 numbers) about the
  /// origin.
  virtual NamedNumbers Resultants() const = 0;
  /// Evaluates the means of coefficients again, since Parameters and other functions may have
  /// changed.
  virtual void Reevaluate() = 0;
  /// see SegmentTable
  virtual SegmentTable Segments() const = 0;
  /// see MakePointTable
  virtual Array<double> Points() const = 0;
  virtual size_t NSegments() const = 0;
  /// How deep the search reaches from each macro-element.
  virtual Array<double> Depths() const = 0;
  /// How deep macro-elements lie behind the master that is too deep for the search to find; else 0.
  virtual Array<double> Overlaps() const = 0;
  /// Of each macro-element at x: the least and the greatest gap at its points, and where both are.
  /// Not finite without a partner; finite sliding: paired at x.
  virtual Array<double> GapRanges(FlatVector<> x) = 0;

  shared_ptr<SparseMatrix<double>> Mat() const { return mat; }
  /// Scalar dofs of the unknowns in the motion of a rigid tool.
  virtual FlatArray<int> ToolDofs() const = 0;
  /// How these unknowns move the macro-elements, as JumpMatrix has it for displacements: d rows for
  /// each macro-element, a number for each unknown.
  virtual Array<double> ToolRows() const = 0;
  /// Of each scalar field on the interface: its space, and its first entry in a vector on the
  /// product space.
  virtual std::vector<pair<shared_ptr<FESpace>, size_t>> Scalars() const = 0;
  /// d scalar dofs per macro-element
  virtual FlatArray<int> MultiplierDofs() const = 0;
  shared_ptr<LACSpace> Space() const { return space; }
  const ProxyInfo & U() const { return u; }
  const ProxyInfo & Lambda() const { return lam; }
  /// Switched off, all macro-elements are open at once; switched on, as at the next Update.
  virtual void SetActive(bool active) = 0;
  bool IsActive() const { return setup.active; }
  bool IsPaired() const { return mat != nullptr; }
  /// Are mesh and space still those that were paired?
  virtual bool IsCurrent() const = 0;

protected:
  explicit ContactForm(const ContactSetup & asetup);
  ContactForm(ContactForm &&) = default;
  ContactForm & operator=(ContactForm &&) = default;

  ContactSetup setup;
  ProxyInfo u, lam;
  shared_ptr<LACSpace> space;
  shared_ptr<SparseMatrix<double>> mat;
  Array<MacroState> states;
};
} // namespace ngslac
