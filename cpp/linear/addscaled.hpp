// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

namespace ngslac {
/// y += factor * x, written so that it is vectorised.
inline void AddScaled(double factor, const double * __restrict x, double * __restrict y, int n) {
  for (int i = 0; i < n; i++)
    y[i] += factor * x[i];
}
} // namespace ngslac
