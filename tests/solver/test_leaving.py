# SPDX-License-Identifier: LGPL-2.1-or-later
"""finite=True: bodies come off each other, pass by each other, and meet again."""

import numpy as np
import pytest
from netgen.meshing import NgException
from netgen.occ import Box, Compound, MoveTo, OCCGeometry, Rectangle, Y, Z
from ngsolve import (
    CF,
    Mesh,
    Parameter,
    TaskManager,
    VectorH1,
    pi,
    sin,
)
from posed import elastic, posed

from ngslac import LoadState, SaveState


def blocks(dim, h, gap=0.0):
    """A block above another one of the same size."""
    if dim == 2:
        lower, upper = MoveTo(0, -0.5).Rectangle(1, 0.5).Face(), Rectangle(1, 0.5).Face()
        up, parts = Y, lambda body: body.edges
    else:
        lower, upper = Box((0, 0, -0.5), (1, 0.5, 0)), Box((0, 0, 0), (1, 0.5, 0.5))
        up, parts = Z, lambda body: body.faces
    (upper.faces if dim == 2 else upper.solids).name = "upper"
    upper = upper.Move((0, gap, 0) if dim == 2 else (0, 0, gap))
    for body, name, size in ((lower, "low", 1.4 * h), (upper, "up", h)):
        parts(body).name, body.maxh = name, size
    parts(lower).Min(up).name, parts(lower).Max(up).name = "bottom", "master"
    parts(upper).Min(up).name, parts(upper).Max(up).name = "slave", "top"
    return Mesh(OCCGeometry(Compound([lower, upper]), dim=dim).GenerateMesh())


class Driven:
    """The upper side of the block on top is moved by a vector times functions of the load."""

    def __init__(self, mesh, way, order=2, **options):
        V = VectorH1(mesh, order=order, dirichlet="bottom|top")
        problem = posed(V, elastic(1000), load=Parameter(0), **({"finite": True} | options))
        self.load, self.contact, self.forces = problem.load, problem.contact, []
        self.stepper = problem.stepper(prescribe={"top": CF(tuple(way(self.load)))})

    def Run(self, steps, target=1.0):
        with TaskManager():
            self.stepper.Integrate(
                target,
                steps=steps,
                printing=False,
                callback=lambda step: self.forces.append(np.array(self.contact.Force())),
            )


@pytest.mark.sample(2)
@pytest.mark.parametrize(
    ("dim", "order", "friction"),
    [
        *((2, 1, 0.3), (2, 2, 0.3), (3, 2, 0.2)),
        *(pytest.param(*case, None, marks=pytest.mark.full) for case in ((2, 2), (3, 1))),
    ],
)
def test_pressed_on_it_slides_off_and_comes_back(dim, order, friction):
    """It is pressed by 0.01 first, slides 1.2 of its length to the side, and back."""

    def Way(t):
        aside = 1.2 * sin(0.5 * pi * t) ** 2
        return [aside, *[0.0] * (dim - 2), -0.01]

    mesh = blocks(dim, 0.14 if dim == 2 else 0.4 if order == 2 else 0.22)
    driven = Driven(mesh, Way, order, friction=friction, maxdist=3)
    driven.Run(1, 1e-6)
    driven.Run(8, 1.0)
    assert np.all(driven.forces[-1] == 0)
    driven.Run(8, 2.0)
    first, *forces = driven.forces
    assert first[-1] > 1
    assert not np.any(driven.contact.Table()["area"] == 0)
    assert forces[-1][-1] == pytest.approx(first[-1], rel=1e-6 if friction is None else 0.1)


def test_a_restart_beyond_the_end(tmp_path):
    """A saved state in which nothing faces the master goes on like the computation itself."""

    def Way(t):
        return [1.2 * sin(0.5 * pi * t) ** 2, -0.01]

    mesh = blocks(2, 0.2)
    one, other = (Driven(mesh, Way, friction=0.3) for _ in range(2))
    one.Run(1, 1e-6)
    one.Run(6)
    assert np.all(one.forces[-1] == 0)
    SaveState(tmp_path / "state", one.stepper)
    LoadState(tmp_path / "state", other.stepper)
    for driven in (one, other):
        driven.Run(6, 2.0)
    assert one.forces[-1][-1] > 1
    assert other.forces[-1] == pytest.approx(one.forces[-1], rel=1e-8, abs=1e-8)


@pytest.mark.parametrize("dim", [2, 3])
def test_it_passes_by_above(dim):
    """Nothing ever touches; beyond the end there is nothing to search for."""
    mesh = blocks(dim, 0.2 if dim == 2 else 0.5, gap=0.05)
    driven = Driven(mesh, lambda t: [1.3 * t, *[0.0] * (dim - 1)], friction=0.3)
    driven.Run(8)
    assert not np.any(driven.forces)
    assert not np.any(driven.contact.Table()["area"])


@pytest.mark.parametrize("finite", [False, True])
def test_what_is_beside_from_the_start_is_an_error(finite):
    """A mistake, unless maxdist says that they are apart, and only that."""
    mesh = blocks(2, 0.25, gap=1.0)
    for way, options, fails in (
        ((1.5, 0), {}, True),
        ((1.5, 0), {"maxdist": 0.5}, True),
        ((0, 0), {"maxdist": 0.5}, not finite),
        ((0, 0), {}, False),
    ):
        driven = Driven(mesh, lambda t, way=way: way, finite=finite, **options)
        gf = driven.stepper.solver.gf
        gf.components[0].Set(CF(way), definedon=mesh.Materials("upper"))
        if fails:
            with pytest.raises(NgException, match="never meet"):
                driven.contact.Update(gf)
        else:
            driven.contact.Update(gf)


@pytest.mark.parametrize("dim", [2, 3])
def test_apart_at_first_they_meet_later(dim):
    """Farther apart than maxdist: the scale of the unpaired is right when they touch."""
    mesh = blocks(dim, 0.2 if dim == 2 else 0.3, gap=0.5)
    results = []
    for options in ({"maxdist": 0.1}, {}):
        driven = Driven(mesh, lambda t: [0.0] * (dim - 1) + [-0.51 * t], order=dim - 1, **options)
        driven.Run(8)
        results.append(driven.forces[-1])
    assert results[0][-1] > 1
    assert results[0] == pytest.approx(results[1], rel=1e-8, abs=1e-8)
