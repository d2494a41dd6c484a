# SPDX-License-Identifier: LGPL-2.1-or-later
"""Patch tests on meshes as they come: coarse and fine, with corners and edges, curved."""

import numpy as np
import pytest
from bricks import by_hand
from netgen.occ import Box, Compound, Cylinder, OCCGeometry, X, Z
from ngsolve import (
    ET,
    BilinearForm,
    Grad,
    GridFunction,
    InnerProduct,
    Mesh,
    Sym,
    TaskManager,
    VectorH1,
    ds,
    dx,
    specialcf,
)

from ngslac import ContactSolver, LACContact, LACSpace
from ngslac.meshes.boxes import StructuredBox

SQUEEZE, PRESSURE = 0.02, 10.0


def boxes(rng, order):
    """Two boxes of any size with meshes of any size."""
    length, width, height = rng.uniform(0.4, 2.5, 3)
    lower, upper = (Box((0, 0, z), (length, width, z + height)) for z in (-height, 0))
    return meshed(rng, lower, upper)


def cylinders(rng, order):
    """On each other; their rims are straight segments, the same ones for both."""
    radius, height = rng.uniform(0.4, 1.2), rng.uniform(0.4, 1.5)
    lower, upper = (Cylinder((0, 0, z), Z, radius, height) for z in (-height, 0))
    return meshed(rng, lower, upper)


def bored(rng, order):
    """Boxes with a curved hole through the lower one."""
    length, width = rng.uniform(0.6, 1.5, 2)
    lower, upper = (Box((0, 0, z), (length, width, z + 1)) for z in (-1, 0))
    lower = (lower - Cylinder((-1, 0.5 * width, -0.6), X, 0.2, 5)).solids[0]
    return meshed(rng, lower, upper).Curve(order)


def meshed(rng, lower, upper):
    for body in (lower, upper):
        body.faces.name = "free"
    lower.faces.Min(Z).name, lower.faces.Max(Z).name = "bottom", "slave"
    upper.faces.Min(Z).name, upper.faces.Max(Z).name = "master", "top"
    lower.maxh, upper.maxh = rng.uniform(0.25, 0.7), rng.uniform(0.3, 0.9)
    for edge in [*lower.faces.Max(Z).edges, *upper.faces.Min(Z).edges]:
        edge.maxh = min(lower.maxh, upper.maxh)
    return Mesh(OCCGeometry(Compound([lower, upper])).GenerateMesh())


def structured(rng, order):
    """Cells of one kind for each body, on uneven grids."""
    points, cells, facets = [], [], []
    names = {"front": "free", "back": "free", "left": "free", "right": "free"}
    for body, z in (("lower", -1), ("upper", 0)):
        lines = [np.sort(rng.uniform(0, 1, n)) for n in rng.integers(1, 6, 2)]
        grid = [np.unique(np.concatenate([[0], line.round(1), [1]])) for line in lines]
        kind = str(rng.choice(["tet", "hex", "prism", "pyramid"]))
        box = StructuredBox(*grid, np.linspace(z, z + 1, 3), kind)
        ends = ("bottom", "slave") if body == "lower" else ("master", "top")
        new = names | dict(zip(("bottom", "top"), ends, strict=True))
        cells += [(body, [v + len(points) for v in cell]) for cell in box.cells]
        facets += [(new[name], [v + len(points) for v in face]) for name, face in box.faces]
        points += [*box.points]
    return by_hand(points, cells, facets)


def has_support(mesh):
    """Is there a vertex inside of the slave surface, so that order 1 has a macro-element at all?"""
    slave, others = (
        {v.nr for el in region.Elements() for v in el.vertices}
        for region in (mesh.Boundaries("slave"), ~mesh.Boundaries("slave"))
    )
    return bool(slave - others)


def pressed(mesh, order):
    """Pressures over the exact one, and the report.

    Uniaxial strain of a material with nu = 0; loads hold the balance on curved sides.
    """
    V = VectorH1(mesh, order=order, dirichlet="bottom|top")
    X = V * LACSpace(V, slave="slave")
    (u, lam), (v, _) = X.TnT()
    a = BilinearForm(X)
    a += PRESSURE / SQUEEZE * InnerProduct(Sym(Grad(u)), Sym(Grad(v))) * dx
    a += PRESSURE * specialcf.normal(3)[2] * v[2] * ds("free", bonus_intorder=4)
    gf, contact = GridFunction(X), LACContact(u, lam, master="master")
    low, high = (f([p[2] for p in mesh.ngmesh.Coordinates()]) for f in (min, max))
    squeeze = (0, 0, -SQUEEZE * (high - low))
    gf.components[0].Set(squeeze, definedon=mesh.Boundaries("top"))
    with TaskManager():
        ContactSolver(a, gf, contact).Solve(printing=False)
    return contact.Table()["pressure"] / PRESSURE, contact.Check()


MAKERS = {"boxes": boxes, "cylinders": cylinders, "bored": bored, "structured": structured}
CASES = {
    ("boxes", 1): 8,
    ("cylinders", 1): 2,
    ("cylinders", 2): 1,
    ("bored", 2): 2,
    ("structured", 1): 10,
    ("structured", 2): 2,
}


@pytest.mark.sample(10)
@pytest.mark.parametrize(
    ("make", "order", "seed"),
    [(*case, seed) for case, many in CASES.items() for seed in range(many)],
)
def test_pressure_is_exact_on_any_mesh(make, order, seed):
    mesh = MAKERS[make](np.random.default_rng(seed), order)
    if order == 1 and not has_support(mesh):
        with pytest.raises(Exception, match="no free displacement dof has its whole trace"):
            pressed(mesh, order)
        return
    pressure, report = pressed(mesh, order)
    assert report.paired_area == pytest.approx(report.area, rel=1e-12)
    assert not len(report.prescribed)
    # NGSolve moves points at the tip of a pyramid by 1e-10.
    pyramids = any(el.type == ET.PYRAMID for el in mesh.Elements())
    np.testing.assert_allclose(pressure, 1, rtol=0, atol=1e-9 if pyramids else 1e-12)
