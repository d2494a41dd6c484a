#pragma once
#include "coefficients.hpp"
#include "compliance.hpp"
#include "linear/eliminate.hpp"
#include "linear/scatter.hpp"
#include "pairfinder.hpp"

namespace ngslac {
template <int D>
shared_ptr<ContactForm> MakeSmallSliding(const ContactSetup & setup);
template <int D>
shared_ptr<ContactForm> MakeFiniteSliding(const ContactSetup & setup);

/// Where a macro-element is: means over its paired part.
template <int D>
struct MacroPlace {
  Vec<D> normal;
  double gap;  // along the slave normals
  Vec<D> slip; // of this step, perpendicular to the normal
  Vec<D> jump; // what has to vanish: slip minus gap n, or all of u1 - u2 of tied surfaces
};

/// What does not depend on how the surfaces move: macro-elements, scales, law, results.
template <int D>
class FormBase : public ContactForm {
public:
  explicit FormBase(const ContactSetup & asetup);

  void SetStiffness(FlatVector<> diagonal, double factor) override;
  void SetConstant(double value) override { c = value; }
  void BeginSolve() override { direction = Vec<D>(0.0); }
  void Evaluate(const BaseVector & x) override;
  void Restore() override;
  FormHistory History() const override;
  void SetHistory(const FormHistory & history) override;
  bool IsCurrent() const override;
  void UpdateMultipliers(BaseVector & x, double factor) override;
  void Close(const BitArray & macros, BaseVector & x) override;
  void AddScale(FlatVector<> scale) override;
  void AddApply(const BaseVector & x, BaseVector & y) override;
  shared_ptr<SparseMatrix<double>> JumpMatrix(Side side) override;
  Array<double> Vectors(const string & name) const override;
  Array<double> Scalars(const string & name) const override;
  size_t NSegments() const override;
  Array<double> Overlaps() const override;
  SegmentTable Segments() const override;

protected:
  /// Takes over a pairing, and makes its macro-elements where there are none.
  void Take(Paired<D> paired);
  /// Everything as it is now is that of a committed step.
  void Accept();
  /// Fills the rows of the jump, which finite sliding seldom needs.
  void NeedRows();
  /// Scales, law and states for new macro-elements.
  void Reset();
  /// of the macro-elements on the slave surface
  void CollectMultiplierDofs(const Surface<D> & surface);
  /// Numbers of boundary elements and of vertices.
  std::array<size_t, 2> MeshSize() const;
  /// Evaluates what Parameters and other functions may have changed.
  virtual void Reevaluate();

  /// Numbers of the last committed step that a kind of kinematics keeps.
  virtual FlatArray<double> Memory() const = 0;
  /// Subtracts the virtual work of a traction on one macro-element, whose normal is given.
  virtual void AddForces(size_t m, const Vec<D> & normal, const Vec<D> & traction, Scatter & y,
                         LocalHeap & lh) const = 0;
  /// Resultant of a traction, and its moment about the origin.
  virtual pair<Vec<D>, Vec<3>> ResultantOf(size_t m, const Vec<D> & traction) const = 0;
  /// Called before Place with another x.
  virtual void Configure(FlatVector<> /* x */) {}
  virtual MacroPlace<D> Place(size_t m, FlatVector<> x) const = 0;
  virtual LawData<D> Data(size_t m, const Vec<D> & normal) const {
    return {normal, c[m], friction[m], threshold[m], setup.tied && jump->area[m] > 0};
  }

  double RowArea(size_t m) const { return jump->area[m] > 0 ? jump->area[m] : jump->fullarea[m]; }
  Vec<D> Multiplier(size_t m, FlatVector<> x) const;
  /// Adds the residual of the multiplier's rows; returns the multiplier.
  Vec<D> AddMultiplierResidual(size_t m, FlatVector<> x, const Projection<D> & p,
                               FlatVector<> y) const;
  /// An open macro-element that goes on as in the last step will touch where its path meets the
  /// master: what it moves until then, counted in such steps, is no slip.
  static double TimeToTouch(const MacroState & state, double approach, double motion) {
    bool touches = state.status == Status::open && state.gap > 0 && approach > 0.1 * motion &&
                   state.gap < 10 * approach;
    return touches ? state.gap / approach : 0;
  }
  /// The traction before the projection. Macro-elements without a partner stay open.
  Vec<D> Trial(size_t m, const MacroPlace<D> & place, FlatVector<> x) const {
    if (jump->area[m] == 0)
      return place.normal;
    Vec<D> traction = Multiplier(m, x);
    return traction - ComplianceOf(m).At(place.normal) * traction - c[m] * place.jump;
  }
  Compliance<D> ComplianceOf(size_t m) const {
    return Compliance<D>(space->ReachOf(m), setup.tied);
  }
  /// Derivative of a multiplier's rows by the multiplier, from that of the projection.
  ngbla::Mat<D, D> MultiplierBlock(size_t m, const Vec<D> & normal,
                                   const ngbla::Mat<D, D> & projection) const {
    ngbla::Mat<D, D> by_trial = projection - projection * ComplianceOf(m).At(normal);
    return (RowArea(m) / c[m]) * (by_trial - Id<D>());
  }
  /// Slip that comes back when the tangential traction is taken away: it counts on.
  Vec<D> ElasticSlip(size_t m, const Vec<D> & normal, FlatVector<> x) const {
    if (ComplianceOf(m).IsRigid() || !(c[m] > 0))
      return Vec<D>(0.0);
    Vec<D> slip = (1 / c[m]) * (ComplianceOf(m).At(normal) * Multiplier(m, x));
    return slip - InnerProduct(slip, normal) * normal;
  }
  /// Heap for blocks of the dofs of two faces: their size grows with the order.
  size_t BlockHeap() const {
    size_t functions = D * size_t(pow(slave->Degree() + 1, D - 1));
    return 20 * 1000 * 1000 + 300 * sqr(functions);
  }
  /// The projection, but what slips the other way than in the last Newton step sticks.
  Projection<D> ProjectWithMemory(size_t m, const Vec<D> & normal, const Vec<D> & trial);
  /// Throws where a pairing could not be made: of mesh, space and gf.
  void CheckUpdated(const shared_ptr<GridFunction> & gf) const;
  /// Entries of a vector on the product space.
  size_t NScalars() const { return u.fes->GetNDof() * u.fes->GetDimension(); }
  Projection<D> ProjectAt(size_t m, const MacroPlace<D> & place, FlatVector<> x) const {
    return Project(Data(m, place.normal), Trial(m, place, x));
  }
  /// The stiffness of a macro-element's spring as derivative of a projection.
  ngbla::Mat<D, D> Spring(size_t m, FlatArray<double> stiffness) const {
    ngbla::Mat<D, D> derivative;
    for (int k : Range(D))
      for (int l : Range(D))
        derivative(k, l) = stiffness[(m * D + k) * D + l] / c[m];
    return derivative;
  }
  void CheckSprings(FlatArray<double> stiffness) const {
    if (stiffness.Size() != D * D * jump->Size())
      throw Exception("LACContact: " + ToString(stiffness.Size()) + " stiffnesses of springs for " +
                      ToString(jump->Size()) + " macro-elements");
  }
  /// Matrix of the displacements alone, from an assembled `mat`.
  shared_ptr<SparseMatrix<double>> Penalized() const {
    Array<double> penalties(jump->Size());
    for (size_t m : Range(jump->Size()))
      penalties[m] = c[m] / RowArea(m);
    return EliminateMultipliers(*mat, lamdof, D, penalties);
  }
  void CheckSize(size_t entries) const;
  void Prepare(const BaseVector & x);

  /// Makes c larger while it lives.
  struct Augmentation {
    Array<double> & c;
    Array<double> before;
    Augmentation(Array<double> & ac, double factor) : c(ac), before(ac) {
      for (double & value : c)
        value *= factor;
    }
    ~Augmentation() { c = before; }
  };

  shared_ptr<Surface<D>> slave, master;
  shared_ptr<Pairing<D>> pairing;
  shared_ptr<MacroJump<D>> jump;
  Array<Vec<D>> normal; // of the macro-elements at the last evaluation
  Watch watch_friction, watch_threshold;
  PairFinder<D> finder;
  Array<double> c, friction, threshold;
  size_t nscalars = 0;            // entries of a vector on the product space
  std::array<size_t, 2> meshsize; // faces and vertices of the mesh that was paired
  Array<Vec<D>> reference;        // slip counts from there
  Array<Vec<D>> direction;        // of slip in the last Newton step
  struct {
    Paired<D> surfaces;
    Array<Vec<D>> normal;
    Array<MacroState> states;
  } accepted; // at the last committed step
};
} // namespace ngslac
