// SPDX-License-Identifier: LGPL-2.1-or-later
#include "boundaries.hpp"
#include "names.hpp"
#include "numpy.hpp"
#include "piece.hpp"
#include "split.hpp"

namespace ngslac {
namespace {
template <typename T>
Numbers<T> Table(const Matrix<T> & matrix) {
  Numbers<T> numbers({matrix.Height(), matrix.Width()});
  std::copy_n(matrix.Data(), matrix.Height() * matrix.Width(), numbers.mutable_data());
  return numbers;
}

template <typename T>
Matrix<T> FromTable(const py::handle & table) {
  auto numbers = table.cast<Numbers<T>>();
  Matrix<T> matrix(numbers.shape(0), numbers.shape(1));
  std::copy_n(numbers.data(), numbers.size(), matrix.Data());
  return matrix;
}

py::tuple ToTuple(const MeshPiece & piece) {
  return py::make_tuple(Table(piece.point_numbers), Table(piece.points), Table(piece.volumes),
                        Table(piece.surfaces), Table(piece.surface_parameters),
                        Table(piece.segments), Table(piece.segment_parameters));
}

MeshPiece FromTuple(const py::tuple & parts) {
  MeshPiece piece;
  piece.point_numbers = FromTable<int>(parts[0]), piece.points = FromTable<double>(parts[1]);
  piece.volumes = FromTable<int>(parts[2]);
  piece.surfaces = FromTable<int>(parts[3]);
  piece.surface_parameters = FromTable<double>(parts[4]);
  piece.segments = FromTable<int>(parts[5]);
  piece.segment_parameters = FromTable<double>(parts[6]);
  return piece;
}
} // namespace

void ExportMesh(py::module & m) {
  m.def(
      "RegionWithFaces",
      [](shared_ptr<MeshAccess> mesh, const string & name, py::object boundary, bool any) {
        return RegionWithFaces(mesh, name, boundary, any);
      },
      py::arg("mesh"), py::arg("name"), py::arg("boundary"), py::arg("any") = false,
      "The boundary region that a pattern or a Region stands for; raises where it has no faces. "
      "any: a Region may be of any dimension");
  m.def(
      "Unmatched",
      [](shared_ptr<MeshAccess> mesh, VorB vb, const string & pattern) {
        return Unmatched(mesh, vb, pattern);
      },
      py::arg("mesh"), py::arg("vb"), py::arg("pattern"),
      "Of the alternatives of a pattern those that match no name");
  m.def(
      "NamesInstead",
      [](shared_ptr<MeshAccess> mesh, VorB vb, const string & pattern) {
        return NamesInstead(*mesh, vb, pattern);
      },
      py::arg("mesh"), py::arg("vb"), py::arg("pattern"),
      "The names that there are, the closest one, and what is special in patterns, for messages");
  m.def(
      "SplitSlaveFaces",
      [](shared_ptr<MeshAccess> mesh, const Region & slave, const string & hexes) {
        return SplitSlaveFaces(mesh, slave, hexes);
      },
      py::arg("mesh"), py::arg("slave"), py::arg("hexes") = "pyramids",
      "New mesh with the slave faces split; see ngslac.SplitSlaveFaces");
  m.def(
      "PieceOf", [](shared_ptr<MeshAccess> mesh) { return ToTuple(PieceOf(*mesh)); },
      py::arg("mesh"), "What this process has of a distributed mesh, as seven tables");
  m.def(
      "WholeMesh",
      [](shared_ptr<MeshAccess> empty, const py::tuple & parts) {
        return WholeMesh(*empty, FromTuple(parts));
      },
      py::arg("empty"), py::arg("parts"),
      "The mesh of all pieces, whose tables are stacked, on a process that has no elements");
}
} // namespace ngslac
