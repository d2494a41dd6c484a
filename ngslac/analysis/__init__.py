# SPDX-License-Identifier: LGPL-2.1-or-later
"""Errors, derivatives and modes of a converged contact state."""

from ngslac.analysis.adapt import Adapt
from ngslac.analysis.equilibrated import EquilibratedEstimate
from ngslac.analysis.estimate import ResidualEstimate
from ngslac.analysis.goal import GoalEstimate
from ngslac.analysis.modes import Modes
from ngslac.analysis.record import Record
from ngslac.analysis.sensitivity import Sensitivity
from ngslac.analysis.shape import Shape

__all__ = [
    "Adapt",
    "EquilibratedEstimate",
    "GoalEstimate",
    "Modes",
    "Record",
    "ResidualEstimate",
    "Sensitivity",
    "Shape",
]
