#pragma once
#include <python_comp.hpp>

namespace ngslac {
using namespace ngcomp;

/// What users mean by a pattern of boundary names or a region; `name`: of function and argument.
Region BoundaryRegion(shared_ptr<MeshAccess> mesh, const string & name, py::handle given);
/// The same for the side of a contact, which has faces.
Region RegionWithFaces(shared_ptr<MeshAccess> mesh, const string & name, py::handle given);

/// Quoted names, for messages.
string BoundaryNames(const Region & region);

/// The boundaries of a region as flags of spaces hold them, counted from 1, and back.
Array<double> NumbersOf(const Region & region);
BitArray BoundariesOf(const MeshAccess & ma, FlatArray<double> numbers);
} // namespace ngslac
