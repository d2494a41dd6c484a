# SPDX-License-Identifier: LGPL-2.1-or-later
"""The bulk on a distributed mesh, as the conductor sees it: its forces and its matrix."""

from functools import partial
from weakref import WeakValueDictionary

import numpy as np
import scipy
from ngsolve import BaseMatrix, CoefficientFunction, GridFunction
from ngsolve.la import PARALLEL_STATUS, SparseMatrixd

from ngslac._ngslac import FormDiagonal, ProxyPath
from ngslac.arrays import AsBits, AsNumPy, Multiply, ToCSR
from ngslac.bodies.mass import MassByProducts, MassMatrix
from ngslac.bodies.parts import PartsOf
from ngslac.bulkforms import BulkForm, ScaleMatrix, WithDiagonal, WithMass
from ngslac.parallel.plain import Reference
from ngslac.parallel.team import Team
from ngslac.petsc.nodes import Nodes
from ngslac.petsc.solver import LinearSolverFor, PetscLinearSolver

__all__ = ["FormPart", "RemoteForm", "RemoteMatrix"]


class FormPart:
    """A process's part of a form on a distributed mesh: all vectors are its own part, too."""

    def __init__(self, form, replica):
        self.form, self.replica = form, replica
        self.vec = GridFunction(form.space).vec
        self.forces = self.vec.CreateVector()

    @property
    def dofs(self):
        """The number of each own scalar dof of the displacements in the replica."""
        return self.replica.displacements

    def _At(self, values):
        self.vec.SetParallelStatus(PARALLEL_STATUS.CUMULATED)
        self.vec.FV().NumPy()[:] = values
        return self.vec

    def Apply(self, values):
        """The forces of the own elements."""
        self.form.Apply(self._At(values), self.forces)
        return self.forces.FV().NumPy().copy()

    def AssembleLinearization(self, values):
        """Make the matrix."""
        self.form.AssembleLinearization(self._At(values))

    def Assemble(self, _):
        """Make the matrix of a linear form."""
        self.form.Assemble()

    def Scale(self, factor, _):
        """Multiply the matrix by a factor."""
        self.Local("mat").AsVector().data *= factor

    def Local(self, operator):
        """A matrix of the own elements: "mat" or what belongs to condensation."""
        mat = getattr(self.form, operator)
        return getattr(mat, "local_mat", mat)

    def Times(self, operator, values):
        """The product with such a matrix."""
        mat = self.Local(operator)
        factor, product = mat.CreateRowVector(), mat.CreateColVector()
        factor.FV().NumPy()[:] = values
        product.data = mat * factor
        return product.FV().NumPy().copy()

    def Diagonal(self, _):
        """That of the own part of the matrix."""
        return ToCSR(self.Local("mat")).diagonal()

    def ElasticDiagonal(self, _):
        """That of the own elements at the boundary, see `FormDiagonal`."""
        return FormDiagonal(self.form, self._AtBoundary())

    def _AtBoundary(self):
        """The own dofs at the boundary, of which other processes may have the faces."""
        space, vec = self.form.space, self.vec.CreateVector()
        here = AsNumPy(space.GetDofs(space.mesh.Boundaries(".*")))
        vec.SetParallelStatus(PARALLEL_STATUS.DISTRIBUTED)
        vec.FV().NumPy()[:] = np.repeat(here, space.dim)
        vec.Cumulate()
        return AsBits(vec.FV().NumPy()[:: space.dim] > 0)

    def Parts(self, _):
        """A number for each own dof: the same where the own elements connect them."""
        mat = ToCSR(self.Local("mat"))
        ones = scipy.sparse.csr_matrix((np.ones(mat.nnz), mat.indices, mat.indptr), shape=mat.shape)
        return scipy.sparse.csgraph.connected_components(ones, directed=False)[1].astype(float)


class RemoteForm(BulkForm):
    """A form on a distributed mesh with the verbs of a BilinearForm on the conductor's space."""

    def __init__(self, ensemble, number, original):
        self.ensemble, self.number, self.condense = ensemble, number, original.condense
        self.flags = original.flags
        self.replica = ensemble.SpaceOf(original.space)
        self.space = ensemble.Space(self.replica)
        self._matrices, self._diagonal = WeakValueDictionary(), None  # these hold the form
        ensemble.Need(number, self)

    def Derived(self, task, path, density, *own):
        """The form that a task of all processes makes of this one; `own` is for this process."""
        ensemble = self.ensemble
        if isinstance(density, CoefficientFunction):
            density = Reference("original", ensemble.NumberOf(density))
        order = self.number, path, density
        make = partial(ensemble.crew.tasks[task], *order, *own)
        number = ensemble.Order(task, *order, own=make)[0]
        return RemoteForm(ensemble, number, ensemble.things[number].form)

    # --- forces --------------------------------------------------------------------------------

    def Ask(self, verb, values=None, *args):
        """What each process says of its part of values (n,)."""
        count = len(self.replica.dofs)
        each = [None] * count if values is None else self.replica.Split(values)
        return self.ensemble.Order("form", self.number, verb, *args, each=each)[1:]

    def Sum(self, parts):
        """Values (n,) that processes have parts of."""
        total = np.zeros(self.space.ndof * self.space.dim)
        self.replica.Add(parts, total)
        return total

    def Apply(self, x, y):
        """y = forces at x, vectors on the space."""
        y.FV().NumPy()[:] = self.Sum(self.Ask("Apply", x.FV().NumPy()))

    # --- matrices ------------------------------------------------------------------------------

    def AssembleLinearization(self, x):
        """Make the matrix at x."""
        self._Change("AssembleLinearization", x.FV().NumPy())

    def Assemble(self):
        """Make the matrix of a linear form."""
        self._Change("Assemble")

    def _Change(self, verb, *arguments):
        self._matrices, self._diagonal = WeakValueDictionary(), None
        self.Ask(verb, *arguments)

    @property
    def mat(self):
        """The matrix made last."""
        return self._Matrix("mat")

    @property
    def harmonic_extension(self):
        """Of what is condensed."""
        return self._Matrix("harmonic_extension")

    @property
    def harmonic_extension_trans(self):
        """Of what is condensed."""
        return self._Matrix("harmonic_extension_trans")

    @property
    def inner_solve(self):
        """Of what is condensed."""
        return self._Matrix("inner_solve")

    def _Matrix(self, operator):
        return self._matrices.setdefault(operator, RemoteMatrix(self, operator))

    @property
    def diagonal(self):
        """A sparse matrix with the diagonal of the matrix made last."""
        if self._diagonal is None:
            self._diagonal = Diagonal(self.Sum(self.Ask("Diagonal")))
        return self._diagonal


class RemoteMatrix(BaseMatrix):
    """A matrix of which each process has a part."""

    def __init__(self, form, operator):
        super().__init__()
        self.form, self.operator = form, operator

    def Mult(self, x, y):
        """Y = the product with x."""
        form = self.form
        parts = form.Ask("Times", x.FV().NumPy(), self.operator)
        y.FV().NumPy()[:] = form.Sum(parts)

    def Height(self):
        """Rows."""
        return self.form.space.ndof

    def Width(self):
        """Columns."""
        return self.form.space.ndof

    def CreateColVector(self):
        """A vector of `Height`."""
        return GridFunction(self.form.space).vec

    def CreateRowVector(self):
        """A vector of `Width`."""
        return GridFunction(self.form.space).vec


# --- what else solvers ask of them ---------------------------------------------------------------


@ScaleMatrix.register
def _(form: RemoteForm, factor):
    form._Change("Scale", None, factor)


@WithMass.register
def _(form: RemoteForm, factor, density, u, _):
    return form.Derived("heavy", ProxyPath(u, "u"), density, factor)


@MassMatrix.register
def _(form: RemoteForm, density, proxies, contact, free):
    mass = form.Derived("mass", ProxyPath(proxies[0], "u"), density)
    mass.Assemble()
    mat, diagonal = mass.mat, mass.Sum(mass.Ask("Diagonal"))
    parts = partial(PartsOf, mat, contact.form, None)
    return MassByProducts(lambda values: Multiply([mat], values), diagonal, free, parts)


@WithDiagonal.register
def _(form: RemoteForm):
    return Diagonal(form.Sum(form.Ask("ElasticDiagonal")))


@WithDiagonal.register
def _(mat: RemoteMatrix):
    return mat.form.diagonal


@LinearSolverFor.register
def _(form: RemoteForm, contacts, freedofs, options):
    wanted = options.solver
    for name in ("inverse", "preconditioner"):
        if getattr(options, name) is not None:
            raise ValueError(f"{name}= is not known on a distributed mesh: leave it out")
    if wanted not in (None, "petsc", "direct", "iterative"):
        raise ValueError(
            f"solver={wanted!r} is for one process: on a distributed mesh leave it out, or "
            "take 'direct' or 'iterative', both on PETSc"
        )
    nodes = Nodes.Of(contacts[0], freedofs)
    team = Team(form.ensemble, form, freedofs, nodes)
    return PetscLinearSolver(team, freedofs, nodes, None if wanted == "petsc" else wanted)


@PartsOf.register
def _(mat: RemoteMatrix, form, _):
    found = [part.astype(int) for part in mat.form.Ask("Parts")]
    block = form.fes.dim
    n = first = mat.form.space.ndof * mat.form.space.dim
    ends = []
    for dofs, part in zip(mat.form.replica.dofs, found, strict=True):
        used = dofs >= 0
        ends.append((dofs[used], first + part[used]))
        first += 1 + part.max(initial=-1)
    row, column = (np.concatenate(side) for side in zip(*ends, strict=True))
    graph = scipy.sparse.coo_matrix((np.ones(len(row)), (row, column)), shape=(first, first))
    parts = scipy.sparse.csgraph.connected_components(graph, directed=False)[1][:n]
    return parts[form.offset * block :][: form.component.ndof * block]


def Diagonal(values):
    """The sparse matrix with a diagonal (n,)."""
    where = np.arange(len(values), dtype=np.int32)
    return SparseMatrixd.CreateFromCOO(where, where, values, len(values), len(values))
