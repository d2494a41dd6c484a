// SPDX-License-Identifier: LGPL-2.1-or-later
#include "boundaries.hpp"
#include "argument.hpp"
#include "faces.hpp"
#include "names.hpp"

#include <regex>
#include <set>

namespace ngslac {
namespace {
Region PatternRegion(shared_ptr<MeshAccess> mesh, const string & name, const string & pattern) {
  try {
    return NamedRegion(mesh, BND, pattern);
  } catch (const std::regex_error & error) {
    throw py::value_error(
        name + " = '" + pattern + "' is no regular expression (" + error.what() +
        "), and no name; the boundaries are: " + NamesInstead(*mesh, BND, pattern));
  }
}

string Text(py::handle boundary) {
  return py::isinstance<Region>(boundary) ? "<Region>" : Argument<Region>::Text(boundary);
}

// Of a distributed mesh, some processes may have none.
size_t FacesOfAll(const Region & region) {
  size_t own = Faces(region).Size();
  return region.Mesh()->GetCommunicator().AllReduce(own, NG_MPI_SUM);
}
} // namespace

Region BoundaryRegion(shared_ptr<MeshAccess> mesh, const string & name, py::handle boundary,
                      bool any) {
  if (py::isinstance<py::str>(boundary))
    return PatternRegion(mesh, name, py::cast<string>(boundary));
  string wrong = name + " = " + Text(boundary) +
                 " must be a pattern of boundary names or a boundary region, such as "
                 "mesh.Boundaries(\"...\")";
  if (!py::isinstance<Region>(boundary))
    throw py::type_error(wrong);
  auto region = py::cast<Region>(boundary);
  if (region.VB() != BND && !any)
    throw py::value_error(wrong);
  if (region.Mesh() != mesh)
    throw py::value_error(name + " is a region of another mesh: take one of the same mesh");
  return region;
}

Region RegionWithFaces(shared_ptr<MeshAccess> mesh, const string & name, py::handle boundary,
                       bool any) {
  auto region = BoundaryRegion(mesh, name, boundary, any);
  if (region.VB() == BND && FacesOfAll(region) == 0)
    throw py::value_error(
        name + "=" + Text(boundary) + " matches no boundary face; the boundaries are: " +
        NamesInstead(*mesh, BND,
                     py::isinstance<py::str>(boundary) ? py::cast<string>(boundary) : ""));
  return region;
}

string BoundaryNames(const Region & region) {
  std::set<string> names;
  for (size_t i : Range(region.Mask().Size()))
    if (region.Mask().Test(i))
      names.insert(string(region.Mesh()->GetMaterial(BND, i)));
  string all;
  for (auto & name : names)
    all += (all.empty() ? "'" : ", '") + name + "'";
  return all;
}

Array<double> NumbersOf(const Region & region) {
  Array<double> numbers;
  for (size_t i : Range(region.Mask().Size()))
    if (region.Mask().Test(i))
      numbers.Append(i + 1);
  return numbers;
}

BitArray BoundariesOf(const MeshAccess & ma, FlatArray<double> numbers) {
  BitArray boundaries(ma.GetNBoundaries());
  boundaries.Clear();
  for (double number : numbers)
    if (number >= 1 && number <= boundaries.Size())
      boundaries.SetBit(size_t(number) - 1);
  return boundaries;
}
} // namespace ngslac
