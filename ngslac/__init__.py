# SPDX-License-Identifier: LGPL-2.1-or-later
"""Local Average Contact (LAC) for NGSolve.

Two elastic bodies touch along independently meshed surfaces; non-penetration and Coulomb friction
hold on average over macro-elements of the slave surface.
"""

from ngslac._version import CheckNGSolve, __version__

CheckNGSolve()

# NGSolve loads the libraries that the compiled module needs: it has to come first.
import ngsolve as _ngsolve  # noqa: E402, F401

try:
    from ngslac._ngslac import BubbleVectorH1, LACSpace
except ModuleNotFoundError as error:
    raise ImportError(
        f"{__path__[0]} holds the sources of ngslac, not the compiled plugin: install it with "
        "'pip install -e .' there, or start Python in another folder"
    ) from error

from ngslac.contact.assembly import FindContacts  # noqa: E402
from ngslac.contact.contact import LACContact  # noqa: E402
from ngslac.contact.fields import Law  # noqa: E402
from ngslac.contact.flux import Flux  # noqa: E402
from ngslac.dirichlet import KeepPatterns as _KeepPatterns  # noqa: E402
from ngslac.errors import ContactConvergenceError, ContactWarning, FloatingBodyError  # noqa: E402
from ngslac.mesh import SplitSlaveFaces  # noqa: E402
from ngslac.solve.augmented import AugmentedLagrangianSolver  # noqa: E402
from ngslac.solve.forms import FormSum  # noqa: E402
from ngslac.solve.solver import ContactSolver  # noqa: E402
from ngslac.steps.load import LoadStepper  # noqa: E402
from ngslac.steps.restart import LoadMesh, LoadState, SaveState  # noqa: E402
from ngslac.steps.time import TimeStepper  # noqa: E402

_KeepPatterns()

__all__ = [
    "AugmentedLagrangianSolver",
    "BubbleVectorH1",
    "ContactConvergenceError",
    "ContactSolver",
    "ContactWarning",
    "FindContacts",
    "FloatingBodyError",
    "Flux",
    "FormSum",
    "LACContact",
    "LACSpace",
    "Law",
    "LoadMesh",
    "LoadState",
    "LoadStepper",
    "SaveState",
    "SplitSlaveFaces",
    "TimeStepper",
    "__version__",
]


def __dir__() -> list[str]:
    return __all__
