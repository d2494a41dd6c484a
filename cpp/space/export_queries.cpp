// SPDX-License-Identifier: LGPL-2.1-or-later
#include "numpy.hpp"

#include <python_comp.hpp>

namespace ngslac {
/// A number that differs, all but surely, for spaces that number the dofs of their elements, volume
/// and boundary, in different ways: the hash of Fowler, Noll and Vo, over numbers in place of
/// bytes.
static size_t DofFingerprint(const FESpace & space) {
  size_t hash = 14695981039346656037u;
  auto add = [&](size_t number) { hash = (hash ^ number) * 1099511628211u; };
  add(space.GetNDof());
  add(space.GetDimension());
  Array<DofId> dofs;
  for (auto vb : {VOL, BND})
    for (auto element : space.GetMeshAccess()->Elements(vb)) {
      space.GetDofNrs(element, dofs);
      add(dofs.Size());
      for (auto dof : dofs)
        add(size_t(dof));
    }
  return hash;
}

static bool HoldsProxy(CoefficientFunction & function) {
  bool holds = false;
  function.TraverseTree(
      [&](CoefficientFunction & part) { holds = holds || dynamic_cast<ProxyFunction *>(&part); });
  return holds;
}

static bool HoldsGridFunction(CoefficientFunction & function) {
  bool holds = false;
  function.TraverseTree([&](CoefficientFunction & part) {
    holds = holds || dynamic_cast<GridFunctionCoefficientFunction *>(&part);
  });
  return holds;
}

/// Vertices of each boundary element, -1 behind the last.
static py::array_t<int> BoundaryVertices(const MeshAccess & ma) {
  constexpr int most = 4;
  py::array_t<int> table({int(ma.GetNE(BND)), most});
  auto entries = table.mutable_unchecked<2>();
  for (size_t f : Range(ma.GetNE(BND))) {
    auto vertices = ma.GetElement(ElementId(BND, f)).Vertices();
    for (size_t k : Range(most))
      entries(f, k) = k < vertices.Size() ? int(vertices[k]) : -1;
  }
  return table;
}

/// Dofs of a space on each vertex, -1 behind the last.
static py::array_t<int> VertexDofs(const FESpace & fes) {
  size_t count = fes.GetMeshAccess()->GetNV(), most = 0;
  Array<DofId> dofs;
  auto get = [&](size_t v) {
    fes.GetDofNrs(NodeId(NT_VERTEX, v), dofs);
    size_t regular = 0;
    for (auto dof : dofs)
      if (IsRegularDof(dof))
        dofs[regular++] = dof;
    dofs.SetSize(regular);
    return regular;
  };
  for (size_t v : Range(count))
    most = max(most, get(v));
  py::array_t<int> table({count, most});
  auto entries = table.mutable_unchecked<2>();
  for (size_t v : Range(count)) {
    get(v);
    for (size_t k : Range(most))
      entries(v, k) = k < dofs.Size() ? int(dofs[k]) : -1;
  }
  return table;
}

/// Numbers of dofs of all volume elements, and these; those that are none have negative numbers.
static py::tuple ElementDofs(const FESpace & fes) {
  Array<int> counts, all;
  Array<DofId> dofs;
  for (size_t i : Range(fes.GetMeshAccess()->GetNE(VOL))) {
    fes.GetDofNrs(ElementId(VOL, i), dofs);
    counts.Append(int(dofs.Size()));
    for (auto dof : dofs)
      all.Append(int(dof));
  }
  return py::make_tuple(ToNumPy(counts), ToNumPy(all));
}

/// Data of spaces, forms and functions of NGSolve that their Python classes do not show.
void ExportQueries(py::module & m) {
  m.def("DofFingerprint", &DofFingerprint, py::arg("fes"),
        "A number that differs for spaces that number the dofs of their elements in different "
        "ways.");

  m.def(
      "IsAssembled", [](LinearForm & form) { return form.IsAssembled(); }, py::arg("form"),
      "Was a LinearForm ever assembled?");

  m.def("HoldsProxy", &HoldsProxy, py::arg("function"),
        "Does a function hold a trial or test function, which has no values?");

  m.def("HoldsGridFunction", &HoldsGridFunction, py::arg("function"),
        "Does a function hold a GridFunction?");

  m.def("VertexDofs", &VertexDofs, py::arg("fes"),
        "Dofs (nv, k) of a space on each vertex of the mesh, -1 behind the last.");

  m.def("ElementDofs", &ElementDofs, py::arg("fes"),
        "How many dofs each volume element has, and these one after the other; negative: none.");

  m.def("BoundaryVertices", &BoundaryVertices, py::arg("mesh"),
        "Vertices (n, 4) of the boundary elements of a mesh, -1 behind the last of each.");
}
} // namespace ngslac
