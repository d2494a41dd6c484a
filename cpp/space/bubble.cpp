// SPDX-License-Identifier: LGPL-2.1-or-later
#include "bubble.hpp"
#include "mesh/boundaries.hpp"
#include "mesh/faces.hpp"
#include "mesh/names.hpp"

#include <prolongation.hpp>

namespace ngslac {
namespace {
void CheckFlagsForBubbles(const Flags & flags) {
  for (auto name : {"nodal", "nodalp2", "fixedorder", "highest_order_dc", "hoprolongation"})
    if (flags.GetDefineFlag(name))
      throw Exception(string("BubbleVectorH1: the flag '") + name +
                      "' fixes the order of all edges and leaves no place for bubbles");
  if (flags.NumFlagDefined("order_policy"))
    if (auto policy = ORDER_POLICY(int(flags.GetNumFlag("order_policy", 0)));
        policy == CONSTANT_ORDER || policy == NODE_TYPE_ORDER)
      throw Exception("BubbleVectorH1: bubbles need order_policy VARIABLE");
}

BitArray SlaveRegions(shared_ptr<MeshAccess> ma, const Flags & flags) {
  BitArray slave;
  string given;
  if (flags.StringFlagDefined("slave")) {
    string pattern = flags.GetStringFlag("slave");
    slave = NamedRegion(ma, BND, pattern).Mask();
    given = "pattern '" + pattern + "'";
  } else if (flags.NumListFlagDefined("slave")) {
    slave = BoundariesOf(*ma, flags.GetNumListFlag("slave"));
    given = "given region";
  } else
    throw Exception("BubbleVectorH1: say which boundaries get bubbles, slave='...'; there are " +
                    BoundaryNames(Region(ma, BND, true)));
  if (slave.NumSet() == 0)
    throw Exception("BubbleVectorH1: the slave " + given + " matches none of the boundaries " +
                    BoundaryNames(Region(ma, BND, true)));
  return slave;
}

void DocumentSlave(DocInfo & docu) {
  docu.Arg("slave") = "regexpr or Region\n"
                      "  Boundaries whose faces get a bubble, i.e.: slave = 'left|right'";
}
} // namespace

BubbleH1FESpace::BubbleH1FESpace(shared_ptr<MeshAccess> ama, const Flags & flags, bool checkflags)
    : H1HighOrderFESpace(ama, flags) {
  name = "BubbleH1FESpace";
  type = "bubbleh1";
  DefineStringFlag("slave");
  DefineNumListFlag("slave");
  if (checkflags)
    CheckFlags(flags);
  if (ma->GetDimension() < 2)
    throw Exception("BubbleVectorH1: the mesh must be two- or three-dimensional");
  CheckFlagsForBubbles(flags);
  slave = SlaveRegions(ma, flags);
}

DocInfo BubbleH1FESpace::GetDocu() {
  auto docu = H1HighOrderFESpace::GetDocu();
  docu.short_docu = "H1 with a bubble on every face of a slave boundary.";
  DocumentSlave(docu);
  return docu;
}

void BubbleH1FESpace::UpdateDofTables() {
  for (int i : Faces(ma, slave)) {
    auto el = ma->GetElement(ElementId(BND, i));
    // Where the space is not defined, a node must stay without dofs.
    if (ma->GetDimension() == 2) {
      if (auto edge = el.Edges()[0]; used_edge[edge])
        order_edge[edge] = max2(order_edge[edge], TORDER(2));
    } else if (auto face = el.Faces()[0]; used_face[face]) {
      TORDER least = el.GetType() == ET_TRIG ? 3 : 2;
      for (int k : Range(2))
        order_face[face][k] = max2(order_face[face][k], least);
    }
  }
  H1HighOrderFESpace::UpdateDofTables();
}

BubbleVectorH1FESpace::BubbleVectorH1FESpace(shared_ptr<MeshAccess> ama, const Flags & flags,
                                             bool checkflags)
    : VectorH1FESpace(ama, flags, checkflags) {
  type = "bubblevectorh1";
  // VectorH1 has sorted out which flags hold for which component; only the kind of space changes.
  auto plain = std::move(spaces);
  spaces = Array<shared_ptr<FESpace>>();
  prol = make_shared<ngmg::CompoundProlongation>(this);
  all_the_same = true;
  if (low_order_space) {
    Flags loflags = flags;
    loflags.SetFlag("low_order_space", false);
    low_order_space = make_shared<CompoundFESpace>(ma, loflags);
  }
  for (auto & space : plain)
    AddSpace(make_shared<BubbleH1FESpace>(ma, space->GetFlags()));
}

DocInfo BubbleVectorH1FESpace::GetDocu() {
  auto docu = VectorH1FESpace::GetDocu();
  docu.short_docu = "VectorH1 with a bubble on every face of a slave boundary.";
  docu.long_docu =
      R"raw(Local Average Contact needs a displacement basis function within every
macro-element of the slave boundary. This space adds one per slave face where
the order alone has none, and no other: edges get order 2, triangles order 3,
quadrilaterals order 2. The mesh, and the space away from the slave boundary,
stay as they are. In 2D with order >= 2 the space equals VectorH1.

Parameters
----------
mesh : ngsolve.Mesh

Examples
--------
>>> V = BubbleVectorH1(mesh, order=1, slave="slave", dirichlet="bottom")
>>> LACSpace(V, slave="slave").nmacros == len(list(mesh.Boundaries("slave").Elements()))
True
)raw";
  DocumentSlave(docu);
  return docu;
}

static RegisterFESpace<BubbleH1FESpace> init_bubble_h1("bubbleh1");
static RegisterFESpace<BubbleVectorH1FESpace> init_bubble_vector_h1("bubblevectorh1");
} // namespace ngslac
