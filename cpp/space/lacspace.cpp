// SPDX-License-Identifier: LGPL-2.1-or-later
#include "lacspace.hpp"
#include "mesh/boundaries.hpp"
#include <h1lofe.hpp>

namespace ngslac {
namespace {
template <int D>
pair<shared_ptr<DifferentialOperator>, shared_ptr<DifferentialOperator>> ScalarEvaluators() {
  return {make_shared<T_DifferentialOperator<DiffOpId<D>>>(),
          make_shared<T_DifferentialOperator<DiffOpIdBoundary<D>>>()};
}

[[noreturn]] void Refuse(const FESpace & fes, const string & what) {
  throw std::invalid_argument("LACSpace: V, a space of type " + fes.GetClassName() + ", " + what +
                              "; give a vector-valued space such as VectorH1");
}

shared_ptr<FESpace> CheckDisplacement(shared_ptr<FESpace> fes) {
  int dim = fes->GetMeshAccess()->GetDimension();
  auto evaluator = fes->GetEvaluator(BND);
  if (dynamic_pointer_cast<LACSpace>(fes))
    throw std::invalid_argument("LACSpace: V is itself a LACSpace; give the displacement space");
  if (dim < 2)
    throw std::invalid_argument("LACSpace: V lives on a mesh of dimension " + ToString(dim) +
                                "; contact needs a two- or three-dimensional one");
  if (fes->IsComplex())
    Refuse(*fes, "is complex; contact needs real displacements");
  if (!evaluator)
    Refuse(*fes, "has no values on the boundary");
  if (evaluator->Dim() != dim && evaluator->Dim() != 1)
    Refuse(*fes, "has " + ToString(evaluator->Dim()) +
                     " component(s) on the boundary of a mesh in " + ToString(dim) + "D");
  if (fes->GetFlags().GetDefineFlag("interleaved"))
    throw std::invalid_argument(
        "LACSpace: V is a " + fes->GetClassName() +
        " with interleaved=True, whose functions NGSolve evaluates with components of other "
        "vertices (Set of a linear function does not return it); make V without interleaved");
  return fes;
}
} // namespace

LACSpace::LACSpace(shared_ptr<FESpace> adisplacement, const Flags & flags)
    : FESpace(adisplacement->GetMeshAccess(), flags),
      displacement(CheckDisplacement(adisplacement)) {
  type = "lacspace";
  name = "LACSpace";
  order = 0;
  slave = BoundariesOf(*ma, flags.GetNumListFlag("slave"));
  for (double macro : flags.GetNumListFlag("macros"))
    given_macros.Append(int(macro));
  components = int(flags.GetNumFlag("components", displacement->GetEvaluator(BND)->Dim()));
  dimension = displacement->GetDimension() > 1 ? components : 1;
  first_mesh_faces = ma->GetNE(BND);
  SetDefinedOn(BND, slave);

  auto [vol, bnd] = ma->GetDimension() == 2 ? ScalarEvaluators<2>() : ScalarEvaluators<3>();
  if (dimension > 1) {
    vol = make_shared<BlockDifferentialOperator>(vol, dimension);
    bnd = make_shared<BlockDifferentialOperator>(bnd, dimension);
  } else if (components > 1) {
    vol = make_shared<VectorDifferentialOperator>(vol, components);
    bnd = make_shared<VectorDifferentialOperator>(bnd, components);
  }
  evaluator[VOL] = vol; // gives proxies their dimension; there are no dofs inside
  evaluator[BND] = bnd;
}

void LACSpace::Update() {
  static Timer timer("ngslac::LACSpace::Update");
  RegionTimer reg(timer);
  // After a refinement the displacement may not be up to date, if it is no neighbour in a product.
  auto free = displacement->GetFreeDofs();
  size_t known = partition.macro_of_face.Size();
  if (!free || free->Size() != displacement->GetNDof() || (known && known != ma->GetNE(BND))) {
    displacement->Update();
    displacement->FinalizeUpdate();
  }
  FESpace::Update();
  if (given_macros.Size() && ma->GetNE(BND) != first_mesh_faces)
    throw Exception("LACSpace: the partition given by macros does not fit the refined mesh; make a "
                    "new space, or let the space choose the macro-elements");
  if (taken)
    partition = *taken;
  else if (ready)
    partition = *std::exchange(ready, nullopt);
  else
    partition = given_macros.Size() ? CheckedPartition(*displacement, slave, given_macros)
                                    : PartitionBySupports(*displacement, slave);
  SetNDof(partition.nmacros * (dimension > 1 ? 1 : components));
  UpdateCouplingDofArray();
}

shared_ptr<LACSpace> LACSpace::WithComponents(int n) const {
  Flags changed = flags;
  changed.SetFlag("components", double(n));
  auto space = make_shared<LACSpace>(displacement, changed);
  space->ready = partition, space->taken = taken;
  space->Update();
  space->FinalizeUpdate();
  space->ConnectAutoUpdate();
  return space;
}

void LACSpace::UpdateCouplingDofArray() {
  ctofdof.SetSize(GetNDof());
  ctofdof = WIREBASKET_DOF; // multipliers are neither condensed nor preconditioned away
}

void LACSpace::GetDofNrs(ElementId ei, Array<DofId> & dnums) const {
  dnums.SetSize0();
  int macro = ei.VB() == BND && ei.Nr() < partition.macro_of_face.Size()
                  ? partition.macro_of_face[ei.Nr()]
                  : -1;
  if (macro < 0)
    return;
  int n = dimension > 1 ? 1 : components;
  for (int k : Range(n))
    dnums.Append(macro * n + k);
}

FiniteElement & LACSpace::GetFE(ElementId ei, Allocator & alloc) const {
  bool used = ei.VB() == BND && ei.Nr() < partition.macro_of_face.Size() &&
              partition.macro_of_face[ei.Nr()] >= 0;
  FiniteElement * scalar = SwitchET(ma->GetElType(ei), [&](auto et) -> FiniteElement * {
    constexpr auto ET = et.ElementType();
    if constexpr (ET == ET_SEGM || ET == ET_TRIG || ET == ET_QUAD)
      if (used)
        return new (alloc) ScalarFE<ET, 0>;
    return new (alloc) ScalarDummyFE<ET>;
  });
  if (dimension == 1 && components > 1)
    return *new (alloc) VectorFiniteElement(*scalar, components);
  return *scalar;
}
} // namespace ngslac
