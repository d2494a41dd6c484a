# SPDX-License-Identifier: LGPL-2.1-or-later
"""What a converged contact state says besides its solution: errors, derivatives, modes."""

from ngslac.analysis.modes import Modes

__all__ = ["Modes"]
