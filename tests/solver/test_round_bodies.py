"""Round bodies that nothing but contact without friction holds, and piles of them.

What turns them is no contact, whatever its status: they stay where they are, unless a load turns
them. Piles carry their weight, with and without friction, in small and in large sliding.
"""

import warnings

import numpy as np
import pytest
from netgen.occ import Circle, Compound, Cylinder, MoveTo, OCCGeometry, Pnt, Sphere, WorkPlane, Z
from ngsolve import (
    BilinearForm,
    FESpace,
    Grad,
    GridFunction,
    Id,
    Mesh,
    Parameter,
    TaskManager,
    Variation,
    VectorH1,
    dx,
)
from posed import posed
from press import linear

from ngslac import ContactSolver, FloatingBodyError, LACContact, LACSpace, LoadStepper
from ngslac.bodies.bodies import Bodies
from ngslac.bodies.slides import SlidesOf
from ngslac.materials import NeoHooke


def slides_of(shape, dim, h, curve, friction=None):
    """How many motions along all of its surface a body has that touches something everywhere."""
    mesh = Mesh(OCCGeometry(shape, dim=dim).GenerateMesh(maxh=h)).Curve(curve)
    V = VectorH1(mesh, order=2)
    X = V * LACSpace(V, slave=".*")
    (u, lam), (v, _) = X.TnT()
    a = BilinearForm(X)
    a += linear(u, v)
    a.Assemble()
    contact = LACContact(u, lam, obstacle=1.0, friction=friction)
    bodies = Bodies(a.mat, contact, np.array(list(X.FreeDofs())))
    return sum(own.weights.shape[1] for own in SlidesOf(bodies, [contact]))


def ellipse(part):
    return WorkPlane().Ellipse(0.5, 0.5 * (1 - part)).Face()


ROUND = [
    (Circle((0.3, -2), 0.5).Face(), 2, 1),
    (Sphere(Pnt(1, 2, 3), 0.5), 3, 3),
    (Cylinder(Pnt(0, 0, 0), Z, 0.5, 1.2), 3, 1),
    (Circle((0, 0), 1).Face() - Circle((0, 0), 0.6).Face(), 2, 1),
    (Circle((0, 0), 1).Face() - Circle((0.2, 0), 0.5).Face(), 2, 0),
    (ellipse(0.05), 2, 0),
    (MoveTo(0, 0).Rectangle(1, 1).Face(), 2, 0),
]


@pytest.mark.parametrize("curve", [1, 2, 3])
@pytest.mark.parametrize(("shape", "dim", "expected"), ROUND)
def test_motions_along_the_surface(shape, dim, expected, curve):
    assert slides_of(shape, dim, 0.25, curve) == expected


def test_friction_holds_them():
    assert slides_of(ROUND[0][0], 2, 0.25, 2, friction=0.1) == 0


def test_a_square_of_one_element_a_side_is_no_disc():
    assert slides_of(MoveTo(0, 0).Rectangle(1, 1).Face(), 2, 2.0, 1) == 0


def pile(centers, width, *, friction=None, finite=False, neo=True, gap=1e-3, solver=None, torque=0):
    """Discs of radius 1/2 in a box; solver, solution, contacts with the box, load."""
    low = -width / 2 - gap, width + 2 * gap
    box = MoveTo(low[0] - 0.6, -0.6).Rectangle(low[1] + 1.2, 3.2).Face()
    box -= MoveTo(low[0], 0).Rectangle(low[1], 4).Face()
    box.edges.name, box.faces.name, box.faces.maxh = "wall", "box", 0.24
    for edge in box.edges:
        if abs(edge.center.y + 0.6) < 1e-9:
            edge.name = "fix"
    discs = [Circle(center, 0.5).Face() for center in centers]
    for k, disc in enumerate(discs):
        disc.edges.name = disc.faces.name = f"d{k}"
        disc.faces.maxh = 0.16 * (1 + 0.13 * k)
    shapes = OCCGeometry(Compound([box, *discs]), dim=2)
    mesh = Mesh(shapes.GenerateMesh(grading=0.5)).Curve(3)
    V = VectorH1(mesh, order=2, dirichlet="fix")
    others = ["|".join(["wall", *(f"d{i}" for i in range(k))]) for k in range(len(discs))]
    X = FESpace([V, *(LACSpace(V, slave=f"d{k}") for k in range(len(discs)))])
    (u, *lams), (v, *_) = X.TnT()
    weight, a, gf = Parameter(0), BilinearForm(X), GridFunction(X)
    a += Variation(NeoHooke(Id(2) + Grad(u), 1.0, 0.3) * dx) if neo else linear(u, v)
    a += weight * 1e-3 * (v[1] + torque * (Grad(v)[1, 0] - Grad(v)[0, 1])) * dx("d.")
    contacts = [
        LACContact(u, lam, master=other, friction=friction, finite=finite)
        for lam, other in zip(lams, others, strict=True)
    ]
    options = {"solver": solver} if solver else {}
    return ContactSolver(a, gf, contacts, **options), gf, weight, mesh


def settle(case, steps=1):
    made, gf, weight, _ = case
    with warnings.catch_warnings(), TaskManager():
        warnings.simplefilter("ignore")
        LoadStepper(made, weight).Integrate(1, steps=steps, printing=False)
    return gf.components[0].vec.FV().NumPy().copy()


THREE = [(-0.5, 0.5), (0.5, 0.5), (0, 0.5 + np.sqrt(0.75) + 1e-3)]
FIVE = [(-1, 0.5), (0, 0.5), (1, 0.5), (-0.5, 0.502 + np.sqrt(0.75)), (0.5, 0.502 + np.sqrt(0.75))]


def carried(case):
    """What the foot of the box carries of the weight of the discs."""
    made, gf, _, mesh = case
    count = len(made.contacts)
    forces = gf.vec.CreateVector()
    made.a.Apply(gf.vec, forces)
    fixed = GridFunction(gf.space)
    fixed.components[0].Set((0, 1), definedon=mesh.Boundaries("fix"))
    return forces.InnerProduct(fixed.vec) / (-count * np.pi / 4 * 1e-3)


# Each week: large sliding finds its way in stages, up to a minute long.
LONG = [(None, True, True), (0.3, True, True), (0.3, False, True)]
LONG += [(None, False, True), (None, True, False)]
LONG = [pytest.param(*case, marks=pytest.mark.full) for case in LONG]


@pytest.mark.parametrize(
    ("friction", "finite", "neo"), [(None, False, False), (0.3, False, False), *LONG]
)
def test_three_discs_rest_in_a_box(friction, finite, neo):
    case = pile(THREE, 2, friction=friction, finite=finite, neo=neo)
    moved = settle(case)
    assert np.abs(moved).max() < 0.1
    assert abs(carried(case)) == pytest.approx(1, abs=1e-2)


@pytest.mark.full  # three discs take the same ways
@pytest.mark.parametrize("finite", [False, True])
def test_five_discs_rest_in_a_box(finite):
    case = pile(FIVE, 3, finite=finite)
    moved = settle(case, steps=2)
    assert np.abs(moved).max() < 0.1
    assert abs(carried(case)) == pytest.approx(1, abs=1e-2)


@pytest.mark.full  # half a minute
def test_six_discs_in_one_contact_fall_and_spread():
    """All of them slave and master at once; gaps in the pile, and wider ones to the walls."""
    half, gap, high = 3.1, 1.02, 1 + np.sqrt(3)
    spots = [(-2, 1), (0, 1), (2, 1), (-1, high), (1, high), (0, 2 * high - 1)]
    discs = [Circle((gap * x, gap * y), 1).Face() for x, y in spots]
    for disc in discs:
        disc.faces.name, disc.edges.name, disc.faces.maxh = "disc", "round", 0.25
    box = MoveTo(-half - 0.7, -1).Rectangle(2 * half + 1.4, 6).Face()
    box -= MoveTo(-half, 0).Rectangle(2 * half, 6).Face()
    box.faces.name, box.edges.name = "box", "wall"
    mesh = Mesh(OCCGeometry(Compound([*discs, box]), dim=2).GenerateMesh(maxh=0.5)).Curve(2)
    V = VectorH1(mesh, order=2, definedon="disc")

    def rubber(u, v, weight):
        return Variation(NeoHooke(Id(2) + Grad(u), 1000.0, 0.3) * dx("disc"))

    law = {"slave": "round", "master": "round|wall", "finite": True, "friction": 0.1}
    heavy = lambda u, v, weight: weight * v[1] * dx("disc")  # noqa: E731
    problem = posed(V, rubber, heavy, load=Parameter(0), **law)
    problem.stepper().Integrate(1, steps=5, printing=False)
    assert problem.contact.Force(on="wall")[1] == pytest.approx(-6 * np.pi, rel=1e-2)


@pytest.mark.full
def test_all_solvers_leave_the_same_pile():
    one, *others = (settle(pile(THREE, 2, solver=s)) for s in (None, "direct"))
    for other in others:
        assert np.allclose(one, other, atol=1e-8)


def test_a_disc_that_is_turned_is_an_error():
    with pytest.raises(FloatingBodyError, match=r"rotation|turns"):
        settle(pile(THREE, 2, torque=0.1))
