# SPDX-License-Identifier: LGPL-2.1-or-later
"""Contact on meshes that NGSolve distributes over processes."""
