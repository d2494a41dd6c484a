// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <python_comp.hpp>

namespace ngslac {
using namespace ngcomp;

/// The region that a user's pattern of boundary names, or region, stands for; `name`: of function
/// and argument; `any`: a region may be of any dimension.
Region BoundaryRegion(shared_ptr<MeshAccess> mesh, const string & name, py::handle boundary,
                      bool any = false);
/// The same for boundaries that must have faces, such as the side of a contact.
Region RegionWithFaces(shared_ptr<MeshAccess> mesh, const string & name, py::handle boundary,
                       bool any = false);

/// Quoted names, for messages.
string BoundaryNames(const Region & region);

/// The boundaries of a region as flags of spaces hold them, counted from 1, and back.
Array<double> NumbersOf(const Region & region);
BitArray BoundariesOf(const MeshAccess & ma, FlatArray<double> numbers);
} // namespace ngslac
