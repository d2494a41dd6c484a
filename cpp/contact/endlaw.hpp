// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <bla.hpp>

namespace ngslac {
using namespace ngbla;

/// The points of a macro-element inside of which contact ends, at the last evaluation.
struct EndPoints {
  Array<double> area;  // of each point
  Array<double> gap;   // of each point, with its clearance
  double pressure = 0; // of the multiplier
};

/// The pressure of a macro-element inside of which contact ends: the mean of projections at points,
///   p = sum A_k p_k / A,   p_k = max(0, q - c g_k),
/// with q = p. One multiplier remains, but the pressure goes to where the surfaces meet. It belongs
/// to the potential  sum A_k/(2c) (max(0, p - c g_k)^2 - p^2),  and is exact for a constant
/// pressure, whatever c is.
struct EndPressure {
  double base;          // q
  double mean;          // of the p_k, for which the contact law is
  double by_multiplier; // derivative of the mean
  double c;             // minus the derivative by the gap of a pressed point

  double At(double gap) const { return max(0.0, base - c * gap); }
  bool Presses(double gap) const { return base > c * gap; }

  /// At a multiplier.
  static EndPressure Of(const EndPoints & points, double c) {
    auto [mean, share] = Mean(points, points.pressure, c);
    return {points.pressure, mean, share, c};
  }

private:
  /// Mean pressure, and the share of the area that is pressed.
  static std::pair<double, double> Mean(const EndPoints & points, double q, double c) {
    double sum = 0, pressed = 0, area = 0;
    for (size_t k : Range(points.area)) {
      double p = q - c * points.gap[k];
      area += points.area[k];
      if (p > 0)
        sum += points.area[k] * p, pressed += points.area[k];
    }
    return {sum / area, pressed / area};
  }
};
} // namespace ngslac
