#pragma once
#include <comp.hpp>

namespace ngslac {
using namespace ngcomp;

/// The boundaries that a pattern matches; `name`: of function and argument.
Region PatternRegion(shared_ptr<MeshAccess> mesh, const string & name, const string & pattern);

/// Quoted names of all boundaries, for messages.
string BoundaryNames(const MeshAccess & ma);

/// The boundaries of a region as flags of spaces hold them, counted from 1, and back.
Array<double> NumbersOf(const Region & region);
BitArray BoundariesOf(const MeshAccess & ma, FlatArray<double> numbers);
} // namespace ngslac
