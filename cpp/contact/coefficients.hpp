// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include "pairing/pairing.hpp"
#include "space/lacspace.hpp"

namespace ngslac {
/// Detects when the values of a function may have changed.
///
/// They may if one of its Parameters has another value, and always if it depends on a GridFunction
/// or on a function of the user's own, whose changes nothing reports.
class Watch {
  shared_ptr<CoefficientFunction> function;
  Array<shared_ptr<CoefficientFunction>> parameters;
  Array<double> values;
  bool known = false; // has it been evaluated?
  bool fixed = true;  // does it depend on nothing but Parameters and coordinates?

public:
  explicit Watch(shared_ptr<CoefficientFunction> function); // may be null
  explicit operator bool() const { return function != nullptr; }
  const CoefficientFunction & operator*() const { return *function; }

  /// Makes the next WhereChanged run its function.
  void Forget() { known = false; }
  /// Runs f() if the values may have changed since it last ran without an exception.
  template <typename F>
  void WhereChanged(F f) {
    Array<double> now = Values();
    if (known && fixed && std::equal(now.begin(), now.end(), values.begin()))
      return;
    f();
    values = std::move(now);
    known = true;
  }

private:
  Array<double> Values() const;
};

/// Means of a function over the macro-elements; throws where it is not finite, or less than
/// `least`.
Array<double> MacroMeans(const CoefficientFunction & function, const LACSpace & space,
                         const string & name, double least);

/// Fills the gaps of a pairing with an obstacle from a function on the slave surface.
template <int D>
void SetObstacleGaps(const CoefficientFunction & gap, const MeshAccess & ma,
                     const Surface<D> & slave, Pairing<D> & pairing);
} // namespace ngslac
