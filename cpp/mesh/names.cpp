// SPDX-License-Identifier: LGPL-2.1-or-later
#include "names.hpp"

#include <python_comp.hpp>
#include <set>

namespace ngslac {
namespace py = pybind11;

namespace {
constexpr const char * special = "^$\\.*+?()[]{}|";

std::set<string> NamesOf(const MeshAccess & ma, VorB vb) {
  std::set<string> names;
  for (int i : Range(ma.GetNRegions(vb)))
    names.insert(string(ma.GetMaterial(vb, i)));
  return names;
}

string Escaped(const string & name) {
  string text;
  for (char c : name)
    text += (strchr(special, c) ? "\\" : "") + string(1, c);
  return text;
}

/// The parts between those | that are in no group, no set, and not escaped.
Array<string> Alternatives(const string & pattern) {
  Array<string> parts{""};
  int depth = 0;
  bool escaped = false, set = false;
  for (char c : pattern) {
    if (c == '|' && !escaped && !set && depth == 0) {
      parts.Append("");
      continue;
    }
    parts.Last() += c;
    if (!escaped && !set)
      depth += (c == '(') - (c == ')');
    if (!escaped && (c == '[' || c == ']'))
      set = c == '[';
    escaped = !escaped && c == '\\';
  }
  return parts;
}

/// The same at each |, as in names that hold single parentheses.
Array<string> Pieces(const string & pattern) {
  Array<string> parts{""};
  for (char c : pattern)
    if (c == '|')
      parts.Append("");
    else
      parts.Last() += c;
  return parts;
}

/// The name that is most like an alternative of the pattern; empty if none is.
string Closest(const std::set<string> & names, const string & pattern) {
  auto matcher = py::module_::import("difflib").attr("SequenceMatcher");
  auto lower = [](const string & text) { return py::str(text).attr("lower")(); };
  string closest;
  double most = 0.5;
  for (auto & part : Pieces(pattern))
    for (auto & name : names)
      if (double alike =
              matcher(py::none(), lower(part), lower(name)).attr("ratio")().cast<double>();
          alike > most)
        most = alike, closest = name;
  return closest;
}

string Quoted(const string & name) {
  return "'" + name + "'";
}
} // namespace

string LiteralNames(const MeshAccess & ma, VorB vb, const string & pattern) {
  auto names = NamesOf(ma, vb);
  if (names.count(pattern))
    return Escaped(pattern);
  string text;
  for (auto & part : Pieces(pattern))
    text += "|" + (names.count(part) ? Escaped(part) : part);
  return text.substr(1);
}

Region NamedRegion(shared_ptr<MeshAccess> mesh, VorB vb, const string & pattern) {
  return Region(mesh, vb, LiteralNames(*mesh, vb, pattern));
}

Array<string> Unmatched(shared_ptr<MeshAccess> mesh, VorB vb, const string & pattern) {
  Array<string> unmatched;
  for (auto & part : Alternatives(pattern))
    if (!part.empty() && !Region(mesh, vb, part).Mask().NumSet())
      unmatched.Append(part);
  return unmatched;
}

string NamesInstead(const MeshAccess & ma, VorB vb, const string & pattern) {
  auto names = NamesOf(ma, vb);
  string all;
  for (auto & name : names)
    all += (all.empty() ? "" : ", ") + Quoted(name);
  string closest = Closest(names, pattern);
  if (!closest.empty() && closest != pattern)
    all += "; did you mean " + Quoted(closest) + "?";
  if (pattern.find_first_of(special) != string::npos)
    all +=
        "; patterns are regular expressions, in which . * + ? | ( ) [ ] { } ^ $ are special: put "
        "\\ before those that belong to a name";
  return all;
}
} // namespace ngslac
