# SPDX-License-Identifier: LGPL-2.1-or-later
"""Periodic displacements: a slave that passes the seam meets the images of its master."""

import numpy as np
import pytest
from netgen.meshing import IdentificationType, NgException
from netgen.occ import (
    Axis,
    Box,
    Circle,
    Compound,
    MoveTo,
    OCCGeometry,
    Pnt,
    Rectangle,
    X,
    Y,
    Z,
    gp_Trsf,
)
from ngsolve import (
    CF,
    BilinearForm,
    Grad,
    GridFunction,
    InnerProduct,
    Mesh,
    Parameter,
    Periodic,
    Sym,
    TaskManager,
    VectorH1,
    dx,
)

from ngslac import ContactSolver, LACContact, LACSpace, LoadStepper

E, PRESS = 1000, 0.01


def identified(body, parts, direction, name):
    ends = parts(body).Max(direction), parts(body).Min(direction)
    ends[0].Identify(ends[1], name, IdentificationType.PERIODIC)


def strips(hslave, hmaster, width=1.0):
    """Strips above each other, both of period 1; `width`: of the lower one, in its direction."""
    upper, lower = Rectangle(1, 0.5).Face(), MoveTo(0, -0.5).Rectangle(width, 0.5).Face()
    for k, (face, h) in enumerate([(upper, hslave), (lower, hmaster)]):
        face.edges.name, face.maxh = "side", h
        identified(face, lambda body: body.edges, X, f"periodic{k}")
    upper.edges.Min(Y).name, upper.edges.Max(Y).name = "slave", "top"
    lower.edges.Max(Y).name, lower.edges.Min(Y).name = "master", "bottom"
    return Mesh(OCCGeometry(Compound([upper, lower]), dim=2).GenerateMesh())


def plates(hslave, hmaster, directions):
    upper, lower = Box((0, 0, 0), (1, 1, 0.5)), Box((0, 0, -0.5), (1, 1, 0))
    for k, (body, h) in enumerate([(upper, hslave), (lower, hmaster)]):
        body.faces.name, body.maxh = "side", h
        for direction, name in zip((X, Y), directions, strict=False):
            identified(body, lambda one: one.faces, direction, f"periodic{k}{name}")
    upper.faces.Min(Z).name, upper.faces.Max(Z).name = "slave", "top"
    lower.faces.Max(Z).name, lower.faces.Min(Z).name = "master", "bottom"
    return Mesh(OCCGeometry(Compound([upper, lower])).GenerateMesh())


def problem(mesh, way, order=2, **options):
    """The upper side is pressed down first, and then moved along."""
    V = Periodic(VectorH1(mesh, order=order, dirichlet="bottom|top"))
    fes = V * LACSpace(V, slave="slave")
    (u, lam), (v, _) = fes.TnT()
    a = BilinearForm(fes)
    a += E * InnerProduct(Sym(Grad(u)), Sym(Grad(v))) * dx
    contact = LACContact(u, lam, master="master", **({"finite": True} | options))
    s, down = Parameter(0), Parameter(0)
    move = {"top": CF((*(s * w for w in way), -down))}
    solver, forces = ContactSolver(a, GridFunction(fes), contact), []

    def Look(step):
        forces.append(np.array(contact.Force()))

    def Run(target, steps):
        with TaskManager():
            LoadStepper(solver, down, prescribe=move).Integrate(PRESS, steps=1, printing=False)
            LoadStepper(solver, s, prescribe=move).Integrate(
                target, steps=steps, printing=False, callback=Look
            )
        return contact, np.array(forces)

    return Run


@pytest.mark.sample(4)
@pytest.mark.parametrize("order", [1, 2])
@pytest.mark.parametrize(("hslave", "hmaster"), [(0.1, 0.14), (0.2, 0.12)])
@pytest.mark.parametrize(("target", "steps"), [(0.5, 6), (-3.3, 12)])
def test_uniaxial_strain_stays_so(order, hslave, hmaster, target, steps):
    """However far it slides: the force is that of the start, as on an endless strip."""
    run = problem(strips(hslave, hmaster), (1,), order)
    contact, forces = run(target, steps)
    assert forces[:, 1] == pytest.approx(E * PRESS, rel=1e-8)
    assert forces[:, 0] == pytest.approx(0, abs=1e-6)
    table = contact.Table()
    assert table["area"] == pytest.approx(table["fullarea"], rel=1e-10)
    assert table["pressure"] == pytest.approx(E * PRESS, rel=1e-8)


def test_friction_beyond_the_seam():
    run = problem(strips(0.1, 0.14), (1,), friction=0.3)
    _, forces = run(1.2, 24)
    assert np.abs(forces[4:, 0]) == pytest.approx(0.3 * forces[4:, 1], rel=1e-4)
    assert forces[:, 1] == pytest.approx(E * PRESS, rel=0.05)


def test_a_longer_master_and_one_that_is_not_periodic():
    """A slave of one period on a master of two."""
    run = problem(strips(0.2, 0.12, width=2.0), (1,))
    contact, forces = run(2.7, 9)
    assert len(contact.Check().unpaired) == 0
    assert np.all(forces[:, 1] > 1)


@pytest.mark.parametrize(
    ("directions", "way", "order"), [("x", (1, 0), 1), ("xy", (0.6, 1), 1), ("xy", (1, -0.7), 2)]
)
def test_plates_that_slide_over_their_corner(directions, way, order):
    run = problem(plates(0.45, 0.4, directions), way, order)
    contact, forces = run(1.4, 5)
    assert forces[:, 2] == pytest.approx(E * PRESS, rel=1e-6)
    assert contact.Check().paired_area == pytest.approx(1, rel=1e-8)


@pytest.mark.parametrize("options", [{"finite": False}, {"finite": True, "tied": True}])
def test_small_sliding_that_starts_beyond_the_seam(options):
    mesh = strips(0.1, 0.14)
    V = Periodic(VectorH1(mesh, order=2, dirichlet="bottom|top"))
    fes = V * LACSpace(V, slave="slave")
    contact, gf = LACContact(*fes.TrialFunction(), master="master", **options), GridFunction(fes)
    gf.components[0].Set(CF((0.37, 0)), definedon=mesh.Boundaries("slave|top"))
    contact.Update(gf)
    table = contact.Table()
    assert table["area"] == pytest.approx(table["fullarea"], rel=1e-10)


def test_a_seam_that_is_no_translation_is_refused():
    """A quarter of a ring, whose sides are one by a rotation."""

    turn = gp_Trsf.Rotation(Axis((0, 0, 0), Z), 90)
    corner = MoveTo(0, 0).Rectangle(3, 3).Face()
    parts = []
    for k in (1, 2):
        ring = (Circle((0, 0), k + 1).Face() - Circle((0, 0), k).Face()) * corner
        ring.edges.name = "arc"
        ends = ring.edges.Nearest(Pnt(k + 0.5, 0, 0)), ring.edges.Nearest(Pnt(0, k + 0.5, 0))
        for end in ends:
            end.name = "side"
        ends[0].Identify(ends[1], f"turn{k}", IdentificationType.PERIODIC, turn)
        parts.append(ring)
    parts[0].edges.Nearest(Pnt(1.42, 1.42, 0)).name = "inner"
    parts[1].edges.Nearest(Pnt(1.42, 1.42, 0)).name = "outer"
    mesh = Mesh(OCCGeometry(Compound(parts), dim=2).GenerateMesh(maxh=0.4))
    V = Periodic(VectorH1(mesh, order=1))
    X = V * LACSpace(V, slave="inner")
    with pytest.raises(NgException, match="no translation"):
        LACContact(*X.TrialFunction(), master="outer", finite=True).Update()
    LACContact(*X.TrialFunction(), master="outer").Update()
