# SPDX-License-Identifier: LGPL-2.1-or-later
"""A compiled contact form of a distributed mesh: each process has the whole of it, on the skin."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
import scipy
from ngsolve import (
    BaseMatrix,
    BaseVector,
    BilinearForm,
    BitArray,
    FESpace,
    GridFunction,
    ProductSpace,
    Region,
)

from ngslac._ngslac import ContactForm, EquilibrationScale, FormDiagonal, LACSpace, ProxyPath, Side
from ngslac.arrays import AsBits, AsNumPy, Exported, ToCSR
from ngslac.parallel.layout import LayoutOf
from ngslac.parallel.matrices import SkinMatrix, SkinRows
from ngslac.parallel.skin import Skin, Trace

if TYPE_CHECKING:
    from ngsolve.comp import ProxyFunction
    from scipy.sparse import csr_matrix

__all__ = [
    "Compiled",
    "FunctionOver",
    "JumpRows",
    "JumpRowsEverywhere",
    "MakeForm",
    "NoRows",
    "OnSurface",
    "RegionOn",
    "ScaleOf",
    "TraceOf",
    "WholeTrace",
]


def MakeForm(setup: dict[str, Any], *, active: bool = True) -> ContactForm | SkinForm:
    """Make a ContactForm with these arguments, on a distributed mesh a SkinForm."""
    if setup["u"].space.mesh.comm.size == 1:
        return ContactForm(**setup, active=active)
    return SkinForm(setup, active)


def Compiled(form: ContactForm | SkinForm) -> ContactForm:
    """The ContactForm, whose mesh this process has as a whole."""
    return form.there if isinstance(form, SkinForm) else form


def RegionOn(form: ContactForm | SkinForm, region: Region | None) -> Region | None:
    """The region on the mesh of the ContactForm; None stays None."""
    return form.skin.Region(region) if isinstance(form, SkinForm) else region


class SkinForm:
    """A ContactForm on the skin, whose methods take vectors of the distributed space.

    Attributes that are not defined here are those of the ContactForm.
    """

    def __init__(self, setup: dict[str, Any], active: bool):
        u, lam = setup["u"], setup["lam"]
        self.fes = u.space
        self.component, self.offset = ComponentOf(u, "u")
        self.space, self.lamoffset = ComponentOf(lam, "lam")
        self.skin = Skin.Of(self.fes.mesh, *Slaves(self.fes), setup["master"])
        self.trace, self.layout = self.skin.Trace(self.fes), LayoutOf(self.fes)
        there = {name: self._There(setup[name], name) for name in ("u", "lam")}
        if "scalars" in setup:
            there["scalars"] = [self._There(field, "field") for field in setup["scalars"]]
        there["master"] = self.skin.Region(setup["master"])
        self._fields = []  # of users, with their Trace and what stands for them on the skin
        for name, function in setup.items():
            if isinstance(function, GridFunction):
                there[name] = self._FieldThere(function)
        self.there = ContactForm(**(setup | there), active=active)
        self._gf = GridFunction(self.trace.copy)
        self._forces = self._gf.vec.CreateVector()
        self.scalars = []
        for field in setup.get("scalars", ()):
            space, first = ComponentOf(field, "field")
            self.scalars.append((space, first * self.fes.dim))

    def __getattr__(self, name: str) -> Any:
        if name == "there":  # before it is made
            raise AttributeError(name)
        return getattr(self.there, name)

    def _There(self, proxy: ProxyFunction, name: str) -> ProxyFunction:
        """Find a trial function on the skin."""
        found = self.trace.copy.TrialFunction()
        for k in ProxyPath(proxy, name):
            found = found[k]
        return found

    def _FieldThere(self, field: GridFunction) -> GridFunction:
        """Make a function on the skin for a function of the user."""
        there = FunctionOver(self, field)
        self._fields.append((field, self.skin.Trace(field.space), there))
        return there

    def _Refresh(self) -> None:
        """Copy the values of the user's functions, which may have changed."""
        for field, trace, there in self._fields:
            values = LayoutOf(field.space).Values(field.vec)
            there.vec.FV().NumPy()[:] = trace.Gather(values)

    def _At(self, vec: BaseVector) -> BaseVector:
        """Copy the values of a vector to the skin."""
        self._gf.vec.FV().NumPy()[:] = self.trace.Gather(self.layout.Values(vec))
        return self._gf.vec

    def _Add(self, forces: BaseVector, y: BaseVector) -> None:
        self.trace.Add(forces.FV().NumPy(), self.layout.Values(y))

    def _None(self) -> BaseVector:
        self._forces[:] = 0
        return self._forces

    # --- pairing -------------------------------------------------------------------------------

    def Update(
        self, gf: GridFunction | None = None, history: dict[str, np.ndarray] | None = None
    ) -> None:
        """See ContactForm."""
        self.skin.Follow()
        self._Refresh()
        if gf is not None:
            self._At(gf.vec)
        self.there.Update(None if gf is None else self._gf, history)

    def Reevaluate(self) -> None:
        """See ContactForm."""
        self._Refresh()
        self.there.Reevaluate()

    def BeginSolve(self) -> None:
        """See ContactForm."""
        self._Refresh()
        self.there.BeginSolve()

    def KeepFrom(self, other: SkinForm) -> None:
        """See ContactForm."""
        self.there.KeepFrom(other.there)

    def Follow(self, vec: BaseVector) -> None:
        """See ContactForm."""
        self.there.Follow(self._At(vec))

    def SetStiffness(self, mat: BaseMatrix, factor: float) -> None:
        """See ContactForm."""
        self.there.SetStiffness(self._Diagonal(self.layout.Diagonal(mat)), factor)

    def LearnStiffness(self, bulk: BilinearForm | BaseMatrix) -> None:
        """See ContactForm."""
        isform = isinstance(bulk, BilinearForm)
        found = self._Elastic(bulk) if isform else self.layout.Diagonal(bulk)
        self.there.LearnStiffness(self._Diagonal(found))

    def _Elastic(self, form: BilinearForm) -> np.ndarray:
        """Sum up the diagonal (n,) of elements at boundaries, whichever process has these."""
        touched = AsNumPy(self.fes.GetDofs(self.fes.mesh.Boundaries(".*")))
        there = self.layout.Everywhere(np.repeat(touched, self.fes.dim))
        own = FormDiagonal(form, AsBits(np.asarray(there)[:: self.fes.dim]))
        return self.layout.Added(own)

    def Scale(self, mat: BaseMatrix, forms: Sequence[SkinForm]) -> np.ndarray:
        """Compute factors (n,) that equilibrate the matrix of the bulk with some SkinForms."""
        diagonal = self.layout.Diagonal(mat)
        positive = diagonal > 0
        scale = np.where(positive, 1 / np.sqrt(np.where(positive, diagonal, 1.0)), 1.0)
        for form in forms:
            found = EquilibrationScale(form._Diagonal(diagonal), [form.there])
            scale[form.MultiplierDofs()] = found[form.there.MultiplierDofs()]
        return scale

    def _Diagonal(self, values: np.ndarray) -> BaseMatrix:
        """Make a diagonal matrix on the skin."""
        return Exported(scipy.sparse.diags_array(self.trace.Gather(values)))

    # --- residual and matrices -----------------------------------------------------------------

    def Evaluate(self, vec: BaseVector) -> None:
        """See ContactForm."""
        self._Refresh()
        self.there.Evaluate(self._At(vec))

    def Commit(self, vec: BaseVector) -> None:
        """See ContactForm."""
        self.there.Commit(self._At(vec))

    def Softens(self, vec: BaseVector) -> bool:
        """See ContactForm."""
        return self.there.Softens(self._At(vec))

    def AddApply(self, x: BaseVector, y: BaseVector) -> None:
        """See ContactForm."""
        forces = self._None()
        self.there.AddApply(self._At(x), forces)
        self._Add(forces, y)

    def AssembleLinearization(self, x: BaseVector) -> None:
        """See ContactForm."""
        self.there.AssembleLinearization(self._At(x))

    def AssembleStep(self, x: BaseVector, residual: BaseVector, convex: bool = False) -> None:
        """See ContactForm."""
        forces = self._None()
        self.there.AssembleStep(self._At(x), forces, convex)
        self._Add(forces, residual)

    def AddForces(self, x: BaseVector, tractions: np.ndarray, y: BaseVector) -> None:
        """See ContactForm."""
        forces = self._None()
        self.there.AddForces(self._At(x), tractions, forces)
        self._Add(forces, y)

    def Close(self, macros: BitArray, x: BaseVector) -> None:
        """See ContactForm."""
        there = self._At(x)
        self.there.Close(macros, there)
        self.trace.Put(there.FV().NumPy(), self.layout.Values(x))

    def Matrix(self, x: BaseVector, tractions: np.ndarray, stiffness: np.ndarray) -> SkinMatrix:
        """See ContactForm."""
        return SkinMatrix(self.there.Matrix(self._At(x), tractions, stiffness), self)

    def GapRanges(self, values: np.ndarray) -> np.ndarray:
        """See ContactForm."""
        return self.there.GapRanges(self.trace.Gather(values))

    @property
    def mat(self) -> SkinMatrix:
        """The SkinMatrix that was assembled last."""
        return SkinMatrix(self.there.mat, self)

    def MultiplierDofs(self) -> np.ndarray:
        """See ContactForm; the rows are those of this process."""
        d = self.fes.dim
        return self.there.MultiplierDofs() + d * (self.lamoffset - self.there.lamoffset)


def JumpRows(form: ContactForm | SkinForm, side: Side) -> SkinRows | csr_matrix:
    """Sparse rows, d for each macro-element: means of a displacement over it, times its area."""
    if isinstance(form, SkinForm):
        return SkinRows(ToCSR(form.there.JumpMatrix(side)), form.skin.Trace(form.component))
    return ToCSR(form.JumpMatrix(side))


def JumpRowsEverywhere(form: ContactForm | SkinForm, side: Side) -> SkinRows | csr_matrix:
    """The JumpRows as rows of the whole product space."""
    there = Compiled(form)
    jump = ToCSR(there.JumpMatrix(side))
    columns = jump.indices + there.offset * there.fes.dim
    shape = jump.shape[0], there.fes.ndof * there.fes.dim
    rows = scipy.sparse.csr_matrix((jump.data, columns, jump.indptr), shape=shape)
    return SkinRows(rows, form.trace) if isinstance(form, SkinForm) else rows


def NoRows(form: ContactForm | SkinForm) -> SkinRows | csr_matrix:
    """No rows of the whole product space, without any work."""
    fes = Compiled(form).fes
    rows = scipy.sparse.csr_matrix((0, fes.ndof * fes.dim))
    return SkinRows(rows, form.trace) if isinstance(form, SkinForm) else rows


def TraceOf(form: ContactForm | SkinForm) -> Trace | WholeTrace:
    """The Trace of the space of a form, or a WholeTrace."""
    if isinstance(form, SkinForm):
        return form.trace
    return WholeTrace(form.fes.ndof * form.fes.dim)


class WholeTrace:
    """The methods of a Trace where one process has all `count` rows."""

    def __init__(self, count: int):
        self.count = count

    def Zeros(self) -> np.ndarray:
        """See Trace."""
        return np.zeros(self.count)

    def Gather(self, values: np.ndarray) -> np.ndarray:
        """See Trace; no rows are left out."""
        return np.asarray(values)

    def Put(self, values: np.ndarray, total: np.ndarray) -> None:
        """See Trace."""
        total[:] = values

    def Matrix(self, mat: BaseMatrix) -> BaseMatrix:
        """See Trace."""
        return mat


def ScaleOf(mat: BaseMatrix, forms: Sequence[ContactForm | SkinForm]) -> np.ndarray:
    """Factors (n,) that equilibrate a system of bulk and contacts."""
    if isinstance(forms[0], SkinForm):
        return forms[0].Scale(mat, forms)
    return EquilibrationScale(mat, forms)


def Slaves(space: FESpace) -> list[Region]:
    """The slave regions of the LACSpaces among the components of a space."""
    if type(space) is ProductSpace:
        return [slave for part in space.components for slave in Slaves(part)]
    return [space.slave] if isinstance(space, LACSpace) else []


def ComponentOf(proxy: ProxyFunction, name: str) -> tuple[FESpace, int]:
    """The component of a product space that a trial function belongs to, and its first dof."""
    space, first = proxy.space, 0
    for k in ProxyPath(proxy, name):
        first += space.Range(k).start
        space = space.components[k]
    return space, first


def OnSurface(form: ContactForm | SkinForm, values: np.ndarray) -> np.ndarray:
    """Values (k,) of rows of the displacement in the order of the ContactForm."""
    if isinstance(form, SkinForm):
        return form.skin.Trace(form.component).Gather(np.asarray(values).astype(float))
    return np.asarray(values)


def FunctionOver(form: ContactForm | SkinForm, function: Any) -> Any:
    """A function of the user on the mesh of the ContactForm."""
    if not isinstance(form, SkinForm) or not isinstance(function, GridFunction):
        return function
    trace = form.skin.Trace(function.space)
    there = GridFunction(trace.copy)
    values = LayoutOf(function.space).Values(function.vec)
    there.vec.FV().NumPy()[:] = trace.Gather(values)
    return there
