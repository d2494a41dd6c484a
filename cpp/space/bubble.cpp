// SPDX-License-Identifier: LGPL-2.1-or-later
#include "argument.hpp"
#include "mesh/boundaries.hpp"
#include "mesh/faces.hpp"
#include "mesh/names.hpp"

#include <h1hofespace.hpp>
#include <prolongation.hpp>
#include <python_comp.hpp>

namespace ngslac {
using namespace ngcomp;

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
  string wanted;
  if (flags.StringFlagDefined("slave")) {
    string pattern = flags.GetStringFlag("slave");
    slave = NamedRegion(ma, BND, pattern).Mask();
    wanted = "pattern '" + pattern + "'";
  } else if (flags.NumListFlagDefined("slave")) {
    slave = BoundariesOf(*ma, flags.GetNumListFlag("slave"));
    wanted = "given region";
  } else
    throw Exception("BubbleVectorH1: say which boundaries get bubbles, slave='...'; there are " +
                    BoundaryNames(Region(ma, BND, true)));
  if (slave.NumSet() == 0)
    throw Exception("BubbleVectorH1: the slave " + wanted + " matches none of the boundaries " +
                    BoundaryNames(Region(ma, BND, true)));
  return slave;
}

void DocumentSlave(DocInfo & docu) {
  docu.Arg("slave") = "regexpr or Region\n"
                      "  Boundaries whose faces get a bubble, i.e.: slave = 'left|right'";
}
} // namespace

// Scalar H1 with a basis function inside every face of the slave boundary: an edge bubble in 2D, a
// face bubble in 3D. It adds nothing where the order alone gives one.
class BubbleH1FESpace : public H1HighOrderFESpace {
  BitArray slave; // boundary regions

public:
  BubbleH1FESpace(shared_ptr<MeshAccess> ama, const Flags & flags, bool checkflags = false)
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

  string GetClassName() const override { return "BubbleH1FESpace"; }
  static DocInfo GetDocu() {
    auto docu = H1HighOrderFESpace::GetDocu();
    docu.short_docu = "H1 with a bubble on every face of a slave boundary.";
    DocumentSlave(docu);
    return docu;
  }

  Region SlaveRegion() const { return Region(ma, BND, slave); }

  // Every update passes here before it counts the dofs, so a refined mesh gets its bubbles, too.
  void UpdateDofTables() override {
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
};

// VectorH1 with these scalar spaces as its components.
class BubbleVectorH1FESpace : public VectorH1FESpace {
public:
  BubbleVectorH1FESpace(shared_ptr<MeshAccess> ama, const Flags & flags, bool checkflags = false)
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

  string GetClassName() const override { return "BubbleVectorH1FESpace"; }
  static DocInfo GetDocu() {
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

  Region SlaveRegion() const { return static_cast<BubbleH1FESpace &>(*spaces[0]).SlaveRegion(); }
};

static RegisterFESpace<BubbleH1FESpace> init_bubble_h1("bubbleh1");
static RegisterFESpace<BubbleVectorH1FESpace> init_bubble_vector_h1("bubblevectorh1");

namespace {
string Named(const string & name) {
  return "BubbleVectorH1: " + name;
}

void CheckOrder(py::handle order) {
  constexpr long most = 50; // far above what anyone can solve
  string text = Named("order") + " = " + Argument<int>::Text(order) +
                " must be an integer from 1 to " + ToString(most);
  if (!PyLong_Check(order.ptr()) || PyBool_Check(order.ptr()))
    throw py::type_error(text);
  int overflow = 0;
  long number = PyLong_AsLongAndOverflow(order.ptr(), &overflow);
  if (overflow || number < 1 || number > most)
    throw py::value_error(text);
}

bool HoldsIntegers(py::handle value) {
  if (!py::isinstance<py::list>(value) && !py::isinstance<py::tuple>(value))
    return false;
  for (auto item : value)
    if (!PyLong_Check(item.ptr()) || PyBool_Check(item.ptr()))
      return false;
  return true;
}

VorB KindOf(const string & flag) {
  return flag.find("bbbnd") != string::npos  ? BBBND
         : flag.find("bbnd") != string::npos ? BBND
                                             : BND;
}

/// The flags of BubbleVectorH1, where names of boundaries stand for themselves. Throws for flags on
/// which NGSolve crashes, or which it ignores silently.
py::dict CheckedBubbleArguments(const Argument<shared_ptr<MeshAccess>> & mesh,
                                const py::kwargs & flags) {
  auto on = mesh.As(Named("mesh"), "an ngsolve.Mesh");
  py::dict checked;
  for (auto [key, value] : flags) {
    auto name = py::cast<string>(key);
    if (name == "order")
      CheckOrder(value);
    else if (name == "slave")
      RegionWithFaces(on, Named(name), value);
    else if (name.rfind("dirichlet", 0) == 0 && name.find("bbnd") == string::npos)
      if (!value.is_none() && !HoldsIntegers(value)) // numbers of boundaries: NGSolve's own flags
        BoundaryRegion(on, Named(name), value);
    bool pattern = name == "slave" || name.rfind("dirichlet", 0) == 0;
    checked[key] = pattern && py::isinstance<py::str>(value)
                       ? py::cast(LiteralNames(*on, KindOf(name), py::cast<string>(value)))
                       : py::reinterpret_borrow<py::object>(value);
  }
  return checked;
}

/// NGSolve turns only keyword arguments of basic types into flags.
void SetSlaveFlag(py::object slave, Flags * flags, py::list /* info */) {
  if (py::isinstance<py::str>(slave)) {
    flags->SetFlag("slave", py::cast<string>(slave));
    return;
  }
  flags->SetFlag("slave", NumbersOf(py::cast<Region>(slave)));
}
} // namespace

void ExportBubble(py::module & m) {
  auto space = ExportFESpace<BubbleVectorH1FESpace, VectorH1FESpace>(m, "BubbleVectorH1");
  space.def_static("__special_treated_flags__", [] {
    py::dict special = py::type::of<FESpace>().attr("__special_treated_flags__")();
    special["slave"] = py::cpp_function(&SetSlaveFlag);
    return special;
  });
  space.def("__repr__", [](const BubbleVectorH1FESpace & self) {
    return "<BubbleVectorH1: " + ToString(self.GetNDof()) + " dofs, with bubbles on " +
           BoundaryNames(self.SlaveRegion()) + ">";
  });
  py::object make = space.attr("__init__");
  space.attr("__init__") = py::cpp_function(
      [make](py::object self, Argument<shared_ptr<MeshAccess>> mesh, py::kwargs flags) {
        make(self, mesh.value, **CheckedBubbleArguments(mesh, flags));
      },
      py::name("__init__"), py::is_method(space), py::arg("mesh"));
}
} // namespace ngslac
