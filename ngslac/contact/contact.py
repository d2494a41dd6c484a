# SPDX-License-Identifier: LGPL-2.1-or-later
"""Contact of a slave with a master surface, as a nonlinear form."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING

import numpy as np
from ngsolve import (
    BaseMatrix,
    BaseVector,
    BilinearForm,
    CoefficientFunction,
    GridFunction,
    Mesh,
    Parameter,
    Region,
)

from ngslac._ngslac import ContactForm, LACSpace, Side
from ngslac.arguments import (
    CheckDistinct,
    CheckInstance,
    CheckMoves,
    CheckNumber,
    CheckOnSpace,
    CheckVector,
)
from ngslac.contact import results
from ngslac.contact.flux import CheckFluxes, Flux
from ngslac.contact.setup import CheckedSetup
from ngslac.contact.state import CheckSaved, FormState
from ngslac.dirichlet import WarnOfUnheld
from ngslac.errors import RefuseCopy
from ngslac.output import pictures, scene
from ngslac.output.fields import OF_DISPLACEMENTS, OF_SCALARS
from ngslac.parallel.form import Compiled, JumpRows, RegionOn
from ngslac.parallel.layout import LayoutOf
from ngslac.parallel.together import OnAll

if TYPE_CHECKING:
    from contextlib import AbstractContextManager

    from ngsolve.comp import ProxyFunction

    from ngslac.contact.fields import Law
    from ngslac.tool import Tool

__all__ = ["LACContact"]

# Beyond this, and below its inverse, a factor of the scale loses digits of the linear systems.
STIFFEST = 1e6
COMES_OFF = "what touches itself comes off again: drop tied and bilateral"
SELF = "self-contact needs finite=True"


def MeshOf(contact: LACContact, *_, **__) -> Mesh:
    """The mesh of a contact."""
    return contact.mesh


def MeshOfTrial(_: object, u: object = None, *__, **___) -> Mesh | None:
    """The mesh of a trial function; None where `u` is none."""
    return getattr(getattr(u, "space", None), "mesh", None)


class LACContact:
    """Unilateral contact with friction between a slave and a master surface.

    On average over each macro-element of the slave surface: no penetration, no tension,
    complementarity of both, and a friction law (Abbas, Drouet, Hild, Pignet 2017, eqs. 4-7).
    The contact is a nonlinear form on the product space of `u` and `lam`: `Apply`,
    `AssembleLinearization` and `mat` work as in a BilinearForm, and the whole problem is the sum of
    the bulk's form and this one.

    Parameters
    ----------
    u, lam : ngsolve trial functions
        Displacement and contact traction (of a `LACSpace`) on the same product space. The slave
        side is that of the LACSpace. A scalar field, such as a temperature, can be tied: `lam` is
        what flows into the slave per area. Else `lam` acts on the slave body; pressure is
        ``-lam.n >= 0`` with
        the contact direction n out of the slave: between the normals of both surfaces, nearer to
        that of the stiffer body (`Prepare`), and the slave's against an obstacle.
    master : str or Region
        The other side; where `u` has no degrees of freedom there, a rigid body at rest.
        (NGSolve's ContactBoundary calls our slave its *master*.)
    obstacle : float, CoefficientFunction, Parameter or Tool
        Instead of a master: the gap to a rigid obstacle along the outward slave normal (> 0 open),
        as a function on the slave surface in the reference configuration. The obstacle moves where
        the function holds a Parameter, such as the load or the time; in dynamics it hits with its
        velocity along the normal, relative to that of the slave. With ``finite=True``: a rigid tool
        in space, see `ngslac.tools`, or its signed distance as a function of x, y, z.
    friction : float, CoefficientFunction, Parameter or function
        Coulomb's coefficient, >= 0. None: frictionless. A function gets the contact's own `Fields`,
        such as slip, rate and pressure, and returns an expression of them.
    tresca : float, CoefficientFunction, Parameter or function
        A bound of the tangential traction that does not depend on the pressure (stress units).
        Together with `friction`: Coulomb's law up to this bound. Alone it presumes contact that
        stays closed, since its traction jumps to zero where contact opens.
    offset : float, CoefficientFunction, Parameter or function
        Added to the gap (length; mean over each macro-element): > 0 a clearance, < 0 an
        interference, as of a press fit, without moving the meshes. A Parameter in it ramps it. The
        fields and limits of the search count with it; it is an arm between the frictions on both
        sides.
    adjust : float
        Strain-free start: gaps and overlaps between the meshes of up to this length at `Update`
        count as zero, of each macro-element on its own; `offset` is added to that.
    tied : bool
        Glue the surfaces: equal mean displacements (counted from the last `Update`, that is from
        the reference if there was none), any traction. Where the meshes are apart, only those of
        ``finite=True`` let both bodies turn freely; partners stay those of the `Update`.
    bilateral : bool
        Contact without separation, as of guides: the surfaces slide, but stay together, at the mean
        gap 0. Pressures have any sign, and friction is bounded by their size. No macro-element with
        a partner opens: `maxdist` limits what is held.
    finite : bool
        Sliding, rotations and strains may be large: pairing, gap, slip, normals and forces are
        those of the current configuration and follow the displacement in every iteration. `lam` is
        the traction per area of the reference configuration. False: pairs, weights and directions
        stay those of the last `Update`. A boundary may be slave and master at once.
    edges : bool
        Sharp ends of a surface, such as the end of a beam that lies on another one, press inside of
        macro-elements: there the pressure is distributed over points, and a coarse mesh bends as a
        fine one. Small sliding on a master only. `pressure` still is the mean, and so is the bound
        of friction; Newton's method takes some more steps.
    maxdist : float
        Farthest opening at which faces pair. Default: the diameter of both surfaces. Given with
        ``finite=True``, bodies may be farther apart at first, or a tool behind the slave.
    penetration : float
        Deepest interpenetration that is seen as such. Default: a tenth of the slave's diameter.
    law : Law or callable, optional
        A law of your own in place of that of Coulomb and Tresca: an expression as `Law`, or a
        function in NumPy. That gets a dict of arrays, the
        *places*, with a row for each of the n macro-elements: ``gap`` (n) > 0 open, ``slip`` (n, d)
        of this step, ``normal`` (n, d) out of the slave, ``jump`` (n, d) = slip - gap normal, ``x``
        (n, d) centroid of the reference, ``area`` (n), 0 without a partner, where answers do not
        count. It returns a dict with ``traction`` (n, d) on the slave, and with the derivatives of
        that by the places that it looks at: ``by_gap`` (n, d), ``by_slip``, ``by_jump`` (n, d, d).
        ``by_normal`` follows if a rotation of the places turns the traction; else give it, with all
        else fixed. ``status`` (n) as below; by default 0 without a traction, 1 where its tangential
        part grows with slip in its own direction, else 2. For laws that stick: ``trial`` (n, d),
        the traction now less ``c`` (n), its scale, times the jump, with ``by_trial``. With `tied`,
        of glue or heat, the jump counts from the last `Update`, there is no gap and no slip, and
        for ``finite=True`` no normal. What it remembers, such as a wear or a damage, has its start
        value in a dict ``kept``, an attribute of the law: a number or a vector (k) by name. It is
        a place, as at the end of the last step, and part of each answer, as now. It is in `Table`
        and in saved states; `Update` without a solution forgets it.
        Solved by Newton's method alone, and refused by `TimeStepper`.
    flux : Flux or list of Flux, optional
        What flows through the contact, such as heat, in equations of scalar fields beside `u`.
    stiffness : float
        Factor of the automatic scale c (stress per length) of the complementarity functions, from
        1e-6 to 1e6. The solution does not depend on it.

    Attributes
    ----------
    pressure, gap, status : GridFunction
        One number per macro-element, on the slave surface: pressure (> 0 compression, stress
        units; 0 where open), mean gap (> 0 open, length; NaN without a partner), 0 open, 1 stick, 2
        slip. Filled by `Evaluate`, which the solver calls.
    traction, slip, normal : GridFunction
        Vectors: traction on the slave, tangential slip of the last step (slave minus master;
        not known for ``finite=True`` without friction), contact direction out of the slave.
    flux : GridFunction
        Of a scalar `u`, in place of pressure, gap, traction and slip: what flows out of the slave,
        one number per macro-element, per paired area.
    dt : Parameter
        Length of the present step, which steppers set; 1 before the first one.
    components : int
        Of `u`: as many as dimensions, or 1.
    space : LACSpace
    master : Region or None
    tool : Tool or None
    penetration : float or None
        As given.

    Raises
    ------
    ValueError, TypeError, ngsolve.NgException
        A region without faces, overlapping regions, negative or non-finite friction, surfaces that
        never meet, bodies that share nodes.

    Examples
    --------
    >>> contact = LACContact(u, lam, master="master", friction=0.2)
    >>> print(contact.Check())  # doctest: +ELLIPSIS
    macro-elements   4, size 0.25 to 0.25; ...
    >>> last = ContactSolver(a, gf, contact).Solve(printing=False)
    >>> pressure = Integrate(contact.pressure, mesh.Boundaries("slave"))
    >>> bool(abs(contact.Force()[1] - pressure) < 1e-12)
    True
    """

    pressure: GridFunction
    gap: GridFunction
    status: GridFunction
    traction: GridFunction
    slip: GridFunction
    normal: GridFunction
    flux: GridFunction

    __deepcopy__ = __reduce_ex__ = RefuseCopy

    @OnAll(MeshOfTrial)
    def __init__(
        self,
        u: ProxyFunction,
        lam: ProxyFunction,
        *,
        master: Region | str | None = None,
        obstacle: CoefficientFunction | Tool | float | None = None,
        friction: CoefficientFunction | float | Callable | None = None,
        tresca: CoefficientFunction | float | Callable | None = None,
        offset: CoefficientFunction | float | Callable | None = None,
        adjust: float | None = None,
        tied: bool = False,
        bilateral: bool = False,
        finite: bool = False,
        edges: bool = False,
        maxdist: float | None = None,
        penetration: float | None = None,
        law: Law | Callable | None = None,
        flux: Flux | Sequence[Flux] | None = None,
        stiffness: float = 1.0,
    ):
        wanted = f"a positive factor from {1 / STIFFEST:g} to {STIFFEST:g}"
        CheckNumber("stiffness", stiffness, wanted, lambda f: 1 / STIFFEST <= f <= STIFFEST)
        functions = {"obstacle": obstacle, "friction": friction, "tresca": tresca, "offset": offset}
        self.dt = Parameter(1.0)  # length of the step, for rates
        flags = {"tied": tied, "bilateral": bilateral, "finite": finite, "edges": edges}
        lengths = {"adjust": adjust, "maxdist": maxdist, "penetration": penetration}
        self.fluxes = CheckFluxes(flux)
        parts = functions, flags, lengths, law, self.fluxes
        self.tool, setup = CheckedSetup(u, lam, master, *parts, self.dt)
        mesh, region = u.space.mesh, setup["master"]
        self.components = u.dim
        self._names = OF_SCALARS if self.components == 1 else OF_DISPLACEMENTS
        self.mesh, self.master, self.finite = mesh, region, finite
        self.tied, self.bilateral, self.own_law = tied, bilateral, law is not None
        self.stiffness, self.penetration = stiffness, penetration
        self.gap_is_driven = obstacle is not None or offset is not None
        self.holds_tangentially = tied or any(f is not None for f in (friction, tresca, law))
        self._state = FormState(setup, stiffness)
        self.space, self.layout = self.form.space, LayoutOf(self.form.fes)
        self._unheld = WarnOfUnheld(self.form.component)
        if region is not None:
            there = Compiled(self.form)
            CheckMoves(self.facing, there.fes, there.component)
            together = tied or bilateral
            if together or not finite:
                remedy = COMES_OFF if together else SELF
                CheckDistinct(self.surface.slave, self.facing, remedy)
        self._solution = self._accepted = None  # entries at the last evaluation, and `Commit`
        self._placement = self.tool and self.tool.placement  # of the last `Commit`, too
        self._MakeFields()

    @property
    def form(self) -> ContactForm:
        """The compiled form."""
        return self._state.form

    # --- the form ------------------------------------------------------------------------------

    @property
    def mat(self) -> BaseMatrix:
        """Matrix of the last `AssembleLinearization`, on the scalar dofs of the product space."""
        return self.form.mat

    @property
    def surface(self) -> LACSpace:
        """The LACSpace on a mesh that each process has as a whole; in one process `space`."""
        return Compiled(self.form).space

    @property
    def facing(self) -> Region:
        """The master, a Region or None, on the mesh of `surface`."""
        return RegionOn(self.form, self.master)

    @property
    def nscalars(self) -> int:
        """Number of scalar entries of a vector on the product space."""
        return self.form.fes.ndof * self.form.fes.dim

    @OnAll(MeshOf)
    def Update(self, gf: GridFunction | None = None) -> None:
        """Pair the surfaces in the configuration of `gf` (on the product space); None: reference.

        Weights, normals and partners stay fixed until the next call; slip and ties count from here.

        Parameters
        ----------
        gf : GridFunction, optional
        """
        self._Pair(gf)

    def _Pair(self, gf: GridFunction | None, active: bool | None = None) -> None:
        """Pair the surfaces at a solution, or in the reference configuration."""
        if gf is not None:
            CheckOnSpace("gf", gf, self.form.fes)

        def change() -> None:
            self._state.Pair(gf, active=active)
            self._solution = self._accepted = None

        self._Change(self._state.FormKept(), change)

    @property
    def active(self) -> bool:
        """Is it switched on?"""
        return self.form.active

    def _PairOnce(self) -> None:
        if self.form.paired:
            self.form.CheckPaired()
        else:
            self.Update()

    @property
    def prepared(self) -> bool:
        """Is its scale that of a bulk, since the last `Update`?"""
        return self.form.paired and self._state.scaled

    @OnAll(MeshOf)
    def Prepare(self, bulk: BaseMatrix, *, form: BilinearForm | BaseMatrix | None = None) -> None:
        """Pair if that was not done, and look at the stiffness of both bodies in the bulk's matrix.

        It sets the scale of the form and the contact direction, once after each `Update`; fields
        and `Table` show that direction from the next `Evaluate` on.

        Parameters
        ----------
        bulk : BaseMatrix
            On the product space.
        form : BilinearForm or BaseMatrix, optional
            The bulk without inertia. Its elements determine which body is the stiffer one, and so
            the contact direction; so does a matrix, unless something is condensed.

        Raises
        ------
        TypeError, ValueError
            `bulk` is no matrix; `form` is no BilinearForm, or lives on another space.
        """
        CheckInstance("bulk", bulk, BaseMatrix, "a matrix on the product space, such as a.mat")
        if form is not None:
            CheckInstance("form", form, (BilinearForm, BaseMatrix), "the bulk as a BilinearForm")
            if isinstance(form, BilinearForm) and form.space != self.form.fes:
                raise ValueError("form lives on another space than u and lam: take the bulk")
        self._PairOnce()
        self._state.Scale(bulk, form)

    @OnAll(MeshOf)
    def Follow(self, gf: GridFunction) -> None:
        """With ``finite=True``: pair anew in the configuration of `gf`; else nothing happens.

        The solver calls it for each iterate; slip keeps counting from the last `Commit`. Until the
        next call the quadrature points on the slave and the master faces that they see stay.

        Parameters
        ----------
        gf : GridFunction
            On the product space.
        """
        CheckOnSpace("gf", gf, self.form.fes)
        if self.form.paired:
            self.form.Follow(gf.vec)

    @OnAll(MeshOf)
    def AddApply(self, x: BaseVector, y: BaseVector) -> None:
        """y += residual at x.

        Parameters
        ----------
        x, y : BaseVector
            State and residual (forces, and lengths times areas) on the product space.
        """
        for name, vec in {"x": x, "y": y}.items():
            CheckVector(name, vec, self.nscalars)
        self.form.AddApply(x, y)

    @OnAll(MeshOf)
    def Apply(self, x: BaseVector, y: BaseVector) -> None:
        """y = residual at x, see `LACContact.AddApply`."""
        CheckVector("y", y, self.nscalars)[:] = 0
        self.AddApply(x, y)

    @OnAll(MeshOf)
    def AssembleLinearization(self, x: BaseVector) -> None:
        """Assemble the generalised derivative of the residual into `mat`.

        Parameters
        ----------
        x : BaseVector
            State on the product space.
        """
        self.form.AssembleLinearization(CheckVector("x", x, self.nscalars))

    @OnAll(MeshOf)
    def Commit(self, gf: GridFunction) -> None:
        """Accept `gf` as the end of a step: the next slip increment counts from there.

        A macro-element that is open now counts its slip from the first touch, which is where its
        path of the last step meets the master.

        Parameters
        ----------
        gf : GridFunction
            On the product space.
        """
        CheckOnSpace("gf", gf, self.form.fes)

        def change() -> None:
            self._state.Commit(gf)
            self._solution = self._accepted = self._Entries(gf)
            self._placement = self.tool and self.tool.placement

        self._Change(self._state.WholeOrNot(gf), change)

    @OnAll(MeshOf)
    def Evaluate(self, gf: GridFunction) -> None:
        """Fill the fields pressure, traction, gap, slip, status and normal from `gf`.

        After a `Commit` of the same `gf` the slip is 0: it counts from there.

        Parameters
        ----------
        gf : GridFunction
            On the product space.
        """
        self.form.Evaluate(CheckOnSpace("gf", gf, self.form.fes).vec)
        self._solution = self._Entries(gf)
        self._Fill()

    def _Entries(self, gf: GridFunction) -> np.ndarray:
        return self.layout.Values(gf.vec).copy()

    def _Sizes(self) -> np.ndarray:
        """How large macro-elements are (m,): lengths."""
        return self.form.Table()["size"]

    def _OnTool(self, placement: tuple[np.ndarray, np.ndarray]) -> np.ndarray:
        """Where macro-elements are (m, d) as seen from the tool at a placement."""
        turn, shift = placement
        return (self.Table()["x"] - shift) @ turn

    def _Depths(self) -> np.ndarray:
        """How deep macro-elements (m,) lie inside of what they face where they do not see it."""
        if self.master is not None:
            return np.asarray(self.form.Overlaps())
        table = self.Table()
        if self.tool is None or len(self.form.ToolDofs()):
            return np.zeros(len(table["area"]))
        depths = -self.tool.Distance(table["x"])
        unseen = table["area"] < 0.5 * table["fullarea"]
        return np.where(unseen & (depths > self._Sizes()), depths, 0.0)

    def _Slid(self) -> np.ndarray:
        """How far macro-elements (m, d) moved along the master since they were paired.

        Zero with large sliding, which pairs anew, and for obstacles, whose gap is known anywhere.
        """
        table, moved = self.Table(), self._state.Displacement(self._solution)
        if self.finite or self.tied or self.master is None or moved is None:
            return np.zeros_like(table["normal"])
        values = LayoutOf(moved.space).Values(moved.vec)
        jump = JumpRows(self.form, Side.both) @ values
        with np.errstate(divide="ignore", invalid="ignore"):
            mean = jump.reshape(table["normal"].shape) / table["area"][:, None]
        mean[table["area"] == 0] = 0
        along = np.sum(mean * table["normal"], axis=1)[:, None]
        return mean - along * table["normal"]

    def _ClearOpen(self, gf: GridFunction) -> None:
        """Set tractions of open macro-elements in the solution evaluated last to exactly zero."""
        is_open = self.Table()["status"] == 0
        dofs = self.form.MultiplierDofs().reshape(len(is_open), -1)[is_open]
        self.layout.Values(gf.vec)[dofs] = 0

    @OnAll(MeshOf)
    def Restore(self) -> None:
        """Fields, table, pairing and resultants as at the last `Commit`."""
        self.form.Restore()
        self._solution = self._accepted
        self._Fill()

    def State(self) -> dict:
        """What later steps depend on, as a dict of numpy arrays: save it to go on in a new process.

        Restore it with `SetState` on a contact that was built in the same way.

        Returns
        -------
        dict
        """
        return self._state.State()

    @OnAll(MeshOf)
    def SetState(self, state: dict, gf: GridFunction | None = None) -> None:
        """Pair in the saved configuration and take over the saved history.

        Parameters
        ----------
        state : dict
            Of `State`.
        gf : GridFunction, optional
            The solution then, on the product space. Without it the fields of ``finite=True`` are
            those of the last `Commit`.

        Raises
        ------
        TypeError, ValueError, ngsolve.NgException
            The state is none, or that of another contact. Nothing is changed then.
        """
        CheckSaved(state)
        if gf is not None:
            CheckOnSpace("gf", gf, self.form.fes)
        kept = self._state.FormKept() if self._state.follows else self._state.WholeOrNot(gf)

        def change() -> None:
            self._state.SetState(state, gf)
            self._solution = self._accepted = None if gf is None else self._Entries(gf)

        self._Change(kept, change)

    @OnAll(MeshOf)
    def Deactivate(self) -> None:
        """Switch the contact off: from the next solve on there are no forces between the surfaces.

        All macro-elements are open, and without a partner. Between steps, not within one.

        Examples
        --------
        >>> contact.Deactivate()
        >>> contact.active
        False
        >>> contact.Activate()
        """
        self.form.SetActive(False)
        self._Fill()

    @OnAll(MeshOf)
    def Activate(self, gf: GridFunction | None = None) -> None:
        """Switch the contact on: it pairs anew, and slip and ties count from there, as of `Update`.

        Parameters
        ----------
        gf : GridFunction, optional
            The solution now, on the product space; None: the reference.
        """
        self._Pair(gf, active=True)

    # --- fields, which follow the form ---------------------------------------------------------

    def _MakeFields(self) -> None:
        """New ones, of one number or one vector per macro-element."""
        for count, names in ((1, self._names.scalars), (self.mesh.dim, self._names.vectors)):
            space = self.space.WithComponents(count)
            for name in names:
                setattr(self, name, GridFunction(space, name=name))

    def _Fill(self) -> None:
        """Take the numbers of the form; 0 where it is not paired."""
        self._recovered = None
        table = self.Table() if self.form.paired else {}
        for name in self._names.scalars + self._names.vectors:
            values = table[name].ravel() if table else 0.0
            getattr(self, name).vec.FV().NumPy()[:] = values

    def _Change(self, kept: AbstractContextManager, change: Callable[[], object]) -> None:
        """Call `change` in the context `kept`: a failure or an interrupt changes nothing."""
        fits = len(self.status.vec) == self.space.nmacros
        if self._state.refined or not fits:  # no way back
            change()
            self._MakeFields()
            self._Fill()
            return
        before = self._solution, self._accepted
        try:
            with kept:
                try:
                    change()
                    self._Fill()
                except BaseException:
                    self._solution, self._accepted = before
                    raise
        except BaseException:
            self._Fill()
            raise

    # --- results -------------------------------------------------------------------------------

    def _GetWebguiData(self) -> dict:
        return self.Segments()._GetWebguiData()

    __repr__ = results.Describe
    Table = results.Table
    Flow = results.Flow
    Force = results.Force
    Moment = results.Moment
    Mortar = results.Mortar
    Recovered = results.RecoveredOf
    _WarnIfUnsolved = results.WarnIfUnsolved
    Segments = results.SegmentsOf
    Check = results.Check
    Draw = scene.Draw
    Plot = pictures.Plot
    WriteVTU = OnAll(MeshOf)(pictures.WriteVTU)
