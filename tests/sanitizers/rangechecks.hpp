/// Range checks of netgen's arrays, tables, vectors and matrices in all that follows.
#pragma once

// Elsewhere the macro also gives a size to views that have none: another layout than in the wheel,
// across calls into it. So it is there only while the check itself is defined.
#define NETGEN_ENABLE_CHECK_RANGE
#include <core/exception.hpp>
#undef NETGEN_ENABLE_CHECK_RANGE

// Views without a size have nothing to compare an index with.
#undef NETGEN_CHECK_RANGE
#define NETGEN_CHECK_RANGE(index, first, next)                                                     \
  if constexpr (requires { bool((index) >= (next)); })                                             \
    ngcore::detail::CheckRange(__FILE__ ":" NETGEN_CORE_NGEXEPTION_STR(__LINE__), index, first, next);

// Compares sizes of operands, and does not compile for such views. An operand that is too short is
// found by the index past its end.
#undef NETGEN_CHECK_SAME
#define NETGEN_CHECK_SAME(a, b)
