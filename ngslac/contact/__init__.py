# SPDX-License-Identifier: LGPL-2.1-or-later
"""The contact condition of two surfaces, and its results."""
