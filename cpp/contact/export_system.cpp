// SPDX-License-Identifier: LGPL-2.1-or-later
#include "contactform.hpp"
#include "linear/merge.hpp"
#include "numpy.hpp"

namespace ngslac {
/// Of the bulk's matrix with those of contacts.
void ExportSystem(py::module & m) {
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
