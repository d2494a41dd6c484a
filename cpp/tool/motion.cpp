// SPDX-License-Identifier: LGPL-2.1-or-later
#include "motion.hpp"
#include "leaves.hpp"

namespace ngslac {
template <int D>
void Placement<D>::Turn(const Mat<D, D> & by, const Vec<D> & about) {
  turn = Mat<D, D>(by * turn);
  shift = Vec<D>(about + by * (shift - about));
}

template <int D>
bool Placement<D>::operator==(const Placement & other) const {
  return L2Norm2(turn - other.turn) == 0 && L2Norm2(shift - other.shift) == 0;
}

template <int D>
Mat<D, D> Spin(const Vec<3> & axis) {
  Mat<D, D> spin = 0.0;
  double length = D == 2 ? 1 : L2Norm(axis);
  spin(0, 1) = -(D == 2 ? 1 : axis(2)) / length;
  spin(1, 0) = -spin(0, 1);
  if constexpr (D == 3) {
    spin(0, 2) = axis(1) / length, spin(2, 0) = -axis(1) / length;
    spin(1, 2) = -axis(0) / length, spin(2, 1) = axis(0) / length;
  }
  return spin;
}

template <int D>
Mat<D, D> Rotation(double angle, const Vec<3> & axis) {
  Mat<D, D> spin = Spin<D>(axis);
  return Id<D>() + sin(angle) * spin + (1 - cos(angle)) * spin * spin;
}

void CheckParametric(CoefficientFunction & function, const string & name) {
  function.TraverseTree([&](CoefficientFunction & node) {
    if (IsByDomain(node) || (node.InputCoefficientFunctions().Size() == 0 && !IsNumber(node)))
      throw Exception("tool: " + name + " holds '" + NameOf(node) +
                      "'; a rigid motion may depend on numbers and Parameters only");
  });
}

Vec<3> ValuesOf(const CoefficientFunction & function) {
  FE_ElementTransformation<2, 2> reference(ET_TRIG); // of which the function sees nothing
  IntegrationPoint ip;
  MappedIntegrationPoint<2, 2> mip(ip, reference);
  Vec<3> values = 0.0;
  function.Evaluate(mip, FlatVector<>(function.Dimension(), values.Data()));
  if (!isfinite(L2Norm2(values)))
    throw Exception("tool: its motion or load is NaN or infinite");
  return values;
}

template <int D>
Placement<D> Follow(const std::vector<ToolMotion> & motions) {
  Placement<D> place;
  for (auto & motion : motions) {
    if (motion.angle)
      place.Turn(Rotation<D>(ValuesOf(*motion.angle)(0), motion.axis), FirstOf<D>(motion.center));
    if (motion.shift)
      place.Shift(FirstOf<D>(ValuesOf(*motion.shift)));
  }
  return place;
}

template struct Placement<2>;
template struct Placement<3>;
template Mat<2, 2> Spin(const Vec<3> &);
template Mat<3, 3> Spin(const Vec<3> &);
template Mat<2, 2> Rotation(double, const Vec<3> &);
template Mat<3, 3> Rotation(double, const Vec<3> &);
template Placement<2> Follow(const std::vector<ToolMotion> &);
template Placement<3> Follow(const std::vector<ToolMotion> &);
} // namespace ngslac
