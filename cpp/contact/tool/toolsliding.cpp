// SPDX-License-Identifier: LGPL-2.1-or-later
#include "contact/finite/couplings.hpp"
#include "contact/finite/forceblocks.hpp"
#include "contact/kinematics.hpp"
#include "macrotool.hpp"

namespace ngslac {
namespace {
/// What is known of one configuration; macro-elements that do not face the tool are left out.
template <int D>
struct ToolMotionNow {
  ToolScene<D> scene;
  int version; // of the tool's path
  shared_ptr<const MacroPoints<D>> points;
  Array<MacroGap<D>> mean;
  Array<Vec<D>> slip; // since the last Commit
};

/// What slip counts from.
template <int D>
struct SlipStart {
  shared_ptr<const MacroPoints<D>> points;
  ToolPartners<D> partners;
};

/// A slave against a rigid tool, in the current configuration.
///
/// The points on the slave faces never change; which of them face the tool is told anew by Follow,
/// and stays until the next one.
template <int D>
class ToolSliding : public Kinematics<D> {
  using Base = Kinematics<D>;
  using Base::finder, Base::law, Base::reference, Base::setup, Base::Size, Base::space,
      Base::surfaces, Base::u;
  using Now = ToolMotionNow<D>;

  ToolPath<D> path;
  unique_ptr<Surface<D>> slave_reference;
  unique_ptr<FaceShapes<D>> shapes;
  shared_ptr<Pairing<D>> all;              // points, with all their weights
  Array<double> fullarea;                  // in the reference configuration
  shared_ptr<const MacroPoints<D>> points; // of the last Follow
  shared_ptr<const SlipStart<D>> start;    // of the last Commit
  shared_ptr<const SlipStart<D>> facing;   // of the last Follow, if LookBack needs it
  Array<Vec<D>> met;                       // see LookBack
  Array<double> last_gap;                  // at the last Commit
  shared_ptr<Now> now;                     // of the last At
  Array<Coupling> couplings;               // of the last ZeroMatrix
  struct {
    Paired<D> surfaces;
    shared_ptr<Now> motion;
  } accepted; // at the last Commit

public:
  ToolSliding(const ContactSetup & setup, shared_ptr<LACSpace> space, const ProxyInfo & u,
              shared_ptr<MacroLaw<D>> law)
      : Base(setup, space, u, law), path(*setup.tool, u) {}

  void Start(shared_ptr<GridFunction>, FlatVector<> x, Meeting meeting) override {
    slave_reference = finder.Slave(nullptr);
    shapes = make_unique<FaceShapes<D>>(u, *slave_reference, slave_reference->Degree());
    int degree = u.Order(*slave_reference) + 2 * (slave_reference->Degree() - 1);
    all = AllPoints<D>(*slave_reference, 2 * degree);
    fullarea = MacroJump<D>(*space, *slave_reference, *all).area;
    law->Reset();
    law->FindDofs(*slave_reference);
    Follow(x);
    reference.SetSize(Size()), last_gap.SetSize(Size());
    reference = Vec<D>(0.0);
    At(x);
    if (meeting == Meeting::now && setup.active)
      CheckSideOfTool<D>(now->scene, *all, setup.maxdist);
    this->AdjustStart();
    for (size_t m : Range(last_gap))
      last_gap[m] = Place(m).gap;
    Accept();
  }

  void Reevaluate() override { path.Reevaluate(); }

  void Save(NamedNumbers & history) const override { history["memory"] = last_gap; }
  void Load(const NamedNumbers & history) override { last_gap = history.at("memory"); }

  void Follow(FlatVector<> x) override {
    path.Reevaluate();
    auto slave = make_unique<Surface<D>>(shapes->Displaced(*slave_reference, x));
    slave->CheckFinite();
    auto pairing = FacingPoints<D>(*all, *slave, path.At(x));
    this->Take(Paired<D>{std::move(slave), nullptr, pairing, nullptr});
    surfaces.jump->fullarea = fullarea;
    points = MakePoints<D>(pairing, *surfaces.slave, *space, surfaces.jump->area);
    if (start)
      LookBack(path.At(x));
  }

  /// Finds distances and means, unless the configuration is still the same.
  void At(FlatVector<> x) override {
    auto slave = shapes->Displaced(*slave_reference, x);
    auto tool = path.At(x);
    bool same = now && now->points == points && now->version == path.Version() &&
                now->scene.slave.HasShapeOf(slave) && now->scene.tool.place == tool.place;
    if (same)
      return;
    now = make_shared<Now>(Now{{*shapes, std::move(slave), std::move(tool)},
                               path.Version(),
                               points,
                               Array<MacroGap<D>>(Size()),
                               Array<Vec<D>>(Size())});
    ParallelFor(Size(), [&](size_t m) {
      if (points->area[m] > 0)
        now->mean[m] = MeanDistance<D>(now->scene, *points, m);
    });
    if (start)
      FindSlip();
  }

  MacroPlace<D> Place(size_t m) const override {
    double area = points->area[m], rowarea = surfaces.jump->RowArea(m);
    if (area == 0)
      return PlaceAt(surfaces.jump->normal[m], 0, Vec<D>(0.0), 0, rowarea);
    auto & mean = now->mean[m];
    Vec<D> slip = Slides(m) ? Slip(m) : Vec<D>(0.0);
    return PlaceAt(mean.normal, mean.gap + law->Clearance(m), slip, area, rowarea);
  }

  /// Of points that face the tool: their distances.
  Array<GapRange<D>> GapRanges(FlatVector<>) const override {
    auto & scene = now->scene;
    auto gap = [&](size_t m, const Segment & segment, const PairPoint<D> & p) {
      Vec<D> x;
      Mat<D, D - 1> dx;
      scene.slave.Evaluate(segment.slave, p.slave, x, dx);
      auto hit = scene.tool.At(scene.InSpace(x));
      bool faces = InnerProduct(scene.slave.Normal(segment.slave, dx), hit.normal) < facing_cosine;
      return faces ? law->Clearance(m) + hit.distance : numeric_limits<double>::quiet_NaN();
    };
    return GapRangesOf<D>(*space, surfaces, gap);
  }

  void AddForces(size_t m, const Vec<D> & traction, Scatter & y, LocalHeap & lh) const override {
    if (points->area[m] > 0 && IsTraction(traction))
      AddToolTraction<D>(now->scene, *points, m, Parts(m, traction), y, lh);
  }

  void AddLoads(FlatVector<> y) const override { path.AddLoads(y); }

  FlatArray<int> ToolDofs() const override { return path.Dofs(); }

  Vec<D> ToolIntegral(size_t m, int i) const override {
    Vec<D> sum = 0.0;
    auto & own = now->scene.tool.dofs[i];
    for (int s : points->segments[m])
      for (auto & p : points->pairing->points.Range(points->pairing->Points(s))) {
        Vec<D> x = now->scene.slave.Point(points->pairing->segments[s].slave, p.slave);
        sum += p.weight * own.At(now->scene.InSpace(x));
      }
    return sum;
  }

  pair<Vec<D>, Vec<3>> ResultantOf(size_t m, const Vec<D> & traction) const override {
    if (points->area[m] == 0 || !IsTraction(traction))
      return {Vec<D>(0.0), Vec<3>(0.0)};
    return Resultant<D>(now->scene.slave, *points, m, Parts(m, traction));
  }

  shared_ptr<SparseMatrix<double>> ZeroMatrix(FlatArray<Vec<D>> tractions, size_t n) override {
    couplings.SetSize(Size());
    ParallelFor(Size(), [&](size_t m) { couplings[m] = CouplingOf(m, IsTraction(tractions[m])); });
    return MatrixOf<D>(couplings, *shapes, law->dofs, n);
  }

  PlaceRows<D> RowsOf(size_t m, const Vec<D> & traction, Rim rim, BlockSum & sum,
                      LocalHeap & lh) const override {
    if (points->area[m] == 0)
      return {};
    MacroRows<D> rows(couplings[m].dofs, couplings[m].turning);
    AddMotion(m, traction, rim, rows, sum, lh);
    auto & mean = now->mean[m];
    Vec<D> slip = Slides(m) ? Slip(m) : Vec<D>(0.0);
    return rows.OfPlace(mean.normal, slip, mean.gap + law->Clearance(m));
  }

  void Commit(FlatVector<> x, FlatArray<MacroState>, FlatArray<MacroState> states) override {
    for (size_t m : Range(Size())) {
      auto & normal = points->area[m] > 0 ? now->mean[m].normal : surfaces.jump->normal[m];
      Vec<D> slip = 0.0; // of all the step, what came before a touch included
      if (Slides(m))
        slip = HasMet(m) ? Slip(m) : now->slip[m];
      slip -= InnerProduct(slip, normal) * normal;
      reference[m] = this->SlipBeforeTouch(states[m], last_gap[m] - states[m].gap, slip);
      reference[m] += law->ElasticSlip(m, normal, x);
      last_gap[m] = states[m].gap;
    }
    Accept();
  }

  void Restore() override {
    surfaces = accepted.surfaces;
    now = accepted.motion;
    points = start->points;
    path.Forget();
  }

private:
  void Accept() {
    start = make_shared<SlipStart<D>>(
        SlipStart<D>{points, PartnersOf<D>(*points->pairing, now->scene.slave, now->scene.tool)});
    FindSlip();
    accepted = {surfaces, now};
  }

  void FindSlip() {
    ParallelFor(Size(), [&](size_t m) {
      if (Slides(m))
        now->slip[m] = SlipIn(now->scene, SlipPoints(m), m);
    });
  }

  /// Nothing has slipped yet before the first Commit.
  bool Slides(size_t m) const { return start && points->area[m] > 0 && law->Slides(m); }

  /// Did the tool come over it from the side?
  bool HasMet(size_t m) const { return start->points->area[m] == 0 && points->area[m] > 0; }
  /// That slip counts of: pairs that faced each other at the last Commit, or do so now.
  const SlipStart<D> & SlipPoints(size_t m) const { return HasMet(m) ? *facing : *start; }
  static Vec<D> SlipIn(const ToolScene<D> & scene, const SlipStart<D> & pairs, size_t m) {
    return ToolSlip<D>(scene, *pairs.points, pairs.partners, m);
  }

  /// How far those that have met the tool were from their partners at the last Commit.
  void LookBack(const ToolPosition<D> & tool) {
    BitArray wanted(Size());
    wanted.Clear();
    for (size_t m : Range(Size()))
      if (HasMet(m) && Slides(m))
        wanted.SetBit(m);
    facing = nullptr;
    if (!wanted.NumSet())
      return;
    facing = make_shared<SlipStart<D>>(
        SlipStart<D>{points, PartnersOf<D>(*points->pairing, *surfaces.slave, tool)});
    auto & before = accepted.motion->scene;
    met.SetSize(Size());
    for (size_t m : Range(Size()))
      if (wanted.Test(m))
        met[m] = Carried<D>(before.slave, *surfaces.slave, *points, m, SlipIn(before, *facing, m));
  }

  MacroTraction<D> Parts(size_t m, const Vec<D> & traction) const {
    return {traction, now->mean[m]};
  }

  const Vec<D> & Offset(size_t m) const { return HasMet(m) ? met[m] : reference[m]; }

  /// Of this step; what an approaching macro-element moves until it touches is no slip.
  Vec<D> Slip(size_t m) const {
    Vec<D> offset = Offset(m);
    if (L2Norm2(offset) > 0)
      offset = Carried<D>(now->scene.slave, *SlipPoints(m).points, m, offset);
    return now->slip[m] - offset;
  }

  /// Faces and the unknowns of the tool; forces act on faces as those of a master do. The unknowns
  /// have a diagonal whatever touches, where the solver may hold them.
  Coupling CouplingOf(size_t m, bool pushes) const {
    Coupling result;
    pushes = pushes || path.Dofs().Size();
    if (points->area[m] == 0 && !pushes)
      return result;
    Array<int> faces, dofs(path.Dofs());
    for (int s : points->segments[m]) {
      faces.Append(points->pairing->segments[s].slave);
      dofs += shapes->Dofs(faces.Last());
    }
    std::sort(faces.begin(), faces.end());
    std::sort(dofs.begin(), dofs.end());
    dofs.SetSize(std::unique(dofs.begin(), dofs.end()) - dofs.begin());
    result.dofs = dofs;
    result.turning = dofs;
    if (pushes)
      result.masters = faces;
    return result;
  }

  /// Derivatives of what moves with a macro-element, and of its forces under a fixed traction.
  void AddMotion(size_t m, const Vec<D> & traction, Rim rim, MacroRows<D> & rows, BlockSum & sum,
                 LocalHeap & lh) const {
    auto & mean = now->mean[m];
    auto parts = Parts(m, traction);
    AddToolDerivatives<D>(now->scene, *points, m, mean, parts, rim == Rim::moves, rows, lh);
    if (!parts.IsZero())
      AddStiffness(mean.normal, traction, parts.pressure, rows, sum);
    if (!Slides(m))
      return;
    auto & pairs = SlipPoints(m);
    AddToolSlip<D>(now->scene, *pairs.points, pairs.partners, m, rows, lh);
    if (L2Norm2(Offset(m)) > 0)
      SubtractCarried<D>(*shapes, *pairs.points, m, Offset(m), rows, lh);
  }
};
} // namespace

template <int D>
unique_ptr<Kinematics<D>> MakeToolSliding(const ContactSetup & setup, shared_ptr<LACSpace> space,
                                          const ProxyInfo & u, shared_ptr<MacroLaw<D>> law) {
  if (!setup.finite || setup.tied)
    throw Exception("LACContact: a tool in space needs finite=True, and no tied surfaces");
  return make_unique<ToolSliding<D>>(setup, space, u, law);
}

#define INSTANTIATE(D)                                                                             \
  template unique_ptr<Kinematics<D>> MakeToolSliding(const ContactSetup &, shared_ptr<LACSpace>,   \
                                                     const ProxyInfo &, shared_ptr<MacroLaw<D>>);
INSTANTIATE(2)
INSTANTIATE(3)
} // namespace ngslac
