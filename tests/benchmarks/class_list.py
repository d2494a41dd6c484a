"""The classes of problems that `classes.py` measures, and the way to the solution of each."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from functools import partial

from benchmark_problems import SIZES, Problem
from class_problems import Blocks, Checkerboard, Cubes, Plates, Ring, Sheets, Sliding, Strips
from ngsolve import CF

from ngslac import AugmentedLagrangianSolver, ContactSolver, LoadStepper, TimeStepper

__all__ = ["CLASSES", "Class"]

NEWTON, STEPS = {"per": "newton"}, {"per": "step", "steps": 5}


# ---------------------------------------------------------------- ways to the solution


def Load(case, problem, mesh):
    """Load steps: solver and converged steps."""
    fes = problem.Product(mesh)
    a, contacts, load, gf = problem.Contact(fes)
    solver = case.solver(a, gf, contacts, **case.options)
    moved = getattr(problem, "moved", None)
    prescribe = {"top": load * CF(moved)} if moved else None
    stepper = LoadStepper(solver, load, prescribe=prescribe)
    return solver, stepper.Integrate(1.0, steps=case.steps, printing=False)


def Fly(case, problem, mesh):
    """Steps of time while the upper body, which is under way, meets the lower one."""
    fes = problem.Product(mesh)
    a, contacts, _, gf = problem.Contact(fes)
    solver, dt = case.solver(a, gf, contacts), case.options["dt"]
    stepper = TimeStepper(solver, 1.0, dt=dt)
    start = mesh.MaterialCF({"upper": problem.velocity}, default=(0,) * mesh.dim)
    stepper.velocity.components[0].Set(start)
    return solver, stepper.Integrate(case.steps * dt, printing=False)


def Press(case, problem, _):
    """The ring."""
    return problem.Press(case.steps)


@dataclass(frozen=True)
class Class:
    """A class of problems: its problem, a small one, steps, options of the solver."""

    make: Callable
    quick: Callable
    run: Callable = Load
    steps: int = 1
    per: str = "run"
    solver: Callable = ContactSolver
    options: dict = field(default_factory=dict)


def Two(full, quick, **options):
    """Two blocks of tetrahedra, of these divisions and layers."""
    return {"make": partial(Blocks, "tet", *full, **options)} | {
        "quick": partial(Blocks, "tet", *quick, **options)
    }


def Standard(name, size, friction=0.3, **options):
    """A problem of `scaling.py`."""
    small = partial(Problem, name, min(SIZES[name]), friction)
    return Class(partial(Problem, name, size, friction), small, **options)


def Kind(kind, full, **options):
    small = partial(Blocks, kind, 2, 1, **options)
    return Class(partial(Blocks, kind, *full, **options), small)


def Pressed(h):
    return Class(partial(Ring, h), partial(Ring, 0.3, travel=0.05), run=Press, steps=38)


def Sized(make, full, quick, **options):
    return Class(partial(make, *full, **options), partial(make, *quick, **options))


MEDIUM, LARGE = (7, 6), (12, 12)  # 20,000 and 100,000 displacements of second order
TINY = (2, 2)
CLASSES = {
    "sphere frictionless": Standard("sphere", 100_000, 0.0),
    "sphere friction": Standard("sphere", 100_000),
    "sphere ten steps": Standard("sphere", 100_000, steps=10),
    "sphere 284k friction": Standard("sphere", 300_000),
    "two blocks": Class(**Two(LARGE, TINY)),
    "order 3": Kind("tet", (8, 8), order=3),
    "order 4": Kind("tet", (5, 6), order=4),
    "hexahedra order 2": Kind("hex", LARGE),
    "hexahedra order 3": Kind("hex", (8, 8), order=3),
    "prisms": Kind("prism", LARGE),
    "27 cubes": Sized(Cubes, (4,), (1, 2)),
    "eight sheets": Sized(Sheets, (20,), (2, 3)),
    "soft slave on 1e4": Class(**Two(LARGE, TINY, young=(2000.0, 2e7))),
    **{
        f"slave stiffer by {ratio:g}": Class(**Two(MEDIUM, TINY, young=(4000.0 * ratio, 4000.0)))
        for ratio in (10, 100, 1000, 1e4)
    },
    "checkerboard 1e4, points": Sized(Checkerboard, LARGE, TINY, aligned=False),
    "checkerboard 1e4, elements": Sized(Checkerboard, LARGE, TINY, aligned=True),
    "nu .49": Class(**Two(MEDIUM, TINY, nu=0.49)),
    "nu .4999": Class(**Two(MEDIUM, TINY, nu=0.4999)),
    "mixed u-p, H1": Class(**Two(MEDIUM, TINY, nu=0.4999, mixed="h1")),
    "mixed u-p, L2": Class(**Two(MEDIUM, TINY, nu=0.4999, mixed="l2")),
    "first-order tetrahedra": Class(**Two((24, 24), (4, 3), order=1)),
    "first-order hexahedra": Sized(Blocks, ("hex", 24, 24), ("hex", 4, 3), order=1),
    "thin plates friction": Sized(Plates, (14,), (3,)),
    "thin plates frictionless": Sized(Plates, (14,), (3,), law={}),
    "finite sliding 18k": Class(partial(Sliding, 5, 9, 6), partial(Sliding, 3, 5, 2), **NEWTON),
    "finite sliding 64k": Class(partial(Sliding, 8, 13, 10), partial(Sliding, 3, 5, 2), **NEWTON),
    "condensed order 3": Class(**Two((8, 8), TINY, order=3, flags={"condense": True})),
    "dynamics 3D": Class(
        **Two((7, 7), TINY, velocity=(0.2, 0.0, -1.0)), run=Fly, options={"dt": 3e-3}, **STEPS
    ),
    "dynamics 2D": Class(
        partial(Strips, 0.0164), partial(Strips, 0.3), run=Fly, options={"dt": 2e-4}, **STEPS
    ),
    "self-contact ring .12": Pressed(0.12),
    "self-contact ring .03": Pressed(0.03),
    "hertz 2D ten steps": Standard("hertz", 100_000, 0.2, steps=10),
    "augmented Lagrangian": Class(**Two(MEDIUM, TINY), solver=AugmentedLagrangianSolver),
    "augmented Lagrangian, its peer": Class(**Two(MEDIUM, TINY)),
}
