# SPDX-License-Identifier: LGPL-2.1-or-later
"""The compiled classes that users see; their docstrings stand where they are compiled."""

from collections.abc import Sequence
from typing import Any

import ngsolve.comp
from pyngcore.pyngcore import Array_I_S

def __getattr__(name: str) -> Any: ...  # internal

class LACSpace(ngsolve.comp.FESpace):
    def CoreDofs(self, macro: int) -> Array_I_S: ...
    def WithComponents(self, components: int) -> LACSpace: ...
    def __init__(
        self,
        V: ngsolve.comp.FESpace,
        *,
        slave: ngsolve.comp.Region | str,
        macros: Sequence[int] | None = None,
        components: int | None = None,
        autoupdate: bool = False,
        axisymmetric: bool = False,
    ) -> None: ...
    @property
    def axisymmetric(self) -> bool: ...
    @property
    def displacement(self) -> ngsolve.comp.FESpace: ...
    @property
    def macros(self) -> Array_I_S: ...
    @property
    def nmacros(self) -> int: ...
    @property
    def slave(self) -> ngsolve.comp.Region: ...

class BubbleVectorH1(ngsolve.comp.VectorH1):
    def __init__(self, mesh: ngsolve.comp.Mesh, **kwargs) -> None: ...
