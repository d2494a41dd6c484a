"""Laws that soften faster than the bodies unload: the state jumps, and is found.

A ball that snaps off is a case of the validation report, "adhesion".
"""

import numpy as np
import pytest
import scipy.sparse
from blocks import C, block_mesh, contact_form
from form import Form
from netgen.occ import Compound, OCCGeometry, Rectangle, Y
from ngsolve import (
    CF,
    BilinearForm,
    Grad,
    GridFunction,
    IfPos,
    InnerProduct,
    Mesh,
    Parameter,
    Sym,
    VectorH1,
    ds,
    dx,
    exp,
    pi,
    sqrt,
    x,
)
from posed import elastic, posed
from scipy.optimize import minimize

from ngslac import ContactSolver, LACContact, LACSpace, Law, LoadStepper
from ngslac.materials import Stress
from ngslac.meshes import TwoBlocks

FIRST, LAST, STRENGTH = 1e-3, 0.05, 1.0


def glue(z):
    """Bilinear, with a memory; stiff under pressure. It takes STRENGTH LAST / 2 per area."""
    opening = -InnerProduct(z.jump, z.normal)
    apart = IfPos(opening, opening, 0)
    far = z.History("far", lambda f: IfPos(apart - f, apart, f), start=FIRST)
    whole = IfPos(LAST - far, FIRST / far * (LAST - far) / (LAST - FIRST), 0)
    pressed = (1 - whole) * IfPos(opening, 0, opening) * z.normal
    return -STRENGTH / FIRST * (whole * z.jump - pressed)


def pull(young, mesh=None, held="bottom|top", **how):
    """Two glued blocks of height 1 that are pulled apart by .2; forces and openings by the way."""
    mesh = mesh or TwoBlocks(0.5)
    V = VectorH1(mesh, order=2, dirichlet=held)
    problem = posed(V, elastic(young), load=Parameter(0), tied=True, law=Law(glue))
    moves = {name: CF((0, problem.load if name == "top" else 0)) for name in held.split("|")}
    steps = problem.stepper(prescribe=moves).Integrate(0.2, printing=False, **how)
    return problem.contact, steps


@pytest.mark.parametrize("young", [12.0, 40.0, 400.0])
def test_glue_that_tears(young):
    """Where the blocks give more than the glue, it tears from one state to the next."""
    contact, steps = pull(young, steps=40)
    force = -np.array([step.forces[0][1] for step in steps])
    way = np.array([step.time for step in steps])
    tears, gives = STRENGTH * 2 / young + FIRST, 2 / young + FIRST / STRENGTH
    rest = (LAST - way) / (LAST - FIRST - 2 * STRENGTH / young) * STRENGTH  # if it is stable
    expected = np.where(way < tears, way / gives, np.maximum(rest, 0) if young > 41 else 0)
    assert force == pytest.approx(expected, abs=1e-8)
    assert contact.Table()["far"].min() > LAST
    assert sum(step.cuts for step in steps) == 0


@pytest.mark.sample(2)
@pytest.mark.parametrize("young", [12.0, 14.0, 20.0, 60.0])
def test_glue_that_shears_as_it_tears(young):
    """A block that is narrower than the other: damage by opening takes the shear stiffness, too."""
    lower, upper = Rectangle(1, 1).Face().Move((0, -1, 0)), Rectangle(0.9, 1).Face()
    upper = upper.Move((0.05, 0, 0))
    for body, near, far in ((lower, Y, -Y), (upper, -Y, Y)):
        body.edges.name = "side"
        body.edges.Max(near).name = "master" if body is lower else "slave"
        body.edges.Max(far).name = "held" if body is lower else "top"
        body.edges.Max(near).maxh = 0.23 if body is lower else 0.2
    mesh = Mesh(OCCGeometry(Compound([lower, upper]), dim=2).GenerateMesh(maxh=0.5))
    contact, steps = pull(young, mesh=mesh, held="held|top", steps=20)
    assert steps[0].forces[0][1] < 0
    assert abs(steps[-1].forces[0][1]) < 1e-8
    assert contact.Table()["far"].min() > LAST


def tilts(spring, ways, count=8):
    """Forces on a rigid block of length 1 that a spring pulls off: the least energy near by."""
    middles = (np.arange(count) + 0.5) / count - 0.5

    def energy(motion, way):
        gap = motion[0] + motion[1] * middles
        soft = np.clip(gap, FIRST, LAST) - FIRST
        area = np.where(gap < FIRST, gap**2 / 2 / FIRST, FIRST / 2 + soft)
        area -= soft**2 / 2 / (LAST - FIRST)
        pulled = (way - motion[0]) ** 2 + spread * motion[1] ** 2
        return spring / 2 * pulled + STRENGTH * area.mean()

    spread = 0.1**2 / 2  # of the spring
    motion, forces = (0.0, 0.01), []
    for way in ways:
        options = {"xatol": 1e-10, "fatol": 1e-15, "maxiter": 4000}
        start = motion[0], motion[1] + 0.002  # beside what may be a saddle
        motion = minimize(energy, start, args=(way,), method="Nelder-Mead", options=options).x
        forces.append(spring * (way - motion[0]))
    return forces


def test_a_block_that_is_pulled_off_tilts():
    """It might come off evenly, too, but that is no state of least energy."""
    block = Rectangle(1, 0.5).Face()
    block.edges.name = "free"
    block.edges.Min(Y).name, block.edges.Max(Y).name = "slave", "top"
    block.edges["slave"].maxh = 1 / 8
    mesh = Mesh(OCCGeometry(block, dim=2).GenerateMesh(maxh=0.3))
    V = VectorH1(mesh, order=2)
    fes = V * LACSpace(V, slave="slave")
    (u, lam), (v, _) = fes.TnT()
    a, way, spring = BilinearForm(fes), Parameter(0), 100.0
    a += InnerProduct(Stress(Sym(Grad(u)), 1e5, 0.0), Sym(Grad(v))) * dx
    middle = exp(-(((x - 0.5) / 0.1) ** 2)) / (0.1 * sqrt(pi))
    a += spring * middle * (u[1] - way) * v[1] * ds("top", bonus_intorder=20)
    a += 1e-3 * u[0] * v[0] * ds("top")

    def sticky(z):
        far = IfPos(z.gap - FIRST, z.gap, FIRST)
        whole = IfPos(LAST - far, FIRST / far * (LAST - far) / (LAST - FIRST), 0)
        return STRENGTH / FIRST * whole * z.gap * z.normal - z.slip

    gf = GridFunction(fes)
    contact = LACContact(u, lam, obstacle=0.0, law=Law(sticky))
    stepper = LoadStepper(ContactSolver(a, gf, contact), way)
    ways, forces = np.arange(1, 16) * 0.002, []
    for goal in ways:
        stepper.Integrate(goal, steps=1, printing=False)
        forces.append(-contact.Force()[1])
    assert forces == pytest.approx(tilts(spring, ways), abs=0.003)
    ends = [gf.components[0](mesh(place, 0.01))[1] for place in (0.02, 0.98)]
    assert abs(ends[1] - ends[0]) > 0.05


@pytest.mark.parametrize("dim", [2, 3])
def test_the_matrix_of_a_descent_does_not_soften(dim):
    """It is that of the same law without the negative part of its stiffness, if that has energy."""
    random = np.random.default_rng(3).normal(size=(2, dim, dim))
    stiffness = random[0] + random[0].T
    sizes, directions = np.linalg.eigh(-stiffness)
    assert sizes.min() < 0 < sizes.max()
    positive = stiffness + directions @ np.diag(np.minimum(sizes, 0)) @ directions.T

    def matrix(by_jump, convex, pressure=0.0):
        def law(places):
            jump, pushes = places["jump"], pressure * places["normal"]
            derivative = np.broadcast_to(by_jump, (len(jump), dim, dim))
            return {"traction": jump @ stiffness.T - pushes, "by_jump": derivative}

        mesh = block_mesh(dim) if dim == 2 else block_mesh(dim, "hex", "tet", 2, 1)
        form = Form(contact_form(mesh, law=law, tied=True))
        form.bend(0.02, 0.01, seed=1)
        form.contact.form.SetConstant(C)
        form.contact.form.AssembleStep(form.gf.vec, form.gf.vec.CreateVector(), convex)
        rows, columns, values = (np.array(a) for a in form.contact.mat.COO())
        return scipy.sparse.csc_matrix((values, (rows, columns)), shape=2 * (len(form.values),))

    softening, plain = matrix(stiffness, True), matrix(positive, False)
    assert abs(softening - plain).max() < 1e-12 * abs(plain).max()
    assert abs(matrix(stiffness, False) - plain).max() > 1e-3 * abs(plain).max()
    rubs = stiffness + 10 * (random[1] - random[1].T)
    assert abs(matrix(rubs, True, 1e3) - matrix(rubs, False, 1e3)).max() == 0
