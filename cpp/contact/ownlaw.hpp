// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include "law.hpp"
#include "macrostate.hpp"
#include "place.hpp"
#include <python_comp.hpp>

namespace ngslac {
/// A question to a law in place of the compiled one: if it is tied there is no gap and no slip, and
/// the jump of a scalar field has one component, which all D components of vectors are here.
struct AskedLaw {
  bool tied;
  int components;
};

/// Rows of named tables: what belongs to one macro-element.
template <int D>
class TableRow {
  const NamedNumbers & table;
  size_t m;
  int components;

  const double * Data(const string & name, size_t size) const {
    auto found = table.find(name);
    return found == table.end() ? nullptr : found->second.Data() + size * m;
  }

public:
  TableRow(const NamedNumbers & atable, size_t am, int acomponents)
      : table(atable), m(am), components(acomponents) {}

  bool Has(const string & name) const { return table.count(name); }
  /// 0 where there is none, as the two below.
  double Number(const string & name) const {
    auto * data = Data(name, 1);
    return data ? *data : 0;
  }
  Vec<D> Vector(const string & name) const {
    Vec<D> vector = 0.0;
    if (auto * data = Data(name, components))
      std::copy_n(data, components, &vector(0));
    return vector;
  }
  Mat<D, D> Matrix(const string & name) const {
    Mat<D, D> matrix = 0.0;
    if (auto * data = Data(name, components * components))
      for (int k : Range(components))
        std::copy_n(data + components * k, components, &matrix(k, 0));
    return matrix;
  }
};

/// Throws unless a law has returned a traction, derivatives and its memory, each of its size, and
/// nothing that is unknown.
inline void CheckAnswer(const NamedNumbers & found, const NamedNumbers & kept, size_t macros,
                        const AskedLaw & asked) {
  size_t vector = asked.components, matrix = vector * vector;
  std::map<string, size_t> sizes{{"traction", vector}, {"status", 1},       {"by_gap", vector},
                                 {"by_slip", matrix},  {"by_jump", matrix}, {"by_trial", matrix},
                                 {"by_normal", matrix}};
  for (auto & [name, values] : kept) {
    sizes[name] = values.Size() / max(macros, size_t(1));
    if (!found.count(name))
      throw py::value_error("LACContact: law has not given '" + name +
                            "', which law.kept has: return it each time");
  }
  if (asked.tied)
    sizes.erase("by_gap"), sizes.erase("by_slip");
  if (asked.components < 2)
    sizes.erase("by_normal");
  bool derived = false;
  if (!found.count("traction"))
    throw py::value_error("LACContact: law must return a dict with 'traction', (n, " +
                          ToString(vector) + ") numbers");
  for (auto & [name, values] : found) {
    string known;
    for (auto & [other, size] : sizes)
      known += (known.empty() ? "" : ", ") + other;
    if (!sizes.count(name))
      throw py::value_error("LACContact: law has given '" + name + "', which is none of " + known);
    if (values.Size() != macros * sizes[name])
      throw py::value_error("LACContact: law has given " + ToString(values.Size()) +
                            " numbers as '" + name + "' of " + ToString(macros) +
                            " macro-elements, of which each needs " + ToString(sizes[name]));
    derived = derived || name.starts_with("by_");
  }
  if (!derived)
    throw py::value_error(string("LACContact: law has given no derivative of the traction by what "
                                 "it looks at, such as ") +
                          (asked.tied ? "'by_jump'" : "'by_gap'") + " or 'by_trial'");
}

/// The derivative of a vector that turns with the normal by that.
template <int D>
Mat<D, D> Turn(const Vec<D> & normal, const Vec<D> & vector) {
  return InnerProduct(normal, vector) * Id<D>() - normal * Trans(vector);
}

/// The status for a law that returns none: does the traction act, and grow with slip?
///
/// It slides where it does not grow with slip in the direction of the tangential traction, or in
/// that of the slip, which is another one where friction is anisotropic.
template <int D>
Status StatusOf(const Answer<D> & answer, const Vec<D> & normal, const Vec<D> & slip) {
  double traction = L2Norm(answer.traction), stiffness = L2Norm(answer.by_jump);
  if (traction == 0)
    return Status::open;
  const double small = 1e-10;
  Mat<D, D> across = Id<D>() - normal * Trans(normal);
  Mat<D, D> along = across * Mat<D, D>(answer.by_jump * across);
  double resistance = L2Norm(along);
  auto look = [&](const Vec<D> & way, double least) {
    if (L2Norm(way) > least)
      resistance = min(resistance, -InnerProduct(way, along * way) / L2Norm2(way));
  };
  look(across * answer.traction, small * traction);
  look(across * slip, stiffness > 0 ? small * traction / stiffness : 0);
  return resistance > small * stiffness ? Status::stick : Status::slip;
}

/// Of one macro-element, from the derivatives by the places that a law looks at.
///
/// All but the multiplier are parts of the jump and the normal. A law turns with the body: where it
/// does not, it gives its derivative by the normal with all else fixed. Tied surfaces are closed.
template <int D>
Answer<D> AnswerFrom(const TableRow<D> & found, const TableRow<D> & place, bool tied) {
  Vec<D> n = place.Vector("normal"), jump = place.Vector("jump"), by_gap = found.Vector("by_gap");
  Mat<D, D> by_trial = found.Matrix("by_trial"), by_slip = found.Matrix("by_slip");
  Mat<D, D> by_jump = found.Matrix("by_jump") - place.Number("c") * by_trial;
  Answer<D> answer;
  answer.traction = found.Vector("traction");
  answer.by_multiplier = by_trial;
  answer.by_jump = by_jump + by_slip - by_slip * n * Trans(n) - by_gap * Trans(n);
  answer.by_normal = place.Number("gap") * by_slip - by_gap * Trans(jump);
  if (found.Has("by_normal"))
    answer.by_normal += found.Matrix("by_normal") - by_slip * n * Trans(jump);
  else
    answer.by_normal += Turn(n, answer.traction) - found.Matrix("by_jump") * Turn(n, jump) -
                        by_trial * Turn(n, place.Vector("trial"));
  if (found.Has("status"))
    answer.status = StatusFrom(found.Number("status"));
  else
    answer.status = tied ? Status::stick : StatusOf(answer, n, place.Vector("slip"));
  return answer;
}

/// Throws where a law has returned NaN or an infinite number.
template <int D>
void CheckFinite(const NamedNumbers & found, const NamedNumbers & places, size_t m,
                 const AskedLaw & asked) {
  for (auto & [name, values] : found) {
    size_t size = values.Size() / places.at("area").Size();
    for (double value : values.Range(m * size, (m + 1) * size))
      if (!std::isfinite(value))
        throw Exception("LACContact: law has given " + ToString(value) + " as '" + name +
                        "' where the jump is " +
                        ToString(TableRow<D>(places, m, asked.components).Vector("jump")) +
                        "; it needs a finite answer to any place");
  }
}

/// The answer of a law, checked where there is a partner.
template <int D>
NamedNumbers AnswerTo(const ContactLaw & law, const NamedNumbers & places,
                      const NamedNumbers & kept, const AskedLaw & asked) {
  auto & area = places.at("area");
  auto found = law(places);
  CheckAnswer(found, kept, area.Size(), asked);
  for (size_t m : Range(area))
    if (area[m] > 0)
      CheckFinite<D>(found, places, m, asked);
  return found;
}

/// The answers of a law to places; macro-elements without a partner are open.
template <int D>
Array<Answer<D>> AnswersOf(const ContactLaw & law, const NamedNumbers & places,
                           const NamedNumbers & kept, const AskedLaw & asked) {
  auto & area = places.at("area");
  auto found = AnswerTo<D>(law, places, kept, asked);
  Array<Answer<D>> answers(area.Size());
  for (size_t m : Range(answers))
    if (area[m] > 0)
      answers[m] =
          AnswerFrom<D>({found, m, asked.components}, {places, m, asked.components}, asked.tied);
  return answers;
}

/// The memory after a step; a macro-element without a partner keeps what it remembered.
inline NamedNumbers KeptAfter(FlatArray<double> area, NamedNumbers kept,
                              const NamedNumbers & found) {
  for (auto & [name, values] : kept)
    for (size_t i : Range(values))
      if (area[i * area.Size() / values.Size()] > 0)
        values[i] = found.at(name)[i];
  return kept;
}
} // namespace ngslac
