# SPDX-License-Identifier: LGPL-2.1-or-later
"""A compiled contact form of a distributed mesh: it works on the skin, on all processes alike."""

import numpy as np
import scipy
from ngsolve import BilinearForm, GridFunction, ProductSpace

from ngslac._ngslac import ContactForm, EquilibrationScale, FormDiagonal, LACSpace, ProxyPath
from ngslac.arrays import AsBits, AsNumPy, Exported, ToCSR
from ngslac.parallel.layout import LayoutOf
from ngslac.parallel.matrices import SkinMatrix, SkinRows
from ngslac.parallel.skin import Skin

__all__ = [
    "Compiled",
    "FunctionOver",
    "JumpRows",
    "JumpRowsEverywhere",
    "MakeForm",
    "OnSurface",
    "RegionOn",
    "ScaleOf",
    "TraceOf",
    "WholeTrace",
]


def MakeForm(setup, *, active=True):
    """The compiled form of these arguments."""
    if setup["u"].space.mesh.comm.size == 1:
        return ContactForm(**setup, active=active)
    return SkinForm(setup, active)


def Compiled(form):
    """The compiled form, on a mesh that this process has as a whole."""
    return form.there if isinstance(form, SkinForm) else form


def RegionOn(form, region):
    """What a region, or None, is on that mesh."""
    return form.skin.Region(region) if isinstance(form, SkinForm) else region


class SkinForm:
    """A ContactForm on the skin with the verbs that it has on vectors of the distributed space.

    What is not here is that of the compiled form.
    """

    def __init__(self, setup, active):
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

    def __getattr__(self, name):
        if name == "there":  # before it is made
            raise AttributeError(name)
        return getattr(self.there, name)

    def _There(self, proxy, name):
        """A trial function on the skin."""
        found = self.trace.copy.TrialFunction()
        for k in ProxyPath(proxy, name):
            found = found[k]
        return found

    def _FieldThere(self, field):
        """A function on the skin with the values of one of users."""
        there = FunctionOver(self, field)
        self._fields.append((field, self.skin.Trace(field.space), there))
        return there

    def _Refresh(self):
        """Take what users may have done to their functions."""
        for field, trace, there in self._fields:
            values = LayoutOf(field.space).Values(field.vec)
            there.vec.FV().NumPy()[:] = trace.Gather(values)

    def _At(self, vec):
        """The values of a vector on the skin."""
        self._gf.vec.FV().NumPy()[:] = self.trace.Gather(self.layout.Values(vec))
        return self._gf.vec

    def _Add(self, forces, y):
        self.trace.Add(forces.FV().NumPy(), self.layout.Values(y))

    def _None(self):
        self._forces[:] = 0
        return self._forces

    # --- pairing -------------------------------------------------------------------------------

    def Update(self, gf=None, history=None):
        """See ContactForm."""
        self.skin.Follow()
        self._Refresh()
        if gf is not None:
            self._At(gf.vec)
        self.there.Update(None if gf is None else self._gf, history)

    def Reevaluate(self):
        """See ContactForm."""
        self._Refresh()
        self.there.Reevaluate()

    def BeginSolve(self):
        """See ContactForm."""
        self._Refresh()
        self.there.BeginSolve()

    def KeepFrom(self, other):
        """See ContactForm."""
        self.there.KeepFrom(other.there)

    def Follow(self, vec):
        """See ContactForm."""
        self.there.Follow(self._At(vec))

    def SetStiffness(self, mat, factor):
        """See ContactForm."""
        self.there.SetStiffness(self._Diagonal(self.layout.Diagonal(mat)), factor)

    def LearnStiffness(self, bulk):
        """See ContactForm."""
        isform = isinstance(bulk, BilinearForm)
        found = self._Elastic(bulk) if isform else self.layout.Diagonal(bulk)
        self.there.LearnStiffness(self._Diagonal(found))

    def _Elastic(self, form):
        """The diagonal (n,) that elements at boundaries make; others may have their faces."""
        touched = AsNumPy(self.fes.GetDofs(self.fes.mesh.Boundaries(".*")))
        there = self.layout.Everywhere(np.repeat(touched, self.fes.dim))
        own = FormDiagonal(form, AsBits(np.asarray(there)[:: self.fes.dim]))
        return self.layout.Added(own)

    def Scale(self, mat, forms):
        """The factors (n,) that equilibrate the matrix of the bulk with some SkinForms."""
        diagonal = self.layout.Diagonal(mat)
        positive = diagonal > 0
        scale = np.where(positive, 1 / np.sqrt(np.where(positive, diagonal, 1.0)), 1.0)
        for form in forms:
            found = EquilibrationScale(form._Diagonal(diagonal), [form.there])
            scale[form.MultiplierDofs()] = found[form.there.MultiplierDofs()]
        return scale

    def _Diagonal(self, values):
        """A sparse matrix with a diagonal, on the skin."""
        return Exported(scipy.sparse.diags_array(self.trace.Gather(values)))

    # --- residual and matrices -----------------------------------------------------------------

    def Evaluate(self, vec):
        """See ContactForm."""
        self._Refresh()
        self.there.Evaluate(self._At(vec))

    def Commit(self, vec):
        """See ContactForm."""
        self.there.Commit(self._At(vec))

    def Softens(self, vec):
        """See ContactForm."""
        return self.there.Softens(self._At(vec))

    def AddApply(self, x, y):
        """See ContactForm."""
        forces = self._None()
        self.there.AddApply(self._At(x), forces)
        self._Add(forces, y)

    def AssembleLinearization(self, x):
        """See ContactForm."""
        self.there.AssembleLinearization(self._At(x))

    def AssembleStep(self, x, residual, convex=False):
        """See ContactForm."""
        forces = self._None()
        self.there.AssembleStep(self._At(x), forces, convex)
        self._Add(forces, residual)

    def AddForces(self, x, tractions, y):
        """See ContactForm."""
        forces = self._None()
        self.there.AddForces(self._At(x), tractions, forces)
        self._Add(forces, y)

    def Close(self, macros, x):
        """See ContactForm."""
        there = self._At(x)
        self.there.Close(macros, there)
        self.trace.Put(there.FV().NumPy(), self.layout.Values(x))

    def Matrix(self, x, tractions, stiffness):
        """See ContactForm."""
        return SkinMatrix(self.there.Matrix(self._At(x), tractions, stiffness), self)

    def GapRanges(self, values):
        """See ContactForm."""
        return self.there.GapRanges(self.trace.Gather(values))

    @property
    def mat(self):
        """The matrix assembled last."""
        return SkinMatrix(self.there.mat, self)

    def MultiplierDofs(self):
        """Rows of the multipliers."""
        d = self.fes.dim
        return self.there.MultiplierDofs() + d * (self.lamoffset - self.there.lamoffset)


def JumpRows(form, side):
    """What each macro-element sees of a displacement, times its area: d rows of each, sparse."""
    if isinstance(form, SkinForm):
        return SkinRows(ToCSR(form.there.JumpMatrix(side)), form.skin.Trace(form.component))
    return ToCSR(form.JumpMatrix(side))


def JumpRowsEverywhere(form, side):
    """The same on the whole product space."""
    there = Compiled(form)
    jump = ToCSR(there.JumpMatrix(side))
    columns = jump.indices + there.offset * there.fes.dim
    shape = jump.shape[0], there.fes.ndof * there.fes.dim
    rows = scipy.sparse.csr_matrix((jump.data, columns, jump.indptr), shape=shape)
    return SkinRows(rows, form.trace) if isinstance(form, SkinForm) else rows


def TraceOf(form):
    """Which rows of a form's space are on the surfaces."""
    if isinstance(form, SkinForm):
        return form.trace
    return WholeTrace(form.fes.ndof * form.fes.dim)


class WholeTrace:
    """The verbs of a Trace where all `count` rows are there in one process."""

    def __init__(self, count):
        self.count = count

    def Zeros(self):
        """A new array of zeros."""
        return np.zeros(self.count)

    def Gather(self, values):
        """The rows on the surfaces."""
        return np.asarray(values)

    def Put(self, values, total):
        """Write values of rows on the surfaces."""
        total[:] = values

    def Matrix(self, mat):
        """A matrix of contact with the rows on the surfaces."""
        return mat


def ScaleOf(mat, forms):
    """The factors (n,) that equilibrate a system of bulk and contacts."""
    if isinstance(forms[0], SkinForm):
        return forms[0].Scale(mat, forms)
    return EquilibrationScale(mat, forms)


def Slaves(space):
    """Those of the macro-elements among the components of a space."""
    if type(space) is ProductSpace:
        return [slave for part in space.components for slave in Slaves(part)]
    return [space.slave] if isinstance(space, LACSpace) else []


def ComponentOf(proxy, name):
    """The component of a product space that a trial function belongs to, and its first dof."""
    space, first = proxy.space, 0
    for k in ProxyPath(proxy, name):
        first += space.Range(k).start
        space = space.components[k]
    return space, first


def OnSurface(form, values):
    """Values (k,) of the displacement's rows as those of the compiled form's."""
    if isinstance(form, SkinForm):
        return form.skin.Trace(form.component).Gather(np.asarray(values).astype(float))
    return np.asarray(values)


def FunctionOver(form, function):
    """A function of users on the mesh that this process has as a whole."""
    if not isinstance(form, SkinForm) or not isinstance(function, GridFunction):
        return function
    trace = form.skin.Trace(function.space)
    there = GridFunction(trace.copy)
    values = LayoutOf(function.space).Values(function.vec)
    there.vec.FV().NumPy()[:] = trace.Gather(values)
    return there
