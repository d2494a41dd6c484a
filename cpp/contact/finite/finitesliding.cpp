// SPDX-License-Identifier: LGPL-2.1-or-later
#include "contact/bodycompliance.hpp"
#include "contact/periods.hpp"
#include "contact/selfcontact.hpp"
#include "facepair.hpp"
#include "movingsliding.hpp"

namespace ngslac {
namespace {
template <int D>
double MeasureAt(const Surface<D> & surface, int face, const PairPoint<D> & p) {
  Vec<D> x;
  Mat<D, D - 1> dx;
  surface.Evaluate(face, p.slave, x, dx);
  return surface.AreaElement(x, dx);
}

/// Makes the weights of a pairing in the current configuration those of areas in the reference one.
template <int D>
void CountReferenceAreas(const Surface<D> & reference, const Surface<D> & current,
                         Pairing<D> & pairing) {
  ParallelFor(pairing.Size(), [&](size_t s) {
    int face = pairing.segments[s].slave;
    for (auto & p : pairing.points.Range(pairing.Points(s)))
      p.weight *= MeasureAt(reference, face, p) / MeasureAt(current, face, p);
  });
  for (auto & r : pairing.rim)
    r.point.weight = MeasureAt(reference, pairing.segments[r.segment].slave, r.point);
}

/// Calls f with the segments of a macro-element, and with the points of each and their old pairs.
template <int D, typename F>
void ForPairs(const MeshScene<D> & now, const MacroPoints<D> & points, size_t m, F f) {
  for (int s : points.segments[m])
    for (auto & p : points.pairing->points.Range(points.pairing->Points(s)))
      f(p, OldPair<D>(now, points.pairing->segments[s], p));
}

/// Integral over a segment of how x + g n - y moves with the functions of both faces.
template <int D>
FlatMatrix<> Motion(const MeshScene<D> & now, const Pairing<D> & pairing, int s,
                    const FacePair<D> & faces, LocalHeap & lh) {
  FlatMatrix<> columns(D, faces.Size(), lh);
  columns = 0.0;
  auto & segment = faces.segment;
  for (auto & p : pairing.points.Range(pairing.Points(s))) {
    HeapReset hr(lh);
    OldPair<D> old(now, segment, p);
    auto on_slave = now.slave_shapes.Calc(segment.slave, p.slave, lh);
    auto on_master = now.master_shapes->Calc(segment.master, p.master, lh);
    auto gradients = Gradients<D>(old.dx, on_slave, lh);
    for (int i : Range(faces.slaves))
      for (int k : Range(D)) {
        columns(k, D * i + k) += p.weight * on_slave.value(i);
        for (int l : Range(D))
          columns(l, D * i + k) -= p.weight * p.gap * old.slave_normal(k) * gradients(i, l);
      }
    for (int i : Range(faces.masters))
      for (int k : Range(D))
        columns(k, D * (faces.slaves + i) + k) -= p.weight * on_master.value(i);
  }
  return columns;
}

/// Adds the second derivative of  - factor n . traction . By  -n_k g_i  the normal turns with
/// function i in direction k; that turns with function j in direction l by
///   n_l (g_j)_k g_i + n_k (g_i)_l g_j - (g_i . g_j) n_k n_l n .
template <int D>
void AddTurns(const Vec<D> & n, FlatMatrixFixWidth<D> g, double factor, const Vec<D> & traction,
              FlatMatrix<> block) {
  double pressing = InnerProduct(n, traction);
  for (int i : Range(g.Height()))
    for (int j : Range(g.Height())) {
      double one = InnerProduct(g.Row(i), traction), other = InnerProduct(g.Row(j), traction);
      double both = InnerProduct(g.Row(i), g.Row(j)) * pressing;
      for (int k : Range(D))
        for (int l : Range(D))
          block(D * i + k, D * j + l) -=
              factor * (n(l) * g(j, k) * one + n(k) * g(i, l) * other - both * n(k) * n(l));
    }
}

/// Two surfaces that are tied, whose slip may have a part along the normal.
///
/// The mean of  x + g n - y  has to vanish: arms g n from the slave to the partners turn with
/// the slave's normals n. Rigid motions of both bodies only turn it, and the tractions do the work
/// of its change: the matrix is symmetric, and where it vanishes moments balance as forces do.
template <int D>
class TieScene : public MeshScene<D> {
public:
  using MeshScene<D>::MeshScene;
  MacroGap<D> MeanOf(size_t m) override {
    double gap = 0;
    Vec<D> normal = 0.0;
    ForPairs(*this, *this->points, m, [&](const PairPoint<D> & p, const OldPair<D> & old) {
      normal += p.weight * old.slave_normal;
      gap += p.weight * (old.gap - InnerProduct(old.slave_normal, old.apart));
    });
    double mean = 1 / this->points->area[m];
    return {mean * gap, mean * normal, Vec<D>(0.0), 0.0};
  }

  void AddForces(size_t m, const MacroTraction<D> & traction, Scatter & y,
                 LocalHeap & lh) const override {
    auto & points = *this->points;
    Vec<D> same = traction.At(this->mean[m].normal);
    for (int s : points.segments[m]) {
      HeapReset hr(lh);
      FacePair<D> faces(this->slave_shapes, this->master_shapes, points.pairing->segments[s], lh);
      auto of_dofs = faces.OfDofs(Motion(*this, *points.pairing, s, faces, lh), lh);
      for (int j : Range(faces.at))
        y.Add(faces.Dof(j), -InnerProduct(same, Vec<D>(of_dofs.Col(j))));
    }
  }

  void AddDerivatives(size_t m, const MacroTraction<D> & traction, Rim, MacroRows<D> & rows,
                      BlockSum &, LocalHeap & lh) const override {
    if (traction.IsZero())
      return;
    auto & points = *this->points;
    Vec<D> same = traction.At(this->mean[m].normal);
    for (int s : points.segments[m]) {
      HeapReset hr(lh);
      auto & segment = points.pairing->segments[s];
      FacePair<D> faces(*this, segment, rows, lh);
      FlatMatrix<> block(faces.Size(), faces.Size(), lh);
      block = 0.0;
      for (auto & p : points.pairing->points.Range(points.pairing->Points(s))) {
        HeapReset hr(lh);
        OldPair<D> old(*this, segment, p);
        auto shapes = this->slave_shapes.Calc(segment.slave, p.slave, lh);
        if (p.gap != 0)
          AddTurns(old.slave_normal, Gradients<D>(old.dx, shapes, lh), p.weight * p.gap, same,
                   block);
      }
      auto by_dofs = faces.BlockOfDofs(block, lh);
      auto slaves = Range(faces.SlaveDofs());
      for (int j : slaves)
        for (int i : slaves)
          rows.stiffness(faces.at[i], rows.TurningPosition(faces.Dof(j))) += by_dofs(i, j);
    }
  }

  Vec<D - 1> Partner(size_t point) const override { return Scene<D>::Partner(point); }
  FlatMatrix<> PartnerMoves(const FacePair<D> & faces, size_t point,
                            LocalHeap & lh) const override {
    return Scene<D>::PartnerMoves(faces, point, lh);
  }

  Vec<D> SlipOf(const SlipPairs<D> & pairs, size_t m) const override {
    auto & points = pairs.points->pairing->points;
    return ngslac::MeanOf(*pairs.points, m, [&](const Segment & segment, size_t i) {
      return OldPair<D>(*this, segment, points[i]).apart;
    });
  }

  void AddSlip(const SlipPairs<D> & pairs, size_t m, MacroRows<D> & rows,
               LocalHeap & lh) const override {
    auto & points = *pairs.points;
    for (int s : points.segments[m]) {
      HeapReset hr(lh);
      FacePair<D> faces(*this, points.pairing->segments[s], rows, lh);
      faces.AddTo(rows.slip, Motion(*this, *points.pairing, s, faces, lh), 1 / points.area[m], lh);
    }
  }

  /// Of a traction at the ends of the arms.
  pair<Vec<D>, Vec<3>> Resultant(size_t m, const MacroTraction<D> & traction) const override {
    Vec<D> arm = 0.0, same = traction.At(this->mean[m].normal);
    ForPairs(*this, *this->points, m, [&](const PairPoint<D> & p, const OldPair<D> & old) {
      arm += p.weight * (this->slave.Origin() + old.x + old.gap * old.slave_normal);
    });
    return {this->points->area[m] * same, Moment(arm, same)};
  }
};

/// Two surfaces.
template <int D>
class FiniteSliding : public MovingSliding<D> {
  using Base = MovingSliding<D>;
  using Base::accepted, Base::finder, Base::law, Base::now, Base::points, Base::setup,
      Base::slave_reference, Base::slave_shapes, Base::space, Base::surfaces, Base::u;

  unique_ptr<Surface<D>> master_reference;
  unique_ptr<FaceShapes<D>> master_shapes;
  Periods<D> periods;
  Array<int> along;             // macro-elements, for self-contact
  Meeting first = Meeting::now; // of the pairing of the start
  double share = 0.5;           // of the master in the stiffness of both bodies

public:
  using Base::Base;

  void LearnStiffness(FlatVector<> diagonal) override {
    if (!finder.IsSelfContact() && !setup.tied)
      share = MasterShare<D>(u, {*slave_shapes, *slave_reference},
                             {*master_shapes, *master_reference}, diagonal);
  }

  void Exchange(History & history) override {
    Base::Exchange(history);
    if (!setup.tied)
      history.Exchange("share", share);
  }

protected:
  void Begin(FlatVector<>, Meeting meeting) override {
    first = meeting;
    master_reference = finder.Master(nullptr);
    master_shapes = make_unique<FaceShapes<D>>(u, *master_reference, master_reference->Degree());
    periods = Periods<D>(u, *slave_reference, *master_reference, !setup.tied);
    Pairing<D> none;
    none.segments.Append(Segment{-1, -1, 0, 0});
    this->fullarea = MacroJump<D>(*space, *slave_reference, none).fullarea;
    if (finder.IsSelfContact())
      along = AlongSurface(*space);
  }

  optional<Paired<D>> PairAt(FlatVector<> x) override {
    auto slave = make_unique<Surface<D>>(slave_shapes->Displaced(*slave_reference, x));
    auto master = make_unique<Surface<D>>(master_shapes->Displaced(*master_reference, x));
    if (periods.Find(*slave, *master))
      AddImages(*master);
    auto margin = law->Margin();
    auto closed = finder.IsSelfContact() ? Closed(x) : BitArray(0);
    if (IsPairedIn(*slave, *master) && margin == surfaces.margin && closed == surfaces.closed)
      return nullopt;
    slave->CheckFinite();
    master->CheckFinite();
    auto paired =
        finder.Pair(std::move(slave), std::move(master), margin, points ? Meeting::later : first);
    paired.closed = closed;
    if (finder.IsSelfContact())
      KeepOneSide<D>(*paired.pairing, *paired.slave, *paired.master, *space, along, closed);
    CountReferenceAreas(*slave_reference, *paired.slave, *paired.pairing);
    return paired;
  }

  shared_ptr<Scene<D>> SceneAt(FlatVector<> x) override {
    auto make = [&](auto type, double weight) -> shared_ptr<Scene<D>> {
      return make_shared<typename decltype(type)::element_type>(
          *slave_shapes, *master_shapes, *slave_reference, *master_reference, weight, x, points);
    };
    return setup.tied ? make(shared_ptr<TieScene<D>>(), 0)
                      : make(shared_ptr<MeshScene<D>>(), share);
  }

private:
  /// To the master in all configurations, so that its faces have the same numbers.
  void AddImages(Surface<D> & master) {
    periods.Complete(master);
    periods.Complete(*master_reference, master_shapes.get());
    for (auto & scene : {now, accepted.scene})
      if (scene)
        periods.Complete(static_cast<MeshScene<D> &>(*scene).master);
    for (auto & kept : {surfaces.master, accepted.surfaces.master})
      if (kept)
        periods.Complete(*kept);
  }

  bool IsPairedIn(const Surface<D> & slave, const Surface<D> & master) const {
    return surfaces.jump && surfaces.slave->HasShapeOf(slave) &&
           surfaces.master->HasShapeOf(master);
  }

  BitArray Closed(FlatVector<> x) const {
    BitArray closed(space->NMacros());
    closed.Clear();
    for (size_t m : Range(law->dofs.Size() / D))
      if (L2Norm2(law->Multiplier(m, x)) > 0)
        closed.SetBit(m);
    return closed;
  }
};
} // namespace

template <int D>
unique_ptr<Kinematics<D>> MakeFiniteSliding(const KinematicsParts<D> & parts) {
  return make_unique<FiniteSliding<D>>(parts);
}

template unique_ptr<Kinematics<2>> MakeFiniteSliding(const KinematicsParts<2> &);
template unique_ptr<Kinematics<3>> MakeFiniteSliding(const KinematicsParts<3> &);
} // namespace ngslac
