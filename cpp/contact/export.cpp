// SPDX-License-Identifier: LGPL-2.1-or-later
#include "argument.hpp"
#include "contactform.hpp"
#include "linear/merge.hpp"
#include "numpy.hpp"

namespace ngslac {
namespace {
using NamedArrays = std::map<string, Numbers<double>>;

NamedNumbers FromDict(const NamedArrays & arrays) {
  NamedNumbers copy;
  for (auto & [name, values] : arrays)
    copy[name] = FromNumPy(values);
  return copy;
}

/// Flat arrays by name.
py::dict ToDict(const NamedNumbers & numbers) {
  py::dict result;
  for (auto & [name, values] : numbers)
    result[name.c_str()] = ToNumPy(values);
  return result;
}

/// The same with a row for each macro-element.
py::dict ToTable(const NamedNumbers & numbers, size_t macros) {
  py::dict result;
  for (auto & [name, values] : numbers) {
    auto flat = ToNumPy(values);
    bool vectors = macros && values.Size() > macros;
    result[name.c_str()] = vectors ? py::object(flat.reshape({int(macros), -1})) : flat;
  }
  return result;
}

/// Number of the field, name, out of the slave, into the master.
using FlowArguments =
    std::tuple<size_t, string, shared_ptr<CoefficientFunction>, shared_ptr<CoefficientFunction>>;

std::vector<Flow> FlowsFrom(const std::vector<FlowArguments> & arguments) {
  std::vector<Flow> flows;
  for (auto & [field, name, out, into] : arguments)
    flows.push_back({field, name, out, into});
  return flows;
}

using Objects = std::map<string, py::object>;

/// Numbers under a name that a law has returned.
Numbers<double> RealNumbers(const string & whose, const py::object & values) {
  auto any = py::array::ensure(values);
  if (any && any.dtype().kind() == 'c')
    throw py::type_error("LACContact: " + whose + " with complex numbers; it must be real");
  if (any && any.dtype().kind() == 'f' && any.itemsize() < 8)
    throw py::type_error("LACContact: " + whose + " in single precision; it must be double");
  if (py::hasattr(values, "mask"))
    throw py::type_error("LACContact: " + whose + " as a masked array; fill it");
  auto numbers = Numbers<double>::ensure(values);
  if (!numbers)
    throw py::type_error("LACContact: " + whose + " = " + Argument<int>::Text(values) +
                         ", which must be an array of numbers");
  return numbers;
}

/// The arrays that a law has returned for all macro-elements.
NamedNumbers FromLaw(py::object found, size_t macros) {
  Objects objects;
  NamedArrays arrays;
  try {
    objects = found.cast<Objects>();
  } catch (py::cast_error &) {
    throw py::type_error("LACContact: law must return a dict of arrays of numbers, not " +
                         Argument<int>::Text(found));
  }
  for (auto & [key, object] : objects) {
    string whose = "law has given '" + key + "'";
    auto & values = arrays[key] = RealNumbers(whose, object);
    if (!values.ndim() || size_t(values.shape(0)) != macros)
      throw py::value_error("LACContact: " + whose + " with the shape " +
                            string(py::str(values.attr("shape"))) + ", which must begin with " +
                            ToString(macros) + ", a row for each macro-element");
  }
  return FromDict(arrays);
}

/// A Python function, called and released under the lock of the interpreter, from any thread.
ContactLaw LawOf(py::object function) {
  if (function.is_none())
    return {};
  auto release = [](py::object * held) {
    py::gil_scoped_acquire lock;
    delete held;
  };
  shared_ptr<py::object> law(new py::object(function), release);
  return [law](const NamedNumbers & places) {
    py::gil_scoped_acquire lock;
    size_t macros = places.at("area").Size();
    return FromLaw((*law)(ToTable(places, macros)), macros);
  };
}
} // namespace

void ExportContact(py::module & m) {
  py::enum_<Side>(m, "Side")
      .value("slave", Side::slave)
      .value("master", Side::master)
      .value("both", Side::both);
  m.def(
      "ProxyPath",
      [](const CoefficientFunction & proxy, const string & name) {
        return ProxyInfo(proxy, name).path;
      },
      py::arg("proxy"), py::arg("name"),
      "Numbers of components that lead from a product space to that of a trial function.");
  py::class_<ContactForm, shared_ptr<ContactForm>>(m, "ContactForm")
      .def(py::init([](shared_ptr<CoefficientFunction> u, shared_ptr<CoefficientFunction> lam,
                       optional<Region> master, shared_ptr<CoefficientFunction> obstacle,
                       shared_ptr<CoefficientFunction> friction,
                       shared_ptr<CoefficientFunction> tresca,
                       shared_ptr<CoefficientFunction> offset, shared_ptr<RigidTool> tool,
                       bool tied, bool bilateral, bool finite, bool edges, double adjust,
                       double maxdist, double penetration, bool active, py::object law,
                       const NamedArrays & kept, const decltype(ContactFields::values) & fields,
                       const decltype(ContactFields::scalars) & scalars,
                       const std::vector<FlowArguments> & flows,
                       const decltype(ContactFields::slopes) & slopes,
                       const decltype(ContactFields::memory) & memory) {
             return ContactForm::Create(ContactSetup{
                 u, lam, master, obstacle, friction, tresca, offset, tool, tied, bilateral, finite,
                 edges, adjust, maxdist, penetration, active, LawOf(law),
                 ContactFields{fields, scalars, FlowsFrom(flows), slopes, memory}, FromDict(kept)});
           }),
           py::kw_only(), py::arg("u").none(false), py::arg("lam").none(false),
           py::arg("master") = nullopt, py::arg("obstacle") = nullptr,
           py::arg("friction") = nullptr, py::arg("tresca") = nullptr, py::arg("offset") = nullptr,
           py::arg("tool") = nullptr, py::arg("tied") = false, py::arg("bilateral") = false,
           py::arg("finite") = false, py::arg("edges") = false, py::arg("adjust") = 0.0,
           py::arg("maxdist") = 0.0, py::arg("penetration") = 0.0, py::arg("active") = true,
           py::arg("law") = py::none(), py::arg("kept") = NamedArrays(),
           py::arg("fields") = py::list(), py::arg("scalars") = py::list(),
           py::arg("flows") = py::list(), py::arg("slopes") = py::dict(),
           py::arg("memory") = py::dict())
      .def(
          "Update",
          [](ContactForm & self, shared_ptr<GridFunction> gf,
             const optional<NamedArrays> & history) {
            auto copy = history ? FromDict(*history) : NamedNumbers();
            py::gil_scoped_release release;
            self.Update(gf, history ? &copy : nullptr);
          },
          py::arg("gf") = nullptr, py::arg("history") = nullopt)
      .def("CheckPaired", &ContactForm::CheckPaired)
      .def(
          "SetStiffness",
          [](ContactForm & self, const BaseMatrix & bulk, double factor) {
            auto diagonal = ScalarDiagonal(bulk);
            self.SetStiffness(FlatVector<>(diagonal.Size(), diagonal.Data()), factor);
          },
          py::arg("bulk"), py::arg("factor") = 1.0, py::call_guard<py::gil_scoped_release>())
      .def(
          "LearnStiffness",
          [](ContactForm & self,
             std::variant<shared_ptr<BilinearForm>, shared_ptr<BaseMatrix>> bulk) {
            if (auto form = std::get_if<shared_ptr<BilinearForm>>(&bulk))
              return self.LearnStiffness(**form);
            auto diagonal = ScalarDiagonal(*std::get<1>(bulk));
            self.LearnStiffness(FlatVector<>(diagonal.Size(), diagonal.Data()));
          },
          py::arg("bulk").none(false), py::call_guard<py::gil_scoped_release>())
      .def("SetConstant", &ContactForm::SetConstant, py::arg("c"))
      .def("Follow", &ContactForm::Follow, py::call_guard<py::gil_scoped_release>())
      .def("AddApply", &ContactForm::AddApply, py::call_guard<py::gil_scoped_release>())
      .def("AssembleLinearization", &ContactForm::AssembleLinearization,
           py::call_guard<py::gil_scoped_release>())
      .def("AssembleStep", &ContactForm::AssembleStep, py::arg("x"), py::arg("residual"),
           py::arg("convex") = false, py::call_guard<py::gil_scoped_release>())
      .def("Softens", &ContactForm::Softens, py::arg("x"), py::call_guard<py::gil_scoped_release>())
      .def("BeginSolve", &ContactForm::BeginSolve)
      .def("Evaluate", &ContactForm::Evaluate, py::call_guard<py::gil_scoped_release>())
      .def("Commit", &ContactForm::Commit, py::call_guard<py::gil_scoped_release>())
      .def("Restore", &ContactForm::Restore)
      .def("History", [](ContactForm & self) { return ToDict(self.GetHistory()); })
      .def("SetHistory", [](ContactForm & self,
                            const NamedArrays & history) { self.SetHistory(FromDict(history)); })
      .def(
          "AddForces",
          [](ContactForm & self, const BaseVector & x, Numbers<double> tractions, BaseVector & y) {
            auto values = View(tractions, tractions.size());
            py::gil_scoped_release release;
            self.AddForces(x, FlatArray<double>(values.Size(), values.Data()), y);
          },
          py::arg("x"), py::arg("tractions"), py::arg("y"))
      .def(
          "Matrix",
          [](ContactForm & self, const BaseVector & x, Numbers<double> tractions,
             Numbers<double> stiffness) -> shared_ptr<BaseMatrix> {
            auto values = View(tractions, tractions.size());
            auto springs = View(stiffness, stiffness.size());
            py::gil_scoped_release release;
            return self.Matrix(x, FlatArray<double>(values.Size(), values.Data()),
                               FlatArray<double>(springs.Size(), springs.Data()));
          },
          py::arg("x"), py::arg("tractions"), py::arg("stiffness"))
      .def(
          "Lean",
          [](ContactForm & self, Numbers<double> vectors) {
            self.Lean(FlatArray<double>(vectors.size(), const_cast<double *>(vectors.data())));
          },
          py::arg("vectors"))
      .def("SetFlowShare", &ContactForm::SetFlowShare, py::arg("share"))
      .def("SetEven", &ContactForm::SetEven, py::arg("even"))
      .def("Close", &ContactForm::Close, py::arg("macros"), py::arg("x"))
      .def("JumpMatrix",
           [](ContactForm & self, Side side) -> shared_ptr<BaseMatrix> {
             return self.JumpMatrix(side);
           })
      .def("JumpNumber", &ContactForm::JumpNumber)
      .def("Table",
           [](ContactForm & self) { return ToTable(self.Table(), self.Space()->NMacros()); })
      .def("Kept", [](ContactForm & self) { return ToTable(self.Kept(), self.Space()->NMacros()); })
      .def("KeepFrom", &ContactForm::KeepFrom, py::arg("other"))
      .def("Resultants",
           [](ContactForm & self) { return ToTable(self.Resultants(), self.Space()->NMacros()); })
      .def("Reevaluate", &ContactForm::Reevaluate, py::call_guard<py::gil_scoped_release>())
      .def("MultiplierDofs",
           [](ContactForm & self) { return ToNumPy(Array<int>(self.MultiplierDofs())); })
      .def("ToolDofs", [](ContactForm & self) { return ToNumPy(Array<int>(self.ToolDofs())); })
      .def("ToolRows", [](ContactForm & self) { return ToNumPy(self.ToolRows()); })
      .def("Segments",
           [](ContactForm & self) {
             auto table = self.Segments();
             return py::make_tuple(ToNumPy(table.values), ToNumPy(table.corners),
                                   ToNumPy(table.first));
           })
      .def("Points", [](ContactForm & self) { return ToNumPy(self.Points()); })
      .def(
          "GapRanges",
          [](ContactForm & self, Numbers<double> x) {
            auto values = View(x, x.size());
            Array<double> table;
            {
              py::gil_scoped_release release;
              table = self.GapRanges(values);
            }
            return ToNumPy(table);
          },
          py::arg("x"))
      .def("Depths", [](ContactForm & self) { return ToNumPy(self.Depths()); })
      .def("Overlaps", [](ContactForm & self) { return ToNumPy(self.Overlaps()); })
      .def_property_readonly("nsegments", &ContactForm::NSegments)
      .def_property_readonly("space", &ContactForm::Space)
      .def_property_readonly("fes", [](ContactForm & self) { return self.U().fes; })
      .def_property_readonly("offset", [](ContactForm & self) { return self.U().offset; })
      .def_property_readonly("scalars", &ContactForm::Scalars)
      .def_property_readonly("lamoffset", [](ContactForm & self) { return self.Lambda().offset; })
      .def_property_readonly("component", [](ContactForm & self) { return self.U().component; })
      .def_property_readonly("paired", &ContactForm::IsPaired)
      .def("SetActive", &ContactForm::SetActive, py::arg("active"))
      .def_property_readonly("active", &ContactForm::IsActive)
      .def_property_readonly("current", &ContactForm::IsCurrent)
      .def_property_readonly(
          "mat", [](ContactForm & self) -> shared_ptr<BaseMatrix> { return self.Mat(); });
  m.def(
      "EquilibrationScale",
      [](const BaseMatrix & bulk, std::vector<shared_ptr<ContactForm>> contacts) {
        auto scale = EquilibrationScale(bulk);
        for (auto & contact : contacts)
          if (!contact)
            throw Exception("EquilibrationScale: None is no contact");
          else
            contact->AddScale(FlatVector<>(scale.Size(), scale.Data()));
        return ToNumPy(scale);
      },
      py::arg("bulk"), py::arg("contacts"));
  m.def(
      "MergeMatrices",
      [](const BaseMatrix & bulk,
         const std::vector<std::variant<shared_ptr<ContactForm>, shared_ptr<BaseMatrix>>> &
             contacts,
         Numbers<double> scale, shared_ptr<BaseMatrix> former) -> shared_ptr<BaseMatrix> {
        Array<shared_ptr<SparseMatrix<double>>> mats;
        for (auto & contact : contacts)
          if (auto form = std::get_if<shared_ptr<ContactForm>>(&contact))
            mats.Append(*form ? (*form)->Mat() : nullptr);
          else
            mats.Append(dynamic_pointer_cast<SparseMatrix<double>>(std::get<1>(contact)));
        if (mats.Contains(nullptr))
          throw Exception("MergeMatrices: a contact matrix must be sparse, real and scalar");
        auto values = View(scale, scale.size());
        py::gil_scoped_release release;
        return MergeMatrices(bulk, mats, values,
                             dynamic_pointer_cast<SparseMatrix<double>>(former));
      },
      py::arg("bulk"), py::arg("contacts"), py::arg("scale"), py::arg("former") = nullptr,
      "diag(scale) (bulk + contacts) diag(scale). Of `former`, merged from the same bulk with the\n"
      "same scale, only rows with contact are written anew, where the graph is the same.");
}
} // namespace ngslac
