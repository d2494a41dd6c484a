"""Laws that soften faster than the bodies unload: the state jumps, and is found."""

import numpy as np
import pytest
import scipy.sparse
from blocks import C, block_mesh, contact_form
from form import Form
from netgen.occ import MoveTo, OCCGeometry
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
    dx,
    pi,
    x,
)

from ngslac import ContactSolver, LACContact, LACSpace, Law, LoadStepper, tools
from ngslac.materials import AxisymmetricGrad, Stress
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


def pull(young, **how):
    """Two glued blocks of height 1 that are pulled apart by .2; forces and openings by the way."""
    mesh = TwoBlocks(0.5)
    V = VectorH1(mesh, order=2, dirichlet="bottom|top")
    fes = V * LACSpace(V, slave="slave")
    (u, lam), (v, _) = fes.TnT()
    a = BilinearForm(fes)
    a += InnerProduct(Stress(Sym(Grad(u)), young, 0.0), Sym(Grad(v))) * dx
    contact = LACContact(u, lam, master="master", tied=True, law=Law(glue))
    gf, way = GridFunction(fes), Parameter(0)
    held = {"top": CF((0, way)), "bottom": CF((0, 0))}
    stepper = LoadStepper(ContactSolver(a, gf, contact), way, prescribe=held)
    steps = stepper.Integrate(0.2, printing=False, **how)
    return contact, steps


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


def test_a_ball_snaps_off():
    """Adhesion: the pull-off force, then nothing, under a displacement that is prescribed."""
    radius, modulus, size = 1.0, 1.0, 0.1
    work = 2 * modulus * size**3 / (9 * pi * radius**2)
    peak = 3 / (9 * radius / (2 * pi * work * modulus**2)) ** (1 / 3)
    first, last = peak * size / 1e3 / modulus, 2 * work / peak
    block = MoveTo(0, -1).Rectangle(1, 1).Face()
    block.edges.name = "free"
    for edge in block.edges:
        if edge.center.x < 1e-9:
            edge.name = "axis"
        elif edge.center.y > -1e-9:
            edge.name = "slave"
        elif edge.center.y < -1 + 1e-9:
            edge.name = "bottom"
    for vertex in block.vertices:
        vertex.maxh = 0.003 if abs(vertex.p.x) + abs(vertex.p.y) < 1e-9 else 0.1
    mesh = Mesh(OCCGeometry(block, dim=2).GenerateMesh(maxh=0.1, grading=0.05))
    V = VectorH1(mesh, order=2, dirichlet="bottom", dirichletx="axis")
    fes = V * LACSpace(V, slave="slave", axisymmetric=True)
    (u, lam), (v, _) = fes.TnT()
    strain, virtual = Sym(AxisymmetricGrad(u)), Sym(AxisymmetricGrad(v))
    a = BilinearForm(fes)
    a += 2 * pi * x * InnerProduct(Stress(strain, 0.91 * modulus, 0.3), virtual) * dx

    def sticky(z):
        torn = IfPos(last - z.gap, peak * (last - z.gap) / (last - first), 0)
        return IfPos(z.gap - first, torn, peak / first * z.gap) * z.normal

    gf, depth = GridFunction(fes), Parameter(0)
    ball = tools.Sphere((0, radius), radius).Moved(shift=(0, -depth))
    contact = LACContact(u, lam, obstacle=ball, finite=True, law=Law(sticky))
    stepper = LoadStepper(ContactSolver(a, gf, contact), depth)
    forces = []
    for goal in (0.004, 0.001, 0, -0.001, -0.0015, -0.002, -0.004):
        stepper.Integrate(goal, steps=1, printing=False)
        forces.append(contact.Force()[1] / (pi * work * radius))
    assert max(forces) == pytest.approx(1.5, rel=0.1)
    assert forces[-1] == 0


@pytest.mark.parametrize("dim", [2, 3])
def test_the_matrix_of_a_descent_does_not_soften(dim):
    """It is that of the same law without the negative part of its symmetric stiffness."""
    random = np.random.default_rng(3).normal(size=(2, dim, dim))
    stiffness = random[0] + random[0].T + 0.3 * random[1]
    sizes, directions = np.linalg.eigh(-(stiffness + stiffness.T) / 2)
    assert sizes.min() < 0 < sizes.max()
    positive = stiffness + directions @ np.diag(np.minimum(sizes, 0)) @ directions.T

    def matrix(by_jump, convex):
        def law(places):
            jump = places["jump"]
            derivative = np.broadcast_to(by_jump, (len(jump), dim, dim))
            return {"traction": jump @ stiffness.T, "by_jump": derivative}

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
