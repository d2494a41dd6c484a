// SPDX-License-Identifier: LGPL-2.1-or-later
#include "traces.hpp"
#include "mesh/areavector.hpp"

namespace ngslac {
namespace {
constexpr double mean_tolerance = 1e-2;   // smallest mean of a basis function, relative to its size
constexpr double normal_tolerance = 1e-1; // least cosine between a normal and what reaches it

/// The trace of one basis function on one face.
struct Trace {
  int dof;
  Vec<3> integral;
  double area, maximum;
  bool along_normal; // has it a fair part in the normal anywhere?
};

struct FaceTraces {
  Array<Trace> traces; // which are not zero
  Vec<3> normal;
};

/// Values of all basis functions of a face, summed up over the points of a rule.
class FaceSums {
  const FESpace & fes;
  ElementId ei;
  int dim, sign, components;
  Array<DofId> dofs;
  Matrix<double, ColMajor> shape;
  Matrix<> integral;
  Vector<> maximum, along;
  Vec<3> normal = 0.0;
  double area = 0;

public:
  FaceSums(const FESpace & afes, const Faces & faces, int face, LocalHeap & lh)
      : fes(afes), ei(faces.Id(face)), dim(afes.GetMeshAccess()->GetDimension()),
        components(afes.GetEvaluator(BND)->Dim()) {
    // Where the outside is unknown, the normals of the mesh are used.
    sign = (dim == 2 ? faces.Outward<2>(face, lh) : faces.Outward<3>(face, lh)) < 0 ? -1 : 1;
    fes.GetDofNrs(ei, dofs);
    int n = fes.GetDimension() * dofs.Size();
    shape.SetSize(components, n), integral.SetSize(n, components), maximum.SetSize(n),
        along.SetSize(n);
    integral = 0, maximum = 0, along = 0;
    AddPoints(lh);
  }

  FaceTraces Result() const {
    FaceTraces result{Array<Trace>(), Vec<3>((1 / L2Norm(normal)) * normal)};
    int block = fes.GetDimension();
    double none = 1e-12 * L2Norm(maximum);
    for (int j : Range(maximum)) {
      if (!IsRegularDof(dofs[j / block]) || maximum(j) <= none)
        continue;
      Trace trace{block * dofs[j / block] + j % block, Vec<3>(0.0), area, maximum(j),
                  along(j) > normal_tolerance * maximum(j)};
      for (int k : Range(components))
        trace.integral(k) = integral(j, k);
      result.traces.Append(trace);
    }
    return result;
  }

private:
  void AddPoints(LocalHeap & lh) {
    HeapReset hr(lh);
    auto & fel = fes.GetFE(ei, lh);
    auto & trafo = fes.GetMeshAccess()->GetTrafo(ei, lh);
    IntegrationRule rule(trafo.GetElementType(), max(2, 2 * fel.Order()));
    for (auto & ip : rule) {
      HeapReset hr(lh);
      auto & mip = trafo(ip, lh);
      shape = 0;
      if (dofs.Size()) // where there are none the element may be of any kind
        fes.GetEvaluator(BND)->CalcMatrix(fel, mip, shape, lh);
      Add(mip);
    }
    if (!(area > 0))
      throw Exception("LACSpace: boundary element " + ToString(ei.Nr()) + " of boundary '" +
                      string(fes.GetMeshAccess()->GetMaterial(ei)) + "' has area " +
                      ToString(area) + "; repair the mesh, or use a finer one");
  }

  /// A scalar counts as a displacement along the first axis, which is its normal everywhere.
  void Add(const BaseMappedIntegrationPoint & mip) {
    Vec<3> n = components == 1 ? Vec<3>(1, 0, 0) : dim == 2 ? Normal<2>(mip) : Normal<3>(mip);
    area += mip.GetWeight();
    normal += mip.GetWeight() * n;
    for (int j : Range(maximum)) {
      integral.Row(j) += mip.GetWeight() * shape.Col(j);
      maximum(j) = max(maximum(j), L2Norm(shape.Col(j)));
      along(j) = max(along(j), fabs(InnerProduct(shape.Col(j), n.Range(0, components))));
    }
  }

  /// The outward unit normal.
  template <int D>
  Vec<3> Normal(const BaseMappedIntegrationPoint & mip) const {
    auto & point = static_cast<const MappedIntegrationPoint<D - 1, D> &>(mip);
    Vec<D> vector = AreaVector(point.GetJacobian());
    Vec<3> n = 0.0;
    for (int k : Range(D))
      n(k) = sign * vector(k) / L2Norm(vector);
    return n;
  }
};

Table<int> VertexNeighbours(const MeshAccess & ma, const Faces & faces) {
  TableCreator<int> vertex_creator(ma.GetNV());
  for (; !vertex_creator.Done(); vertex_creator++)
    for (int s : Range(faces.Size()))
      for (auto v : ma.GetElement(faces.Id(s)).Vertices())
        vertex_creator.Add(v, s);
  auto at_vertex = vertex_creator.MoveTable();
  TableCreator<int> creator(faces.Size());
  for (; !creator.Done(); creator++)
    for (int s : Range(faces.Size()))
      for (auto v : ma.GetElement(faces.Id(s)).Vertices())
        for (int t : at_vertex[v])
          if (t != s)
            creator.Add(s, t);
  auto neighbours = creator.MoveTable();
  for (int s : Range(faces.Size())) // in an order that does not depend on that of the vertices
    QuickSort(neighbours[s]);
  return neighbours;
}

/// The free dofs, scalar by scalar.
BitArray FreeScalars(const FESpace & fes) {
  int block = fes.GetDimension();
  BitArray scalars(fes.GetNDof() * block);
  scalars.Set();
  if (auto free = fes.GetFreeDofs())
    for (size_t i : Range(fes.GetNDof()))
      if (!free->Test(i))
        for (int k : Range(block))
          scalars.Clear(block * i + k);
  return scalars;
}

/// Clears the dofs of the rim: their support reaches beyond the slave surface.
void ClearRim(const FESpace & fes, const Traces & tr, BitArray & dofs_to_clear) {
  auto ma = fes.GetMeshAccess();
  int block = fes.GetDimension();
  BitArray slave_vertex(ma->GetNV());
  slave_vertex.Clear();
  for (int f : tr.faces)
    for (auto v : ma->GetElement(ElementId(BND, f)).Vertices())
      slave_vertex.SetBit(v);
  Array<DofId> dofs;
  for (int f : Range(ma->GetNE(BND))) {
    if (tr.slave_of_face[f] >= 0)
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
          dofs_to_clear.Clear(block * d + k);
  }
}

Array<FaceTraces> AllTraces(const FESpace & fes, const Faces & faces) {
  Array<FaceTraces> all(faces.Size());
  LocalHeap heap(10 * 1000 * 1000, "ngslac-partition", true);
  ParallelForRange(faces.Size(), [&](IntRange range) {
    LocalHeap lh = heap.Split();
    for (auto s : range) {
      HeapReset hr(lh);
      all[s] = FaceSums(fes, faces, s, lh).Result();
    }
  });
  return all;
}

Array<int> NumbersOnSlave(const Faces & faces, size_t all) {
  Array<int> numbers(all);
  numbers = -1;
  for (int s : Range(faces.Size()))
    numbers[faces[s]] = s;
  return numbers;
}

void SetMeans(FlatArray<FaceTraces> all, size_t ndof, Traces & tr) {
  Array<double> area(ndof), maximum(ndof);
  tr.dof_mean.SetSize(ndof);
  tr.dof_mean = Vec<3>(0.0), area = 0.0, maximum = 0.0;
  for (auto & face : all)
    for (auto & trace : face.traces) {
      tr.dof_mean[trace.dof] += trace.integral;
      area[trace.dof] += trace.area;
      maximum[trace.dof] = max(maximum[trace.dof], trace.maximum);
    }
  for (size_t i : Range(ndof))
    if (area[i] > 0)
      tr.dof_mean[i] *= 1 / (area[i] * maximum[i]);
}
} // namespace

void Reach::Add(const Vec<3> & mean) {
  if (L2Norm(mean) >= mean_tolerance)
    gram += mean * Trans(mean);
}

namespace {
/// Orthonormal eigenvectors of the large eigenvalues.
Array<Vec<3>> Directions(const Mat<3, 3> & gram) {
  Matrix<> copy = gram, vectors(3, 3);
  Vector<> values(3);
  CalcEigenSystem(copy, values, vectors);
  Array<Vec<3>> directions;
  for (int i : Range(3))
    if (values(i) > sqr(mean_tolerance))
      directions.Append(Vec<3>(vectors.Row(i)));
  return directions;
}
} // namespace

int Reach::Rank() const {
  return Directions(gram).Size();
}

Mat<3, 3> Reach::Projector() const {
  Mat<3, 3> projector = 0.0;
  for (auto & direction : Directions(gram))
    projector += direction * Trans(direction);
  return projector;
}

bool Reach::Covers(const Reach & other) const {
  Reach both = *this;
  both.Add(other);
  return both.Rank() == Rank();
}

bool Reach::Reaches(const Vec<3> & normal) const {
  return L2Norm(Vec<3>(Projector() * normal)) > normal_tolerance;
}

Traces CollectTraces(const FESpace & fes, const BitArray & boundaries) {
  auto ma = fes.GetMeshAccess();
  Traces tr{Faces(ma, boundaries)};
  tr.dim = ma->GetDimension(), tr.components = fes.GetEvaluator(BND)->Dim();
  tr.slave_of_face = NumbersOnSlave(tr.faces, ma->GetNE(BND));
  tr.neighbours = VertexNeighbours(*ma, tr.faces);
  auto free = FreeScalars(fes);
  tr.inner_dofs = free;
  ClearRim(fes, tr, tr.inner_dofs);

  auto all = AllTraces(fes, tr.faces);
  SetMeans(all, free.Size(), tr);
  TableCreator<int> creator(free.Size());
  for (; !creator.Done(); creator++)
    for (int s : Range(all))
      for (auto & trace : all[s].traces)
        creator.Add(trace.dof, s);
  tr.dof_faces = creator.MoveTable();
  tr.normals.SetSize(all.Size()), tr.reach.SetSize(all.Size()), tr.moves.SetSize(all.Size());
  tr.bare.SetSize(all.Size()), tr.movable.SetSize(all.Size());
  for (int s : Range(all)) {
    tr.normals[s] = all[s].normal;
    tr.bare[s] = all[s].traces.Size() == 0;
    tr.movable[s] = false;
    for (auto & trace : all[s].traces) {
      tr.movable[s] = tr.movable[s] || (trace.along_normal && free.Test(trace.dof));
      if (free.Test(trace.dof))
        tr.moves[s].Add(tr.dof_mean[trace.dof]);
      if (tr.inner_dofs.Test(trace.dof))
        tr.reach[s].Add(tr.dof_mean[trace.dof]);
    }
  }
  return tr;
}
} // namespace ngslac
