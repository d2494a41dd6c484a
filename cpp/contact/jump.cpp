// SPDX-License-Identifier: LGPL-2.1-or-later
#include "faceshapes.hpp"
#include <symbolicintegrator.hpp>

namespace ngslac {
ProxyInfo::ProxyInfo(const CoefficientFunction & cf, const string & name) {
  auto proxy = dynamic_cast<const ProxyFunction *>(&cf);
  if (!proxy || proxy->IsTestFunction())
    throw Exception("LACContact: " + name +
                    " must be a trial function, such as (u, lam) of "
                    "(u, lam), (v, mu) = X.TnT()");
  fes = component = proxy->GetFESpace();
  evaluator = proxy->TraceEvaluator() ? proxy->TraceEvaluator() : proxy->Evaluator();
  offset = 0;
  auto op = evaluator;
  // No `for`: gcc destroys what its condition declares before the last expression uses it.
  while (auto inner = dynamic_pointer_cast<CompoundDifferentialOperator>(op)) {
    auto product = dynamic_pointer_cast<CompoundFESpace>(component);
    if (!product)
      break;
    if (dynamic_pointer_cast<CompoundFESpaceAllSame>(product)) // with elements of its own kind
      throw Exception("LACContact: " + name +
                      " belongs to a power of a space, such as (V * Q)**2, whose parts NGSolve "
                      "cannot evaluate on their own; make the product of its factors, such as "
                      "V * Q * V * Q");
    path.push_back(inner->Component());
    offset += product->GetRange(inner->Component()).First();
    component = (*product)[inner->Component()];
    op = inner->BaseDiffOp();
  }
  if (!evaluator || !evaluator->SupportsVB(BND))
    throw Exception("LACContact: " + name +
                    " has no values on the boundary; give the displacement "
                    "or the multiplier itself, not a derivative");
}

template <int D>
int ProxyInfo::Order(const Surface<D> & surface) const {
  LocalHeap lh(100 * 1000, "ngslac-order");
  int order = 0;
  for (size_t f : Range(surface.Size())) {
    HeapReset hr(lh);
    order = max(order, component->GetFE(ElementId(BND, surface.Element(f)), lh).Order());
  }
  return order;
}

template int ProxyInfo::Order(const Surface<2> &) const;
template int ProxyInfo::Order(const Surface<3> &) const;

namespace {
/// The integrals of the shape functions over the segments of one macro-element.
template <int D>
class JumpRow {
  const FaceShapes<D> & slave;
  const FaceShapes<D> * master; // null: not wanted
  bool onslave;
  const Pairing<D> & pairing;
  Array<pair<int, int>> partners; // master face and segment
  ArrayMem<double, 50> memory;

public:
  Array<JumpEntry<D>> entries;

  JumpRow(const FaceShapes<D> & aslave, const FaceShapes<D> * amaster, bool aonslave,
          const Pairing<D> & apairing)
      : slave(aslave), master(amaster), onslave(aonslave), pairing(apairing) {}

  void Set(FlatArray<int> faces, FlatArray<int> first_segment, LocalHeap & lh) {
    entries.SetSize0(), partners.SetSize0();
    for (int f : faces) {
      auto segments = Range(first_segment[f], first_segment[f + 1]);
      if (onslave && segments.Size())
        AddFace(slave, f, [&](FlatVector<> sum) {
          for (int s : segments)
            for (auto & p : pairing.points.Range(pairing.Points(s)))
              slave.AddValues(f, p.slave, p.weight, sum, lh);
        });
      if (master)
        for (int s : segments)
          partners.Append(pair(pairing.segments[s].master, s));
    }
    QuickSort(partners);
    for (size_t i = 0, next = 0; i < partners.Size(); i = next) {
      int face = partners[i].first;
      while (next < partners.Size() && partners[next].first == face)
        next++;
      AddFace(*master, face, [&](FlatVector<> sum) {
        for (auto & partner : partners.Range(i, next))
          for (auto & p : pairing.points.Range(pairing.Points(partner.second)))
            master->AddValues(face, p.master, -p.weight, sum, lh);
      });
    }
    Compress();
  }

private:
  template <typename F>
  void AddFace(const FaceShapes<D> & shapes, int face, F integrate) {
    memory.SetSize(shapes.Size(face));
    FlatVector<> sum(memory.Size(), memory.Data());
    sum = 0.0;
    integrate(sum);
    auto dofs = shapes.Dofs(face);
    for (int j : Range(dofs)) {
      Vec<D> integral = 0.0;
      if (shapes.IsPlain(face))
        integral(j % D) = sum(j / D);
      else
        for (int i : Range(sum))
          for (int k : Range(D))
            integral(k) += sum(i) * shapes.Conversion(face)(D * i + k, j);
      if (L2Norm2(integral) > 0)
        entries.Append(JumpEntry<D>{dofs[j], integral});
    }
  }

  /// Sorts by dof and adds up what belongs together.
  void Compress() {
    QuickSort(entries, [](auto & a, auto & b) { return a.dof < b.dof; });
    size_t kept = 0;
    for (auto & entry : entries)
      if (kept && entries[kept - 1].dof == entry.dof)
        entries[kept - 1].integral += entry.integral;
      else
        entries[kept++] = entry;
    entries.SetSize(kept);
  }
};

/// Number of the first segment of each slave face, and one more to close the last.
template <int D>
Array<int> FirstSegments(const Pairing<D> & pairing, int nfaces) {
  Array<int> first(nfaces + 1);
  for (int f = 0, s = 0; f <= nfaces; f++) {
    while (s < int(pairing.Size()) && pairing.segments[s].slave < f)
      s++;
    first[f] = s;
  }
  return first;
}

/// The area of a curved face is no polynomial: a high order makes its error invisible.
const IntegrationRule & AreaRule(ELEMENT_TYPE type, bool flat) {
  constexpr int curved = 20;
  static const IntegrationRule segm[] = {{ET_SEGM, curved}, {ET_SEGM, 1}};
  static const IntegrationRule trig[] = {{ET_TRIG, curved}, {ET_TRIG, 2}};
  static const IntegrationRule quad[] = {{ET_QUAD, curved}, {ET_QUAD, 2}};
  return (type == ET_SEGM ? segm : type == ET_TRIG ? trig : quad)[flat];
}
} // namespace

template <int D>
MacroJump<D>::MacroJump(const LACSpace & space, const Surface<D> & slave,
                        const Pairing<D> & pairing)
    : first_segment(FirstSegments(pairing, slave.Size())) {
  static Timer timer("ngslac::MacroJump");
  RegionTimer reg(timer);
  size_t n = space.NMacros();
  area.SetSize(n), fullarea.SetSize(n), normal.SetSize(n), center.SetSize(n), moment.SetSize(n);
  flatness.SetSize(n), way.SetSize(n);
  TableCreator<int> creator(n);
  for (; !creator.Done(); creator++)
    for (int f : Range(slave.Size()))
      creator.Add(space.MacroOfFace()[slave.Element(f)], f);
  faces = creator.MoveTable();
  ParallelFor(n, [&](size_t m) { Geometry(m, slave, pairing); });
}

template <int D>
template <typename F>
Array<Vec<D>> MacroJump<D>::Means(const Pairing<D> & pairing, F value) const {
  Array<Vec<D>> means(Size());
  ParallelFor(Size(), [&](size_t m) {
    Vec<D> sum = 0.0;
    double paired = 0;
    for (int f : faces[m])
      for (int s : Range(first_segment[f], first_segment[f + 1]))
        for (auto & p : pairing.points.Range(pairing.Points(s))) {
          paired += p.weight;
          sum += p.weight * value(pairing.segments[s].master, p);
        }
    means[m] = paired > 0 ? Vec<D>((1 / paired) * sum) : Vec<D>(0.0);
  });
  return means;
}

template <int D>
Array<Vec<D>> MacroJump<D>::GapVectors(const Pairing<D> & pairing) const {
  return Means(pairing, [](int, const PairPoint<D> & p) { return Vec<D>(-p.gap * p.normal); });
}

template <int D>
Array<Vec<D>> MacroJump<D>::SlaveNormals(const Pairing<D> & pairing) const {
  return Means(pairing, [](int, const PairPoint<D> & p) { return p.normal; });
}

template <int D>
Array<Vec<D>> MacroJump<D>::MasterNormals(const Surface<D> & master,
                                          const Pairing<D> & pairing) const {
  return Means(pairing, [&](int face, const PairPoint<D> & p) {
    Vec<D> y;
    Mat<D, D - 1> dy;
    master.Evaluate(face, p.master, y, dy);
    return master.Normal(face, dy);
  });
}

template <int D>
void MacroJump<D>::SetRows(const ProxyInfo & u, const Surface<D> & slave, const Surface<D> * master,
                           const Pairing<D> & pairing, Side side) {
  static Timer timer("ngslac::MacroJump - rows");
  RegionTimer reg(timer);
  size_t n = Size();
  auto used = pairing.UsedFaces(slave.Size(), &Segment::slave);
  FaceShapes<D> slave_shapes(u, slave, max(1, u.Order(slave)), &used);
  unique_ptr<FaceShapes<D>> master_shapes;
  if (master && side != Side::slave) {
    used = pairing.UsedFaces(master->Size(), &Segment::master);
    master_shapes = make_unique<FaceShapes<D>>(u, *master, max(1, u.Order(*master)), &used);
  }
  LocalHeap heap(1000 * 1000, "ngslac-jump", true);
  Array<Array<JumpEntry<D>>> parts(4 * TaskManager::GetNumThreads());
  first.SetSize(n + 1);
  first[0] = 0;
  auto macros = [&](size_t part) { return IntRange(n).Split(part, parts.Size()); };
  ParallelFor(
      parts.Size(),
      [&](size_t i) {
        LocalHeap lh = heap.Split();
        JumpRow<D> row(slave_shapes, master_shapes.get(), side != Side::master, pairing);
        for (auto m : macros(i)) {
          row.Set(faces[m], first_segment, lh);
          first[m + 1] = row.entries.Size();
          parts[i] += row.entries;
        }
      },
      parts.Size());
  for (size_t m : Range(n))
    first[m + 1] += first[m];
  entries.SetSize(first.Last());
  ParallelFor(parts.Size(), [&](size_t i) {
    if (auto range = macros(i); range.Size())
      entries.Range(first[range.First()], first[range.Next()]) = parts[i];
  });
}

template <int D>
void MacroJump<D>::TakeRows(FlatArray<Array<JumpEntry<D>>> rows) {
  first.SetSize(Size() + 1);
  first[0] = 0;
  entries.SetSize0();
  for (size_t m : Range(rows)) {
    entries += rows[m];
    first[m + 1] = entries.Size();
  }
  number = NextNumber();
}

template <int D>
void MacroJump<D>::Geometry(size_t macro, const Surface<D> & slave, const Pairing<D> & pairing) {
  Vec<D> normals = 0.0, centers = 0.0, moments = 0.0;
  double paired = 0, full = 0;
  for (int f : faces[macro]) {
    for (auto & ip : AreaRule(slave.Type(f), slave.IsFlat(f))) {
      Vec<D> x;
      Mat<D, D - 1> dx;
      slave.Evaluate(f, ReferencePoint<D - 1>(ip), x, dx);
      double w = ip.Weight() * slave.AreaElement(x, dx);
      full += w;
      centers += w * x;
      normals += w * slave.Normal(f, dx);
    }
    for (int s : Range(first_segment[f], first_segment[f + 1]))
      for (auto & p : pairing.points.Range(pairing.Points(s))) {
        paired += p.weight;
        moments += p.weight * (slave.Origin() + slave.Point(f, p.slave));
      }
  }
  fullarea[macro] = full;
  // A sliver of an overlap carries no information, only rounding errors.
  area[macro] = paired > 1e-5 * full ? paired : 0;
  normal[macro] = (1 / L2Norm(normals)) * normals;
  flatness[macro] = L2Norm(normals) / full;
  center[macro] = slave.Origin() + (1 / full) * centers;
  way[macro] = slave.Way((1 / full) * centers);
  moment[macro] = moments;
}

template <int D>
double MacroJump<D>::Compliance(size_t macro, FlatVector<> diagonal) const {
  double sum = 0;
  for (auto & e : Row(macro))
    if (diagonal(e.dof) > 0)
      sum += L2Norm2(e.integral) / (D * diagonal(e.dof));
  return sum;
}

template <int D>
Vec<D> MacroJump<D>::Mean(size_t macro, FlatVector<> x) const {
  Vec<D> sum = 0.0;
  for (auto & entry : Row(macro))
    sum += x(entry.dof) * entry.integral;
  return area[macro] > 0 ? Vec<D>((1 / area[macro]) * sum) : Vec<D>(0.0);
}

template <int D>
shared_ptr<SparseMatrix<double>> MacroJump<D>::AsMatrix(size_t offset, size_t width, int components,
                                                        double factor) const {
  Array<int> rows, cols;
  Array<double> values;
  for (size_t m : Range(Size()))
    for (auto & e : Row(m))
      for (int k : Range(components))
        if (e.integral(k) != 0) {
          rows.Append(components * m + k);
          cols.Append(e.dof - offset);
          values.Append(factor * e.integral(k));
        }
  return make_shared<SparseMatrix<double>>(std::move(
      *SparseMatrixTM<double>::CreateFromCOO(rows, cols, values, components * Size(), width)));
}

template class MacroJump<2>;
template class MacroJump<3>;
} // namespace ngslac
