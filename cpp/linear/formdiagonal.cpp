// SPDX-License-Identifier: LGPL-2.1-or-later
#include "formdiagonal.hpp"
#include "scatter.hpp"

namespace ngslac {
namespace {
bool ActsOn(const BilinearFormIntegrator & integrator, const Ngs_Element & element) {
  return integrator.VB() == VOL && !integrator.SkeletonForm() &&
         integrator.DefinedOn(element.GetIndex()) && integrator.DefinedOnElement(element.Nr());
}

bool HasOneOf(const BitArray & wanted, FlatArray<DofId> dofs) {
  for (DofId dof : dofs)
    if (IsRegularDof(dof) && wanted.Test(dof))
      return true;
  return false;
}

void AddElement(const BilinearForm & form, const Ngs_Element & element, FlatArray<DofId> dofs,
                Scatter & sum, LocalHeap & lh) {
  auto & space = *form.GetFESpace();
  auto & trafo = space.GetMeshAccess()->GetTrafo(ElementId(element), lh);
  auto & fe = space.GetFE(ElementId(element), lh);
  int block = space.GetDimension(), n = block * dofs.Size();
  FlatVector<> zero(n, lh);
  FlatMatrix<> matrix(n, n, lh);
  zero = 0.0;
  for (auto & integrator : form.Integrators())
    if (ActsOn(*integrator, element)) {
      HeapReset hr(lh);
      integrator->CalcLinearizedElementMatrix(fe, trafo, zero, matrix, lh);
      for (int i : Range(n))
        if (IsRegularDof(dofs[i / block]))
          sum.Add(block * dofs[i / block] + i % block, matrix(i, i));
    }
}
} // namespace

Vector<> FormDiagonal(const BilinearForm & form, const BitArray & wanted) {
  auto & space = *form.GetFESpace();
  auto & mesh = *space.GetMeshAccess();
  Vector<> diagonal(space.GetDimension() * space.GetNDof());
  diagonal = 0.0;
  ScatterInOrder(mesh.GetNE(VOL), diagonal, [&](size_t i, LocalHeap & lh, Scatter & sum) {
    Ngs_Element element = mesh.GetElement(ElementId(VOL, i));
    Array<DofId> dofs;
    space.GetDofNrs(element, dofs);
    if (space.DefinedOn(VOL, element.GetIndex()) && HasOneOf(wanted, dofs))
      AddElement(form, element, dofs, sum, lh);
  });
  return diagonal;
}
} // namespace ngslac
