// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <bla.hpp>

namespace ngslac {
using namespace ngbla;

/// A sum with twice the digits of a number, for small distances from places that are far away.
class Twofold {
  double high = 0, low = 0;

public:
  Twofold() = default;
  explicit Twofold(double value) : high(value) {}

  double Value() const { return high + low; }
  /// The remainder that the value leaves out.
  double Rest() const { return low - (Value() - high); }

  void Add(double a) {
    double sum = high + a, part = sum - high;
    low += (high - (sum - part)) + (a - part);
    high = sum;
  }
  void AddProduct(double a, double b) {
    volatile double rounded = a * b; // once: it must not become a part of a longer instruction
    double product = rounded;
    Add(product);
    low += std::fma(a, b, -product);
  }
  void AddProduct(double a, const Twofold & b) {
    AddProduct(a, b.high);
    low += a * b.low;
  }
  /// Adds a factor times the square.
  void AddSquare(double factor, const Twofold & a) {
    AddProduct(factor * a.high, a.high);
    low += 2 * factor * a.high * a.low;
  }
};

/// The difference of two points, with all its digits.
template <int D>
class Apart {
  Twofold part[D];

public:
  Apart(const Vec<D> & x, const Vec<D> & from) {
    for (int k : Range(D)) {
      part[k] = Twofold(x(k));
      part[k].Add(-from(k));
    }
  }
  Vec<D> Value() const {
    Vec<D> value;
    for (int k : Range(D))
      value(k) = part[k].Value();
    return value;
  }
  Twofold Along(const Vec<D> & direction) const {
    Twofold sum;
    for (int k : Range(D))
      sum.AddProduct(direction(k), part[k]);
    return sum;
  }
  Twofold Square() const {
    Twofold sum;
    for (int k : Range(D))
      sum.AddSquare(1, part[k]);
    return sum;
  }
};
} // namespace ngslac
