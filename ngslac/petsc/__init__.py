# SPDX-License-Identifier: LGPL-2.1-or-later
"""Linear systems on PETSc, in one process or on many."""
