# SPDX-License-Identifier: LGPL-2.1-or-later
"""One equilibrium: Newton's method with its safeguards, for bulk and contact together."""
