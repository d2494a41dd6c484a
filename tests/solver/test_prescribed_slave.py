"""Slaves of which some displacement components are prescribed: macro-elements carry the others."""

import numpy as np
import pytest
from law import shear
from loaded import loaded
from ngsolve import VectorH1
from press import solved

from ngslac import BubbleVectorH1, LACSpace
from ngslac.meshes import TwoBlocks

GUIDED = {"dirichlet": "bottom", "dirichletx": "slave|top"}


def pressed(*, push=1.0, dim=2, overhang=0.0, flags=GUIDED, mesh_flags=None, **law):
    """Pressed down by a traction."""
    mesh_flags = {"overhang": overhang} | (mesh_flags or {})
    return loaded(*(0,) * (dim - 1), -push, dim=dim, flags=flags, mesh_flags=mesh_flags, **law)


def bubbles(mesh, *, order, **fixed):
    return BubbleVectorH1(mesh, order=1, slave="slave", **fixed)


CUBES = {"dim": 3, "order": 1, "n": (4, 3)}
TOPS = {"dirichlet": "bottom", "dirichletx": "slave|top", "dirichlety": "top"}
CASES = {
    "P1": {"h": 0.2, "order": 1},
    "P2": {"h": 0.2},
    "bubble": {"h": 0.2, "space": bubbles},
    "hexes": CUBES | {"kinds": ("hex", "hex"), "flags": TOPS},
    "tets": CUBES | {"kinds": ("tet", "tet"), "flags": TOPS | {"dirichlety": "slave|top"}},
}


@pytest.mark.pairwise
@pytest.mark.parametrize("solver", [None, "direct"])
@pytest.mark.parametrize("law", [{}, {"friction": 0.3}, {"tied": True}], ids=str)
@pytest.mark.parametrize("case", CASES)
def test_tangents_prescribed(case, law, solver):
    problem = pressed(**CASES[case], **law)
    solved(problem, solver=solver)
    table = problem.contact.Table()
    assert problem.contact.Force()[-1] == pytest.approx(1.0, rel=1e-9)
    assert np.all(table["pressure"] > 0)
    assert np.abs(table["gap"]).max() < 1e-12


def test_plane_strain_in_3d_is_that_of_2d():
    """u_y = 0 everywhere on a slab of hexahedra: pressures and frictions are those of quads."""
    flags = {"dirichlet": "bottom", "dirichletx": "top"}
    quads, slab = {"quads": True, "h_master": 1 / 3}, {"layers": (4, 3)}
    problems = (
        pressed(h=1 / 4, friction=0.1, flags=flags, mesh_flags=quads),
        pressed(
            dim=3, kinds=("hex", "hex"), n=(4, 3), friction=0.1,
            flags=flags | {"dirichlety": ".*"}, mesh_flags=slab,
        ),
    )  # fmt: skip
    tables = []
    for problem in problems:
        solved(problem)
        table = problem.contact.Table()
        assert np.abs(table["traction"][:, 1:-1]).max(initial=0) < 1e-10
        order = np.argsort(table["x"][:, 0].round(6), kind="stable")
        found = np.column_stack([table["pressure"], table["traction"][:, [0, -1]], table["status"]])
        tables.append(found[order])
    np.testing.assert_allclose(tables[1], np.repeat(tables[0], 4, axis=0), atol=1e-8)


@pytest.mark.parametrize("finite", [False, True])
@pytest.mark.parametrize("solver", [None, "direct"])
def test_inclined_slave(solver, finite):
    """The normal is no axis: without friction no shear, with friction its bound."""
    slope = 31.0
    sides = {"dirichlet": "bottom", "dirichletx": "slave|left_upper|right_upper|top"}
    n = np.array([np.sin(np.radians(slope)), -np.cos(np.radians(slope))])
    line = {"shape": "oblique", "slope": slope, "height": 2.0}
    flags = {"finite": finite, "nonlinear": finite, "flags": sides, "mesh_flags": line}
    for friction in (None, 0.3):
        problem = pressed(push=0.1, friction=friction, **flags)
        solved(problem, solver=solver)
        force = problem.contact.Force()
        ratio = abs(force @ [n[1], -n[0]] / (force @ n))
        # Slave faces tilt a little where everything turns with the deformation.
        assert ratio == pytest.approx(friction or 0, abs=5e-3 if finite else 1e-9)
        assert force @ n < 0


@pytest.mark.parametrize(("slope", "fixed"), [(45, "dirichlet"), (88, "dirichletx")])
def test_normal_that_cannot_be_reached(slope, fixed):
    mesh = TwoBlocks(0.3, shape="oblique", slope=slope, height=20.0)
    with pytest.raises(Exception, match=r"no displacement is free there along the normal.*Remedy"):
        LACSpace(VectorH1(mesh, order=2, **{fixed: "slave"}), slave="slave")


def test_dragged_slave_rubs():
    """A slave that is moved along the master carries friction, though it cannot follow it."""
    sides = {"dirichlet": "bottom", "dirichletx": "slave|right_upper|left_upper|top"}
    problem = pressed(flags=sides, friction=0.3)
    contact, gf, solver = problem.contact, problem.gf, solved(problem)
    contact.Commit(gf)
    gf.components[0].components[0].Set(0.1, definedon=problem.mesh.Materials("upper"))
    tables = []
    for _ in range(2):  # in the second one nothing moves: the traction stays
        solver.Solve(printing=False)
        contact.Commit(gf)
        assert contact.Force() == pytest.approx([-0.3, 1], rel=1e-9)
        tables.append(contact.Table())
    assert np.all(tables[0]["status"] == 2)
    assert np.abs(tables[1]["traction"] - tables[0]["traction"]).max() < 1e-9


def test_sticking_traction_is_kept_over_steps():
    problem = pressed(friction=0.9)
    solver, contact = solved(problem), problem.contact
    before = contact.Table()
    contact.Commit(problem.gf)
    solver.Solve(printing=False)
    assert np.all(before["status"] == 1)
    assert np.abs(shear(before)).max() > 1e-4
    np.testing.assert_allclose(contact.Table()["traction"], before["traction"], atol=1e-9)


def test_tied_slave_follows_the_master_in_its_free_direction():
    problem = pressed(push=-1.0, tied=True, flags={"dirichlet": "bottom", "dirichletx": ".*"})
    solved(problem)
    assert problem.contact.Force() == pytest.approx([0, -1], abs=1e-10)
    assert problem.contact.Table()["pressure"] == pytest.approx(-1, rel=1e-9)  # uniform
