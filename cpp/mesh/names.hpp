// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <comp.hpp>

namespace ngslac {
using namespace ngcomp;

/// A pattern of region names. A name in it, as a whole or between two |, stands for itself.
string LiteralNames(const MeshAccess & ma, VorB vb, const string & pattern);

/// The region of a pattern; std::regex_error if it is neither a name nor a regular expression.
Region NamedRegion(shared_ptr<MeshAccess> mesh, VorB vb, const string & pattern);

/// Of the alternatives of a pattern, as NGSolve reads it, those that match no name.
Array<string> Unmatched(shared_ptr<MeshAccess> mesh, VorB vb, const string & pattern);

/// For messages: the existing names, the closest one, and the special characters of patterns.
string NamesInstead(const MeshAccess & ma, VorB vb, const string & pattern);
} // namespace ngslac
