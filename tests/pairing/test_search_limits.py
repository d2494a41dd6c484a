"""Where the search ends: the paired part of the slave is what lies within its limits."""

import numpy as np
import pytest
from netgen.meshing import NgException
from netgen.occ import Axis, Box, Compound, MoveTo, OCCGeometry, WorkPlane, X, Y, Z
from ngsolve import Mesh, VectorH1

from ngslac import LACContact, LACSpace


def contact(mesh, order=2, **options):
    V = VectorH1(mesh, order=order)
    (u, lam), _ = (V * LACSpace(V, slave="slave")).TnT()
    return LACContact(u, lam, master="master", **options)


def area(mesh, **options):
    paired = contact(mesh, **options)
    paired.Update()
    return paired.Table()["area"].sum()


def wedge(h=3.0, shift=0.0):
    """A unit square above a master from (-0.5, 0.1) to (1.5, -0.3): a gap from 0 to 0.2."""
    upper = MoveTo(0, shift).Rectangle(1, 1).Face()
    upper.edges.Min(Y).name = "slave"
    lower = MoveTo(-0.5, -2).LineTo(1.5, -2, "bottom").LineTo(1.5, -0.3)
    lower = lower.LineTo(-0.5, 0.1, "master").LineTo(-0.5, -2).Face()
    return Mesh(OCCGeometry(Compound([upper, lower]), dim=2).GenerateMesh(maxh=h))


def wedge3d(h=1.0, shift=0.0):
    """The same, extruded by one; h of the master is another."""
    upper = Box((0, 0, shift), (1, 1, shift + 1))
    upper.faces.Min(Z).name = "slave"
    profile = WorkPlane().MoveTo(-0.5, -2).LineTo(1.5, -2).LineTo(1.5, -0.3)
    lower = profile.LineTo(-0.5, 0.1).LineTo(-0.5, -2).Face().Extrude(2)
    lower = lower.Rotate(Axis((0, 0, 0), X), 90).Move((0, 1.5, 0))
    top = max(lower.faces, key=lambda face: face.center.z)
    top.name, top.maxh = "master", 0.7 * h
    return Mesh(OCCGeometry(Compound([upper, lower])).GenerateMesh(maxh=h))


@pytest.mark.parametrize("make", [wedge, wedge3d])
@pytest.mark.parametrize("maxdist", [0.19, 0.137, 0.08, 0.013])
def test_openings_end_at_maxdist(make, maxdist):
    assert area(make(), maxdist=maxdist) == pytest.approx(maxdist / 0.2, rel=1e-10)


@pytest.mark.parametrize("make", [wedge, wedge3d])
@pytest.mark.parametrize("penetration", [0.19, 0.137, 0.08, 0.013])
def test_interpenetration_ends_at_penetration(make, penetration):
    """The square is sunk by 0.2: gaps from -0.2 to 0."""
    found = area(make(shift=-0.2), penetration=penetration, maxdist=0.5)
    assert found == pytest.approx(penetration / 0.2, rel=1e-10)


@pytest.mark.parametrize("make", [wedge, wedge3d])
def test_both_ends_at_once(make):
    """Sunk by 0.1: gaps from -0.1 to 0.1, of which -0.03 to 0.05 is seen."""
    assert area(make(shift=-0.1), penetration=0.03, maxdist=0.05) == pytest.approx(0.4, rel=1e-10)


def bowl(h):
    """A unit square above a disc of radius 2 that it touches in the middle of its lower side."""
    upper = MoveTo(-1, 0).Rectangle(2, 1).Face()
    upper.edges.Min(Y).name = "slave"
    lower = WorkPlane().MoveTo(0, -2).Circle(2).Face()
    lower.edges.name = "master"
    mesh = Mesh(OCCGeometry(Compound([upper, lower]), dim=2).GenerateMesh(maxh=h))
    mesh.Curve(3)
    return mesh


def test_curved_faces_converge():
    maxdist = 0.1
    exact = 2 * np.sqrt(2**2 - (2 - maxdist) ** 2)
    errors = [abs(area(bowl(h), maxdist=maxdist) - exact) for h in (0.6, 0.3)]
    assert errors[0] < 2e-3
    assert errors[1] < 0.5 * errors[0] or errors[1] < 1e-7


def test_no_point_of_a_segment_is_lost():
    """The weights of each segment make up its length."""
    mesh = wedge(h=0.3)
    paired = contact(mesh, maxdist=0.1)
    segments = paired.Segments()
    lengths = np.linalg.norm(segments.slave_points[:, 1] - segments.slave_points[:, 0], axis=1)
    assert segments.area == pytest.approx(lengths, rel=1e-12)
    assert np.linalg.norm(
        segments.master_points - segments.slave_points, axis=2
    ).max() == pytest.approx(0.1)


def blocks(gap, dim=2):
    """Two unit blocks with meshes that do not match, the upper one at this height."""
    if dim == 2:
        lower, upper = (MoveTo(0, y).Rectangle(1, 1).Face() for y in (-1, gap))
        master, slave = lower.edges.Max(Y), upper.edges.Min(Y)
    else:
        lower, upper = (Box((0, 0, z), (1, 1, z + 1)) for z in (-1, gap))
        master, slave = lower.faces.Max(Z), upper.faces.Min(Z)
    master.name, slave.name = "master", "slave"
    master.maxh, slave.maxh = 0.4, 0.3
    return Mesh(OCCGeometry(Compound([lower, upper]), dim=dim).GenerateMesh(maxh=0.5))


@pytest.mark.parametrize("dim", [2, 3])
def test_an_overlap_that_is_too_deep_names_penetration(dim):
    with pytest.raises(NgException, match=r"overlap by up to 0\.3, deeper than penetration = 0\.1"):
        contact(blocks(-0.3, dim)).Update()
    with pytest.raises(NgException, match=r"give penetration = 0\.33"):
        contact(blocks(-0.3, dim)).Update()
    assert area(blocks(-0.3, dim), penetration=0.33) == pytest.approx(1)


def test_surfaces_apart_do_not_overlap():
    with pytest.raises(NgException, match=r"within maxdist = 0\.2; check the regions"):
        contact(blocks(0.5), maxdist=0.2).Update()


def test_all_of_two_boundaries_do_not_overlap():
    """From the far side of the slave a normal backwards leaves the master at its far side."""
    mesh = blocks(0.0)
    for name, number in (("slave", 1), ("master", 0)):
        names = [mesh.GetBoundaries()[i] for i in range(len(mesh.GetBoundaries()))]
        assert name in names
        for i in range(4):
            mesh.ngmesh.SetBCName(4 * number + i, name)
    assert not len(contact(Mesh(mesh.ngmesh)).Check().overlapping)


@pytest.mark.parametrize("make", [wedge, wedge3d])
def test_the_report_names_what_overlaps_in_part(make):
    report = contact(make(h=0.4, shift=-0.2), penetration=0.05, order=1 + (make is wedge)).Check()
    assert report.deepest == pytest.approx(0.2, rel=0.15)
    assert 0 < len(report.overlapping) <= report.nmacros
    assert f"give penetration = {1.1 * report.deepest:.4g}" in str(report)
    plain = contact(make(h=0.4), maxdist=0.1, order=1 + (make is wedge)).Check()
    assert not len(plain.overlapping)
    assert "deep overlap" not in str(plain)
