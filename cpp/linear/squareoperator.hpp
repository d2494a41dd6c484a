// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <la.hpp>

namespace ngslac {
using namespace ngla;

/// A real square matrix that is known by its products; derived classes define one of Mult, MultAdd.
class SquareOperator : public BaseMatrix {
public:
  /// With vectors of the same kind as another one.
  explicit SquareOperator(const BaseMatrix & other)
      : size(other.VHeight()), format(other.RowFormat()) {}

  bool IsComplex() const override { return false; }
  int VHeight() const override { return size; }
  int VWidth() const override { return size; }
  VecFormat RowFormat() const override { return format; }
  VecFormat ColFormat() const override { return format; }

private:
  int size;
  VecFormat format;
};
} // namespace ngslac
