"""The problems of `classes.py`: bodies in contact of every kind, beside them linear elasticity."""

from __future__ import annotations

import importlib
import sys
from collections.abc import Callable
from dataclasses import dataclass, field
from itertools import product
from pathlib import Path

import numpy as np
from benchmark_problems import NU, PRESSURE, SHEAR
from netgen.meshing import Mesh as NetgenMesh
from ngsolve import (
    CF,
    H1,
    L2,
    VOL,
    BilinearForm,
    Grad,
    GridFunction,
    Id,
    IfPos,
    InnerProduct,
    LinearForm,
    Mesh,
    Parameter,
    Sym,
    Variation,
    VectorH1,
    div,
    ds,
    dx,
    sin,
    x,
    y,
    z,
)

from ngslac import LACContact, LACSpace
from ngslac.materials import NeoHooke, Stress
from ngslac.meshes import TwoBlocks, TwoBlocks3D
from ngslac.meshes.boxes import StructuredBox

__all__ = [
    "Blocks",
    "Bodies",
    "Checkerboard",
    "Cubes",
    "Plates",
    "Ring",
    "Sheets",
    "Sliding",
    "Strips",
]

CELLS = 4  # of the checkerboard, along a block
PUSHED = (0.15, 0.05, -0.04)  # of the upper block in large sliding


@dataclass(frozen=True)
class Bodies:
    """Elastic bodies in contact; the methods are those of `benchmark_problems.Problem`.

    Attributes
    ----------
    mesh : callable
        Makes the mesh.
    supports : dict
        Flags of the displacement space.
    held : str
        Boundaries that are held in the elastic problem.
    tractions : dict
        Boundary -> load on it.
    young : callable or dict
        Of the mesh; or material -> value.
    pairs : list of (str, str)
        Slave and master of each contact.
    law : dict
        Options of LACContact.
    flags : dict
        Of the bulk's form.
    mixed : {None, "h1", "l2"}
        Space of a pressure beside the displacement.
    moved : tuple or None
        Displacement of the boundary "top", in large sliding of neo-Hookean bodies.
    velocity : tuple or None
        Of the material "upper" at the start.
    """

    mesh: Callable
    supports: dict
    held: str
    tractions: dict
    young: Callable | dict
    order: int = 2
    nu: float = NU
    pairs: tuple = (("slave", "master"),)
    law: dict = field(default_factory=lambda: {"friction": 0.3})
    flags: dict = field(default_factory=dict)
    mixed: str | None = None
    moved: tuple | None = None
    velocity: tuple | None = None

    def Mesh(self):
        return self.mesh()

    def Product(self, mesh):
        V = VectorH1(mesh, order=self.order, **self.supports)
        return self._WithPressure(V, [LACSpace(V, slave=slave) for slave, _ in self.pairs])

    def _WithPressure(self, V, spaces=()):
        fes = V
        if self.mixed:
            fes *= H1(V.mesh, order=self.order - 1) if self.mixed == "h1" else L2(V.mesh, order=0)
        for space in spaces:
            fes *= space
        return fes

    def Contact(self, fes):
        """Bulk with load, contacts, load factor, solution."""
        trial, test = fes.TnT()
        count, load = 1 + bool(self.mixed), Parameter(0.0)
        a = BilinearForm(fes, **self.flags)
        for form in self._Bulk(fes.mesh, trial[:count], test[:count]):
            a += form
        for name, traction in self.tractions.items():
            a += -load * InnerProduct(CF(traction), test[0]) * ds(name)
        contacts = [
            LACContact(trial[0], lam, master=master, **self.law)
            for lam, (_, master) in zip(trial[count:], self.pairs, strict=True)
        ]
        return a, contacts, load, GridFunction(fes)

    def Elastic(self, mesh):
        """Form and load of linear elasticity on the same mesh with all bodies held."""
        fes = self._WithPressure(VectorH1(mesh, order=self.order, dirichlet=self.held))
        trial, test = fes.TnT()
        trial, test = (trial, test) if self.mixed else ([trial], [test])
        a, f, last = BilinearForm(fes), LinearForm(fes), mesh.dim - 1
        for form in self._Linear(mesh, trial, test):
            a += form
        for slave, master in self.pairs:
            f += test[0][last] * ds(slave) - test[0][last] * ds(master)
        return a, f.Assemble()

    def _Bulk(self, mesh, trial, test):
        if self.moved is None:
            return self._Linear(mesh, trial, test)
        energy = NeoHooke(Id(mesh.dim) + Grad(trial[0]), self._Young(mesh), self.nu)
        return [Variation(energy.Compile() * dx)]

    def _Linear(self, mesh, trial, test):
        young, strain = self._Young(mesh), Sym(Grad(test[0]))
        if not self.mixed:
            return [InnerProduct(Stress(Sym(Grad(trial[0])), young, self.nu), strain) * dx]
        (u, p), (v, q) = trial, test
        shear = young / (2 * (1 + self.nu))
        bulk = young * self.nu / ((1 + self.nu) * (1 - 2 * self.nu))
        mixed = 2 * shear * InnerProduct(Sym(Grad(u)), strain) + p * div(v) + q * div(u)
        return [(mixed - p * q / bulk) * dx]

    def _Young(self, mesh):
        return mesh.MaterialCF(self.young) if isinstance(self.young, dict) else self.young(mesh)


# ---------------------------------------------------------------- two blocks


def Blocks(kind, n, layers, *, young=(2000.0, 4000.0), **options):
    """One block on another, with n and n + 1 divisions, pressed and pushed on its top."""
    return Bodies(
        lambda: TwoBlocks3D(kind, n_slave=n, n_master=n + 1, layers=(layers, layers)),
        {"dirichlet": "bottom"},
        "bottom|top",
        {"top": (*SHEAR, -PRESSURE)},
        young if callable(young) else dict(zip(("upper", "lower"), young, strict=True)),
        **options,
    )


def Checkerboard(n, layers, *, aligned, contrast=1e4):
    """Blocks of stiff and soft cells in turn; each element has one stiffness if `aligned`."""
    sign = sin(CELLS * np.pi * x) * sin(CELLS * np.pi * y) * sin(CELLS * np.pi * z)
    young = 2000.0 * IfPos(sign, 1.0, contrast)

    def OfElements(mesh):
        values = GridFunction(L2(mesh, order=0))
        middles = [np.mean([mesh[v].point for v in e.vertices], axis=0) for e in mesh.Elements(VOL)]
        stiff = np.prod(np.sin(CELLS * np.pi * np.array(middles)), axis=1) < 0
        values.vec.FV().NumPy()[:] = 2000.0 * np.where(stiff, contrast, 1.0)
        return values

    return Blocks("tet", n, layers, young=OfElements if aligned else lambda mesh: young)


def Plates(n, thickness=0.02, **options):
    """One cantilever on another, bent together by a pressure."""
    return Bodies(
        lambda: TwoBlocks3D("tet", n_slave=n, n_master=n + 1, height=thickness),
        {"dirichlet": "left_upper|left_lower"},
        "left_upper|left_lower",
        {"top": (0, 0, -50.0 * thickness**3)},
        {"upper": 2000.0, "lower": 4000.0},
        **options,
    )


def Sliding(n, m, layers):
    """A neo-Hookean block is pushed over a wider one, whose elements are larger."""
    options = {"overhang": 0.5, "aligned": False, "layers": (layers, layers)}
    return Bodies(
        lambda: TwoBlocks3D("tet", n_slave=n, n_master=m, **options),
        {"dirichlet": "bottom|top"},
        "bottom|top",
        {},
        {"upper": 2000.0, "lower": 4000.0},
        law={"friction": 0.3, "finite": True},
        moved=PUSHED,
    )


def Strips(h, **options):
    """One block on another in 2D, which hits it."""
    return Bodies(
        lambda: TwoBlocks(h, 0.9 * h),
        {"dirichlet": "bottom"},
        "bottom|top",
        {},
        {"upper": 2000.0, "lower": 4000.0},
        velocity=(0.2, -1.0),
        **options,
    )


# ---------------------------------------------------------------- many bodies


def Cubes(n, count=3):
    """count^3 cubes with n and n + 1 divisions in turn, pressed from three sides and pushed."""
    sides = {"right": (-20.0, 0, 0), "back": (0, -20.0, 0), "top": (*SHEAR, -PRESSURE)}
    return Bodies(
        lambda: CubeMesh(n, count),
        {"dirichletx": "left", "dirichlety": "front", "dirichletz": "bottom"},
        "left|front|bottom|master",
        sides,
        {"odd": 2000.0, "even": 4000.0},
        pairs=(("slave", "master"),),
        law={"friction": 0.3, "maxdist": 0.5},  # not the far side of the next cube
    )


def CubeMesh(n, count):
    ngmesh = NetgenMesh(dim=3)
    for cell in product(range(count), repeat=3):
        parity = sum(cell) % 2
        grid = [np.linspace(c, c + 1, n + 1 + parity) for c in cell]
        names = lambda side, _, cell=cell: CubeSide(side, cell, count)  # noqa: E731
        StructuredBox(*grid, "tet", names=names).AddTo(ngmesh, ("even", "odd")[parity])
    ngmesh.Compress()
    return Mesh(ngmesh)


LOW, HIGH = ("left", "front", "bottom"), ("right", "back", "top")


def CubeSide(side, cell, count):
    """An outer side keeps its name, others are slave or master of the next cube."""
    low = side in LOW
    number = cell[(LOW if low else HIGH).index(side)]
    if number == (0 if low else count - 1):
        return side
    return "master" if low else "slave"


def Sheets(n, count=8, thickness=0.1):
    """A pile of sheets of one layer of elements, with n and n + 1 divisions in turn."""
    return Bodies(
        lambda: SheetMesh(n, count, thickness),
        {"dirichlet": "bottom"},
        "bottom|top|slave.*",
        {"top": (*SHEAR, -PRESSURE)},
        {"odd": 2000.0, "even": 4000.0},
        pairs=tuple((f"slave{k}", f"master{k}") for k in range(1, count)),
    )


def SheetMesh(n, count, thickness):
    ngmesh = NetgenMesh(dim=3)
    for k in range(count):
        line = np.linspace(0, 1, n + 1 + k % 2)
        ends = {"bottom": f"slave{k}" if k else "bottom"}
        ends["top"] = f"master{k + 1}" if k < count - 1 else "top"
        names = lambda side, _, ends=ends: ends.get(side, "side")  # noqa: E731
        height = thickness * np.array([k, k + 1])
        box = StructuredBox(line, line, height, "tet", names=names)
        box.AddTo(ngmesh, ("even", "odd")[k % 2])
    ngmesh.Compress()
    return Mesh(ngmesh)


# ---------------------------------------------------------------- self-contact


@dataclass(frozen=True)
class Ring:
    """The rubber ring of `tutorials/examples/flatring.py`, pressed until its inside touches."""

    h: float
    travel: float = 1.71

    def Mesh(self):
        return Example("flatring").RingMesh(self.h, 0.15, False)

    def Press(self, steps):
        """Solver and converged steps."""
        stepper, *_ = Example("flatring").Problem(self.h)
        return stepper.solver, stepper.Integrate(self.travel, steps=steps, printing=False)

    def Elastic(self, mesh):
        held, pairs = "fixed|plate|outer", (("inner", "plate"),)
        given = self.Mesh, {}, held, {}, lambda _: CF(2.75)  # Lame's parameters 3 and 1
        return Bodies(*given, nu=0.375, pairs=pairs).Elastic(mesh)


def Example(name):
    """A script of the tutorials, as a module."""
    folder = str(Path(__file__).parents[2] / "tutorials/examples")
    if folder not in sys.path:
        sys.path.append(folder)
    return importlib.import_module(name)
