#include "jump.hpp"
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
  for (auto op = evaluator; auto inner = dynamic_pointer_cast<CompoundDifferentialOperator>(op);
       op = inner->BaseDiffOp()) {
    auto product = dynamic_pointer_cast<CompoundFESpace>(component);
    if (!product)
      break;
    offset += product->GetRange(inner->Component()).First();
    component = (*product)[inner->Component()];
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
/// Adds  factor * int N  of one face at some points to the row of a macro-element.
template <int D>
void AddFace(const ProxyInfo & u, int element, FlatArray<Vec<D - 1>> points,
             FlatArray<double> weights, Array<JumpEntry<D>> & row, LocalHeap & lh) {
  HeapReset hr(lh);
  ElementId ei(BND, element);
  auto & fel = u.fes->GetFE(ei, lh);
  auto & trafo = u.fes->GetMeshAccess()->GetTrafo(ei, lh);
  int block = u.fes->GetDimension();
  ArrayMem<DofId, 100> dofs;
  u.fes->GetDofNrs(ei, dofs);
  FlatMatrix<double, ColMajor> shape(D, block * dofs.Size(), lh), sum(D, block * dofs.Size(), lh);
  sum = 0;
  IntRange used = u.evaluator->UsedDofs(fel);
  for (int q : Range(points)) {
    HeapReset hr(lh);
    auto ip = ToIntegrationPoint(points[q]);
    u.evaluator->CalcMatrix(fel, trafo(ip, lh), shape, lh);
    sum.Cols(used) += weights[q] * shape.Cols(used);
  }
  for (int j : used)
    if (IsRegularDof(dofs[j / block]) && L2Norm2(sum.Col(j)) > 0)
      row.Append(JumpEntry<D>{block * dofs[j / block] + j % block, Vec<D>(sum.Col(j))});
}

/// Adds what one segment contributes from one of its sides.
template <int D>
void AddSegment(const ProxyInfo & u, const Surface<D> & slave, const Surface<D> * master,
                const Pairing<D> & pairing, int number, Side side, Array<JumpEntry<D>> & row,
                LocalHeap & lh) {
  auto & segment = pairing.segments[number];
  bool onslave = side == Side::slave;
  if (!onslave && segment.master < 0)
    return;
  ArrayMem<Vec<D - 1>, 20> points;
  ArrayMem<double, 20> weights;
  for (auto & p : pairing.points.Range(pairing.Points(number))) {
    points.Append(onslave ? p.slave : p.master);
    weights.Append(onslave ? p.weight : -p.weight);
  }
  int element = onslave ? slave.Element(segment.slave) : master->Element(segment.master);
  AddFace<D>(u, element, points, weights, row, lh);
}

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

/// Sorts by dof and adds up what belongs together.
template <int D>
void Compress(Array<JumpEntry<D>> & row) {
  QuickSort(row, [](auto & a, auto & b) { return a.dof < b.dof; });
  size_t kept = 0;
  for (auto & entry : row)
    if (kept && row[kept - 1].dof == entry.dof)
      row[kept - 1].integral += entry.integral;
    else
      row[kept++] = entry;
  row.SetSize(kept);
}
} // namespace

template <int D>
MacroJump<D>::MacroJump(const ProxyInfo & u, const LACSpace & space, const Surface<D> & slave,
                        const Surface<D> * master, const Pairing<D> & pairing, Side side) {
  static Timer timer("ngslac::MacroJump");
  RegionTimer reg(timer);
  size_t n = space.NMacros();
  area.SetSize(n), fullarea.SetSize(n), normal.SetSize(n), center.SetSize(n), moment.SetSize(n);
  gapvector.SetSize(n);

  TableCreator<int> creator(n);
  for (; !creator.Done(); creator++)
    for (int f : Range(slave.Size()))
      creator.Add(space.MacroOfFace()[slave.Element(f)], f);
  auto faces = creator.MoveTable();
  auto first_segment = FirstSegments(pairing, slave.Size());

  LocalHeap heap(1000 * 1000, "ngslac-jump", true);
  Array<Array<JumpEntry<D>>> parts(4 * TaskManager::GetNumThreads());
  first.SetSize(n + 1);
  first[0] = 0;
  ParallelJob(
      [&](TaskInfo & ti) {
        LocalHeap lh = heap.Split();
        Array<JumpEntry<D>> row;
        for (auto m : IntRange(n).Split(ti.task_nr, ti.ntasks)) {
          row.SetSize0();
          for (int f : faces[m])
            for (int segment : Range(first_segment[f], first_segment[f + 1]))
              for (auto from : {Side::slave, Side::master})
                if (int(side) & int(from))
                  AddSegment(u, slave, master, pairing, segment, from, row, lh);
          Compress(row);
          first[m + 1] = row.Size();
          parts[ti.task_nr] += row;
          Geometry(m, faces[m], slave, pairing, first_segment);
        }
      },
      parts.Size());
  for (size_t m : Range(n))
    first[m + 1] += first[m];
  for (auto & part : parts)
    entries += part;
}

template <int D>
void MacroJump<D>::Geometry(size_t macro, FlatArray<int> faces, const Surface<D> & slave,
                            const Pairing<D> & pairing, FlatArray<int> first_segment) {
  Vec<D> normals = 0.0, gaps = 0.0, centers = 0.0, moments = 0.0;
  double paired = 0, full = 0;
  for (int f : faces) {
    // The area of a curved face is no polynomial: a high order makes its error invisible.
    IntegrationRule rule(slave.Type(f), slave.IsFlat(f) ? D - 1 : 20);
    for (auto & ip : rule) {
      Vec<D> x;
      Mat<D, D - 1> dx;
      slave.Evaluate(f, ReferencePoint<D - 1>(ip), x, dx);
      double w = ip.Weight() * Measure(dx);
      full += w;
      centers += w * x;
      normals += w * slave.Normal(f, dx);
    }
    for (int s : Range(first_segment[f], first_segment[f + 1]))
      for (auto & p : pairing.points.Range(pairing.Points(s))) {
        paired += p.weight;
        gaps -= p.weight * p.gap * p.normal;
        moments += p.weight * slave.Point(f, p.slave);
      }
  }
  fullarea[macro] = full;
  // A sliver of an overlap carries no information, only rounding errors.
  area[macro] = paired > 1e-5 * full ? paired : 0;
  normal[macro] = (1 / L2Norm(normals)) * normals;
  center[macro] = (1 / full) * centers;
  moment[macro] = moments;
  gapvector[macro] = paired > 0 ? Vec<D>((1 / paired) * gaps) : Vec<D>(0.0);
}

template <int D>
Vec<D> MacroJump<D>::Mean(size_t macro, FlatVector<> x) const {
  Vec<D> sum = 0.0;
  for (auto & entry : Row(macro))
    sum += x(entry.dof) * entry.integral;
  return area[macro] > 0 ? Vec<D>((1 / area[macro]) * sum) : Vec<D>(0.0);
}

template class MacroJump<2>;
template class MacroJump<3>;
} // namespace ngslac
