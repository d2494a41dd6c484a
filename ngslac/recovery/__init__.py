# SPDX-License-Identifier: LGPL-2.1-or-later
"""Continuous pressure and traction from the multipliers of macro-elements."""
