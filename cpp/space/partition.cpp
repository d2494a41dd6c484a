#include "partition.hpp"
#include <queue>

namespace ngslac {
namespace {
constexpr double mean_tolerance = 1e-2; // smallest mean of a basis function, relative to its size
constexpr double bend_cosine = 0.5;     // faces of a macro-element bend by less than 60 degrees

/// What the partition needs to know of the slave surface and of the traces on it.
struct Traces {
  Array<int> faces;         // boundary element numbers
  Array<int> slave_of_face; // inverse of it
  Array<Vec<3>> normals;    // of each slave face, up to a common sign per body
  Table<int> neighbours;    // slave faces that share a vertex
  Table<int> dof_faces;     // slave faces on which the trace of a dof lives
  Array<Vec<3>> dof_mean;   // integral of the trace over (area times its maximum)
  BitArray inner_dofs;      // free, and without a trace on other boundaries
  int dim;
};

/// The trace of one basis function on one face.
struct Trace {
  int dof;
  Vec<3> integral;
  double area, maximum;
};

/// All that is not zero on a face.
Array<Trace> TracesOnFace(const FESpace & fes, ElementId ei, Vec<3> & normal, LocalHeap & lh) {
  HeapReset hr(lh);
  auto ma = fes.GetMeshAccess();
  int dim = ma->GetDimension(), block = fes.GetDimension();
  auto & fel = fes.GetFE(ei, lh);
  auto & trafo = ma->GetTrafo(ei, lh);
  auto & evaluator = *fes.GetEvaluator(BND);
  Array<DofId> dofs;
  fes.GetDofNrs(ei, dofs);
  int n = block * dofs.Size();
  FlatMatrix<double, ColMajor> shape(dim, n, lh);
  FlatMatrix<> integral(n, dim, lh);
  FlatVector<> maximum(n, lh);
  integral = 0, maximum = 0, normal = 0;
  double area = 0;
  IntegrationRule rule(trafo.GetElementType(), max(2, 2 * fel.Order()));
  for (auto & ip : rule) {
    auto & mip = trafo(ip, lh);
    shape = 0;
    evaluator.CalcMatrix(fel, mip, shape, lh);
    area += mip.GetWeight();
    for (int j : Range(n)) {
      integral.Row(j) += mip.GetWeight() * shape.Col(j);
      maximum(j) = max(maximum(j), L2Norm(shape.Col(j)));
    }
    auto nv = dim == 2
                  ? Vec<3>(static_cast<const DimMappedIntegrationPoint<2> &>(mip).GetNV()(0),
                           static_cast<const DimMappedIntegrationPoint<2> &>(mip).GetNV()(1), 0)
                  : static_cast<const DimMappedIntegrationPoint<3> &>(mip).GetNV();
    normal += mip.GetWeight() * nv;
  }
  if (!(area > 0))
    throw Exception("LACSpace: boundary element " + ToString(ei.Nr()) + " of boundary '" +
                    string(ma->GetMaterial(ei)) + "' has area " + ToString(area) +
                    "; repair the mesh, or use a finer one");
  normal /= area;
  Array<Trace> traces;
  for (int j : Range(n)) {
    if (!IsRegularDof(dofs[j / block]) || maximum(j) < 1e-12)
      continue;
    Trace trace{block * dofs[j / block] + j % block, Vec<3>(0.0), area, maximum(j)};
    for (int k : Range(dim))
      trace.integral(k) = integral(j, k);
    traces.Append(trace);
  }
  return traces;
}

Table<int> VertexNeighbours(const MeshAccess & ma, FlatArray<int> faces) {
  TableCreator<int> vertex_creator(ma.GetNV());
  for (; !vertex_creator.Done(); vertex_creator++)
    for (int s : Range(faces))
      for (auto v : ma.GetElement(ElementId(BND, faces[s])).Vertices())
        vertex_creator.Add(v, s);
  auto at_vertex = vertex_creator.MoveTable();
  TableCreator<int> creator(faces.Size());
  for (; !creator.Done(); creator++)
    for (int s : Range(faces))
      for (auto v : ma.GetElement(ElementId(BND, faces[s])).Vertices())
        for (int t : at_vertex[v])
          if (t != s)
            creator.Add(s, t);
  return creator.MoveTable();
}

/// Free dofs, less those of the rim: their support reaches beyond the slave surface.
BitArray InnerDofs(const FESpace & fes, FlatArray<int> faces, FlatArray<int> slave_of_face) {
  auto ma = fes.GetMeshAccess();
  int block = fes.GetDimension();
  BitArray inner(fes.GetNDof() * block), slave_vertex(ma->GetNV());
  inner.Set();
  slave_vertex.Clear();
  if (auto free = fes.GetFreeDofs())
    for (size_t i : Range(fes.GetNDof()))
      if (!free->Test(i))
        for (int k : Range(block))
          inner.Clear(block * i + k);
  for (int f : faces)
    for (auto v : ma->GetElement(ElementId(BND, f)).Vertices())
      slave_vertex.SetBit(v);
  Array<DofId> dofs;
  for (int f : Range(ma->GetNE(BND))) {
    if (slave_of_face[f] >= 0)
      continue;
    bool touches = false;
    for (auto v : ma->GetElement(ElementId(BND, f)).Vertices())
      touches = touches || slave_vertex.Test(v);
    if (!touches)
      continue;
    fes.GetDofNrs(ElementId(BND, f), dofs);
    for (auto d : dofs)
      if (IsRegularDof(d))
        for (int k : Range(block))
          inner.Clear(block * d + k);
  }
  return inner;
}

Traces CollectTraces(const FESpace & fes, const BitArray & boundaries) {
  auto ma = fes.GetMeshAccess();
  Traces tr;
  tr.dim = ma->GetDimension();
  tr.slave_of_face.SetSize(ma->GetNE(BND));
  tr.slave_of_face = -1;
  for (int i : Range(ma->GetNE(BND)))
    if (boundaries.Test(ma->GetElIndex(ElementId(BND, i)))) {
      tr.slave_of_face[i] = tr.faces.Size();
      tr.faces.Append(i);
    }
  tr.neighbours = VertexNeighbours(*ma, tr.faces);
  tr.inner_dofs = InnerDofs(fes, tr.faces, tr.slave_of_face);

  size_t ndof = fes.GetNDof() * fes.GetDimension();
  tr.normals.SetSize(tr.faces.Size());
  Array<Array<Trace>> traces(tr.faces.Size());
  LocalHeap heap(10 * 1000 * 1000, "ngslac-partition", true);
  ParallelForRange(tr.faces.Size(), [&](IntRange range) {
    LocalHeap lh = heap.Split();
    for (auto s : range)
      traces[s] = TracesOnFace(fes, ElementId(BND, tr.faces[s]), tr.normals[s], lh);
  });

  TableCreator<int> creator(ndof);
  for (; !creator.Done(); creator++)
    for (int s : Range(traces))
      for (auto & trace : traces[s])
        creator.Add(trace.dof, s);
  tr.dof_faces = creator.MoveTable();
  Array<double> area(ndof), maximum(ndof);
  tr.dof_mean.SetSize(ndof);
  tr.dof_mean = Vec<3>(0.0), area = 0.0, maximum = 0.0;
  for (auto & face : traces)
    for (auto & trace : face) {
      tr.dof_mean[trace.dof] += trace.integral;
      area[trace.dof] += trace.area;
      maximum[trace.dof] = max(maximum[trace.dof], trace.maximum);
    }
  for (size_t i : Range(ndof))
    if (area[i] > 0)
      tr.dof_mean[i] *= 1 / (area[i] * maximum[i]);
  return tr;
}

/// Does a set of mean values span all directions?
bool Spans(const Traces & tr, FlatArray<int> dofs) {
  Matrix<> gram(tr.dim, tr.dim);
  gram = 0;
  for (int dof : dofs)
    for (int k : Range(tr.dim))
      for (int l : Range(tr.dim))
        gram(k, l) += tr.dof_mean[dof](k) * tr.dof_mean[dof](l);
  Vector<> eigenvalues(tr.dim);
  Matrix<> eigenvectors(tr.dim, tr.dim);
  CalcEigenSystem(gram, eigenvalues, eigenvectors);
  double smallest = eigenvalues(0);
  for (double e : eigenvalues)
    smallest = min(smallest, e);
  return smallest > sqr(mean_tolerance);
}

bool Bends(const Traces & tr, FlatArray<int> faces) {
  for (int s : faces)
    for (int t : faces)
      if (InnerProduct(tr.normals[s], tr.normals[t]) < bend_cosine)
        return true;
  return false;
}

/// The free dofs that share one support.
using Candidate = Array<int>;

FlatArray<int> Support(const Traces & tr, const Candidate & candidate) {
  return tr.dof_faces[candidate[0]];
}

/// All supports on which the free dofs reach every direction.
Array<Candidate> FindCandidates(const Traces & tr) {
  std::map<std::vector<int>, int> index;
  Array<Candidate> all;
  for (size_t dof : Range(tr.dof_faces)) {
    auto faces = tr.dof_faces[dof];
    if (faces.Size() == 0 || !tr.inner_dofs.Test(dof) || L2Norm(tr.dof_mean[dof]) < mean_tolerance)
      continue;
    auto [it, isnew] =
        index.try_emplace(std::vector<int>(faces.begin(), faces.end()), int(all.Size()));
    if (isnew)
      all.Append(Candidate());
    all[it->second].Append(dof);
  }
  Array<Candidate> usable;
  for (auto & c : all)
    if (Spans(tr, c) && !Bends(tr, Support(tr, c)))
      usable.Append(std::move(c));
  return usable;
}

/// Disjoint supports, the smallest first; among equals the one that excludes the fewest others, so
/// that the choice advances from the rim and leaves few gaps.
Array<int> ChooseDisjoint(const Traces & tr, FlatArray<Candidate> candidates) {
  TableCreator<int> creator(tr.faces.Size());
  for (; !creator.Done(); creator++)
    for (int c : Range(candidates))
      for (int s : Support(tr, candidates[c]))
        creator.Add(s, c);
  auto at_face = creator.MoveTable();

  auto conflicts = [&](int c, auto f) {
    for (int s : Support(tr, candidates[c]))
      for (int other : at_face[s])
        if (other != c)
          f(other);
  };
  Array<int> degree(candidates.Size());
  Array<bool> open(candidates.Size());
  using Entry = std::tuple<size_t, int, int>; // number of faces, conflicts, candidate
  std::priority_queue<Entry, std::vector<Entry>, std::greater<Entry>> queue;
  for (int c : Range(candidates)) {
    degree[c] = 0, open[c] = true;
    conflicts(c, [&](int) { degree[c]++; });
    queue.emplace(Support(tr, candidates[c]).Size(), degree[c], c);
  }
  Array<int> chosen;
  while (!queue.empty()) {
    auto [size, deg, c] = queue.top();
    queue.pop();
    if (!open[c] || deg != degree[c])
      continue;
    chosen.Append(c);
    open[c] = false;
    conflicts(c, [&](int excluded) {
      if (!open[excluded])
        return;
      open[excluded] = false;
      conflicts(excluded, [&](int other) {
        if (open[other])
          queue.emplace(Support(tr, candidates[other]).Size(), --degree[other], other);
      });
    });
  }
  return chosen;
}

Vec<3> FaceCenter(const MeshAccess & ma, int face) {
  Vec<3> center = 0.0;
  auto vertices = ma.GetElement(ElementId(BND, face)).Vertices();
  for (auto v : vertices) {
    auto p = ma.GetPoint<3>(v);
    center += 1.0 / vertices.Size() * p;
  }
  return center;
}

[[noreturn]] void ThrowUnstable(const FESpace & fes, const Traces & tr, FlatArray<int> faces) {
  auto ma = fes.GetMeshAccess();
  stringstream text;
  text << "LACSpace: no macro-element can be made of " << faces.Size() << " face(s) of boundary '"
       << ma->GetMaterial(ElementId(BND, tr.faces[faces[0]])) << "', the first at "
       << FaceCenter(*ma, tr.faces[faces[0]])
       << ": no free displacement dof has its whole trace on them, so that the multiplier would be "
          "unstable. Remedy: SplitSlaveFaces(mesh, slave), BubbleVectorH1(mesh, slave=...), a "
          "higher "
          "order, or no Dirichlet condition on the slave faces";
  throw Exception(text.str());
}

/// Faces without a macro-element join the neighbour that is the smallest and does not bend away.
void JoinLeftovers(const FESpace & fes, const Traces & tr, Array<int> & macro,
                   FlatArray<int> sizes) {
  for (bool changed = true; changed;) {
    changed = false;
    for (int s : Range(macro)) {
      if (macro[s] >= 0)
        continue;
      int best = -1;
      for (int t : tr.neighbours[s])
        if (macro[t] >= 0 && InnerProduct(tr.normals[s], tr.normals[t]) > bend_cosine &&
            (best < 0 || sizes[macro[t]] < sizes[best]))
          best = macro[t];
      if (best >= 0) {
        macro[s] = best;
        sizes[best]++;
        changed = true;
      }
    }
  }
  Array<int> lost;
  for (int s : Range(macro))
    if (macro[s] < 0)
      lost.Append(s);
  if (lost.Size())
    ThrowUnstable(fes, tr, lost);
}

/// All free dofs whose trace lives in one macro-element alone.
Array<Array<int>> CoreDofs(const Traces & tr, FlatArray<int> macro, size_t nmacros) {
  Array<Array<int>> cores(nmacros);
  for (size_t dof : Range(tr.dof_faces)) {
    auto faces = tr.dof_faces[dof];
    if (faces.Size() == 0 || !tr.inner_dofs.Test(dof))
      continue;
    bool inside = true;
    for (int s : faces)
      inside = inside && macro[s] == macro[faces[0]];
    if (inside)
      cores[macro[faces[0]]].Append(dof);
  }
  return cores;
}

MacroPartition Finish(const Traces & tr, FlatArray<int> macro, size_t nmacros) {
  MacroPartition partition;
  partition.nmacros = nmacros;
  partition.macro_of_face.SetSize(tr.slave_of_face.Size());
  partition.macro_of_face = -1;
  for (int s : Range(macro))
    partition.macro_of_face[tr.faces[s]] = macro[s];
  partition.cores = CoreDofs(tr, macro, nmacros);
  return partition;
}
} // namespace

MacroPartition PartitionBySupports(const FESpace & displacement, const BitArray & boundaries) {
  static Timer timer("ngslac::PartitionBySupports");
  RegionTimer reg(timer);
  auto tr = CollectTraces(displacement, boundaries);
  auto candidates = FindCandidates(tr);
  auto chosen = ChooseDisjoint(tr, candidates);
  // Number the macro-elements in the order of the mesh: neighbours get close numbers.
  QuickSort(chosen, [&](int a, int b) {
    return Support(tr, candidates[a])[0] < Support(tr, candidates[b])[0];
  });
  Array<int> macro(tr.faces.Size()), sizes(chosen.Size());
  macro = -1;
  for (int m : Range(chosen)) {
    auto faces = Support(tr, candidates[chosen[m]]);
    sizes[m] = faces.Size();
    for (int s : faces)
      macro[s] = m;
  }
  JoinLeftovers(displacement, tr, macro, sizes);
  return Finish(tr, macro, chosen.Size());
}

MacroPartition CheckedPartition(const FESpace & displacement, const BitArray & boundaries,
                                FlatArray<int> macros) {
  auto tr = CollectTraces(displacement, boundaries);
  if (macros.Size() != tr.faces.Size())
    throw Exception("LACSpace: macros has " + ToString(macros.Size()) + " entries, but there are " +
                    ToString(tr.faces.Size()) + " slave faces; give one number per face");
  size_t nmacros = 0;
  for (int m : macros)
    nmacros = max(nmacros, size_t(max(m + 1, 0)));
  Array<Array<int>> faces(nmacros);
  for (int s : Range(macros))
    if (macros[s] >= 0)
      faces[macros[s]].Append(s);
    else
      throw Exception("LACSpace: macros holds the negative number " + ToString(macros[s]));
  auto partition = Finish(tr, macros, nmacros);
  for (size_t m : Range(nmacros)) {
    if (faces[m].Size() == 0)
      throw Exception("LACSpace: macros uses numbers up to " + ToString(nmacros - 1) +
                      ", but macro-element " + ToString(m) + " has no face; number them densely");
    if (!Spans(tr, partition.cores[m]))
      ThrowUnstable(displacement, tr, faces[m]);
  }
  return partition;
}
} // namespace ngslac
