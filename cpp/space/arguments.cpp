// SPDX-License-Identifier: LGPL-2.1-or-later
#include "arguments.hpp"
#include "mesh/boundaries.hpp"
#include "numpy.hpp"

namespace ngslac {
namespace {
int IntegerOf(py::handle item) {
  auto index = py::reinterpret_steal<py::object>(PyNumber_Index(item.ptr()));
  if (!index) {
    PyErr_Clear();
    throw py::type_error("LACSpace: macros holds " + Argument<int>::Text(item) +
                         ", which is no integer");
  }
  int overflow = 0;
  long number = PyLong_AsLongAndOverflow(index.ptr(), &overflow);
  if (overflow || number != int(number))
    throw py::value_error("LACSpace: macros holds the number " + Argument<int>::Text(item) +
                          "; number the macro-elements densely from 0");
  return int(number);
}

/// At most so many: an iterable may have no end.
Array<double> Integers(const py::object & macros, size_t most) {
  auto what = "LACSpace: macros = " + Argument<int>::Text(macros);
  py::type_error wrong(what + " must be a list of integers, one per slave face");
  if (py::isinstance<py::str>(macros) || !py::isinstance<py::iterable>(macros))
    throw wrong;
  Array<double> numbers;
  try {
    for (auto item : macros) {
      numbers.Append(IntegerOf(item));
      if (numbers.Size() > most)
        throw py::value_error(what + " has more entries than the mesh has boundary elements; give "
                                     "one number per slave face");
    }
  } catch (const py::error_already_set &) { // in the middle of what seemed to be iterable
    throw wrong;
  }
  if (numbers.Size() == 0)
    throw py::value_error("LACSpace: macros has 0 entries; give one number per slave face, or "
                          "leave it out");
  return numbers;
}
} // namespace

int CheckedComponents(const Argument<int> & components) {
  string name = "LACSpace: components", wanted = "1, 2 or 3";
  if (py::isinstance<py::bool_>(components.value))
    throw py::type_error(name + " = " + components.Text(components.value) + " must be " + wanted);
  int number = components.As(name, wanted);
  if (number < 1 || number > 3)
    throw py::value_error(name + " = " + ToString(number) + " must be " + wanted);
  return number;
}

/// The macro-elements of a distributed mesh, which its surfaces tell.
MacroPartition Distributed(shared_ptr<FESpace> V, py::object slave, py::object macros,
                           py::object axisymmetric) {
  auto [count, numbers] = py::module_::import("ngslac.parallel.space")
                              .attr("MacroElements")(V, slave, macros, axisymmetric)
                              .cast<std::tuple<size_t, Numbers<int>>>();
  MacroPartition partition;
  partition.nmacros = count, partition.macro_of_face = FromNumPy(numbers);
  partition.cores.SetSize(count), partition.reach.SetSize(count);
  partition.reach = Mat<3, 3>(0.0);
  return partition;
}

/// Throws unless a mesh is a half of a section through the axis x = 0.
void CheckHalfPlane(const MeshAccess & mesh) {
  if (mesh.GetDimension() != 2)
    throw py::value_error("LACSpace: axisymmetric=True needs a mesh in 2D, of the half of a "
                          "section with x > 0; this one is in " +
                          ToString(mesh.GetDimension()) + "D");
  double least = 0, size = 0;
  for (size_t v : Range(mesh.GetNV())) {
    double x = mesh.GetPoint<2>(v)(0);
    least = min(least, x), size = max(size, fabs(x));
  }
  if (least < -1e-8 * size)
    throw py::value_error("LACSpace: axisymmetric=True, but the mesh reaches to x = " +
                          ToString(least) + ": the axis is x = 0, and bodies lie at x >= 0");
}

shared_ptr<LACSpace> MakeSpace(shared_ptr<FESpace> displacement, const Flags & flags,
                               optional<MacroPartition> taken) {
  auto space = make_shared<LACSpace>(displacement, flags);
  if (taken)
    space->Take(*taken);
  space->Update();
  space->FinalizeUpdate();
  space->ConnectAutoUpdate();
  return space;
}

shared_ptr<LACSpace> SpaceArguments::Make() const {
  auto V = displacement.As("LACSpace: V", "a displacement space, such as VectorH1(mesh, order=2)");
  auto mesh = V->GetMeshAccess();
  Flags flags;
  optional<MacroPartition> taken;
  if (mesh->GetCommunicator().Size() > 1)
    taken = Distributed(V, slave.value, macros.value, axisymmetric.value);
  auto region = taken ? BoundaryRegion(mesh, "LACSpace: slave", slave.value)
                      : RegionWithFaces(mesh, "LACSpace: slave", slave.value);
  flags.SetFlag("slave", NumbersOf(region));
  if (!macros.IsNone() && !taken)
    flags.SetFlag("macros", Integers(macros.value, mesh->GetNE(BND)));
  if (!components.IsNone())
    flags.SetFlag("components", double(CheckedComponents(components)));
  bool follows = autoupdate.As("LACSpace: autoupdate", "True or False");
  flags.SetFlag("autoupdate", follows || V->DoesAutoUpdate());
  if (axisymmetric.As("LACSpace: axisymmetric", "True or False")) {
    CheckHalfPlane(*mesh);
    flags.SetFlag("axisymmetric");
  }
  return MakeSpace(V, flags, taken);
}
} // namespace ngslac
