#include "boundaries.hpp"

#include <python_comp.hpp>
#include <regex>
#include <set>

namespace ngslac {
Region PatternRegion(shared_ptr<MeshAccess> mesh, const string & name, const string & pattern) {
  try {
    return Region(mesh, BND, pattern);
  } catch (const std::regex_error & error) {
    throw py::value_error(name + " = '" + pattern + "' is no regular expression: " + error.what());
  }
}

string BoundaryNames(const MeshAccess & ma) {
  std::set<string> names;
  for (auto i : Range(ma.GetNBoundaries()))
    names.insert(string(ma.GetMaterial(BND, i)));
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
