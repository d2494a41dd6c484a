# SPDX-License-Identifier: LGPL-2.1-or-later
"""Linear systems: merged, condensed, factored, iterated, and checked."""
