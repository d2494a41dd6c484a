// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <bla.hpp>

namespace ngslac {
using namespace ngbla;

/// How a multiplier gives in directions in which the slave's displacements are prescribed.
///
/// There the slave cannot follow, and a constraint would rest on the master alone: singular where
/// that is prescribed, too, unstable where it is coarser. So it sticks elastically in them,
///   c j = - share M lambda,
/// a hundredth of what the surface gives anyhow, while it slips at the same bound. The constraint
/// along the normal stays rigid as long as any free displacement has a part in it.
template <int D>
class Compliance {
  static constexpr double share = 0.01;
  Mat<D, D> fixed; // projection on the directions in which the slave cannot move
  bool rigid;      // without those directions
  bool whole;      // whatever the normal is

public:
  /// `reach`: projection on the directions in which it can; `whole`: all constraints are alike, as
  /// those of tied surfaces
  Compliance(const Mat<3, 3> & reach, bool awhole) {
    double moves = 0;
    for (int k : Range(D)) {
      moves += reach(k, k);
      for (int l : Range(D))
        fixed(k, l) = (k == l) - reach(k, l);
    }
    rigid = moves > D - 0.5;
    whole = awhole || moves < 0.5;
  }

  bool IsRigid() const { return rigid; }

  /// share M
  Mat<D, D> At(const Vec<D> & normal) const {
    if (rigid)
      return Mat<D, D>(0.0);
    if (whole)
      return share * fixed;
    Mat<D, D> across = Across(normal);
    return share * Mat<D, D>(across * Mat<D, D>(fixed * across));
  }

  /// Derivative of  share M lambda  by the normal.
  Mat<D, D> ByNormal(const Vec<D> & normal, const Vec<D> & lambda) const {
    Mat<D, D> result = 0.0;
    if (rigid || whole)
      return result;
    Mat<D, D> across = Across(normal);
    Vec<D> tangential = across * lambda;
    for (int k : Range(D)) {
      Vec<D> turn = 0.0;
      turn(k) = 1;
      Mat<D, D> change = -1 * (turn * Trans(normal) + normal * Trans(turn));
      Vec<D> changed = change * lambda;
      result.Col(k) =
          share * Vec<D>(change * Vec<D>(fixed * tangential) + across * Vec<D>(fixed * changed));
    }
    return result;
  }

private:
  static Mat<D, D> Across(const Vec<D> & normal) { return Id<D>() - normal * Trans(normal); }
};
} // namespace ngslac
