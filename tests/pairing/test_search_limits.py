"""Where the search ends, and what the report says of it."""

import re

import numpy as np
import pytest
from netgen.meshing import NgException
from netgen.occ import Compound, Glue, MoveTo, OCCGeometry, WorkPlane, Y
from ngsolve import Mesh, VectorH1
from sheets import WIDER, contact_on, face_sizes, grid, lower, outlines, sheet_mesh, upper

from ngslac import LACContact, LACSpace
from ngslac.meshes import TwoBlocks


@pytest.fixture(params=["edge", "quad"])
def kind(request):
    return request.param


def wedge(kind, shift=0.0, slope=(-0.2, 0), n=1):
    """A unit square above a wider master: a gap from 0 to 0.2, less what it is sunk by."""
    slave = upper(grid("mixed" if kind == "quad" else kind, n), -shift)
    return sheet_mesh(slave, lower(grid(kind, 2, WIDER), slope=slope))


LIMITS = [(0, {"maxdist": d}, d / 0.2) for d in (0.19, 0.08, 0.013)]
LIMITS += [(0.2, {"penetration": d, "maxdist": 0.5}, d / 0.2) for d in (0.19, 0.08, 0.013)]
LIMITS += [(0.1, {"penetration": 0.03, "maxdist": 0.05}, 0.4)]  # both ends at once


@pytest.mark.parametrize(("shift", "limits", "exact"), LIMITS)
def test_pairing_ends_at_the_limits(kind, shift, limits, exact):
    """No point of a segment is lost: its weights make up its size."""
    contact = contact_on(wedge(kind, shift), **limits)
    segments = contact.Segments()
    assert contact.Table()["area"].sum() == pytest.approx(exact, rel=1e-10)
    if kind == "edge":
        assert segments.area == pytest.approx(face_sizes(outlines(segments)), rel=1e-12)
    gaps = np.linalg.norm(segments.master_points - segments.slave_points, axis=-1)
    assert gaps.max() == pytest.approx(max(limits[k] for k in limits if limits[k] < 0.2))


def occ_mesh(upper, lower, slave, master, h, join=Compound):
    slave.name, master.name = "slave", "master"
    return Mesh(OCCGeometry(join([upper, lower]), dim=2).GenerateMesh(maxh=h))


def test_curved_faces_converge():
    """A unit square above a disc of radius 2 that it touches in the middle of its lower side."""
    errors, maxdist = [], 0.1
    for h in (0.6, 0.3):
        square, disc = MoveTo(-1, 0).Rectangle(2, 1).Face(), WorkPlane().MoveTo(0, -2).Circle(2)
        disc = disc.Face()
        mesh = occ_mesh(square, disc, square.edges.Min(Y), disc.edges[0], h).Curve(3)
        found = contact_on(mesh, maxdist=maxdist).Table()["area"].sum()
        errors.append(abs(found - 2 * np.sqrt(2**2 - (2 - maxdist) ** 2)))
    assert errors[0] < 2e-3
    assert errors[1] < 0.5 * errors[0] or errors[1] < 1e-7


def test_an_overlap_that_is_too_deep_names_penetration(kind):
    mesh, words = wedge(kind, 0.3, (0, 0)), r"overlap by up to 0\.3, deeper than penetration = 0\.1"
    with pytest.raises(NgException, match=rf"{words}[^$]*give penetration = 0\.33"):
        contact_on(mesh)
    assert contact_on(mesh, penetration=0.33).Table()["area"].sum() == pytest.approx(1)


def test_all_of_two_boundaries_do_not_overlap(kind):
    """From the far side of the slave a normal backwards leaves the master at its far side."""
    slave, master = upper(grid(kind), rest="slave"), lower(grid(kind, 4), rest="master")
    assert not len(contact_on(sheet_mesh(slave, master)).Check().overlapping)


def test_the_report_names_what_overlaps_in_part(kind):
    report = contact_on(wedge(kind, 0.2, n=4), penetration=0.05).Check()
    assert report.deepest == pytest.approx(0.2, rel=0.15)
    assert 0 < len(report.overlapping) <= report.nmacros
    assert f"give penetration = {1.1 * report.deepest:.4g}" in str(report)
    plain = contact_on(wedge(kind, n=4), maxdist=0.1).Check()
    assert not len(plain.overlapping)
    assert "deep overlap" not in str(plain)


def test_positions_in_a_report_have_any_unit():
    mesh = TwoBlocks(0.5, overhang=-0.2, aligned=False, structured=True, scale=1e-7)
    V = VectorH1(mesh, order=2)
    contact = LACContact(*(V * LACSpace(V, slave="slave")).TrialFunction(), master="master")
    (line,) = [text for text in str(contact.Check()).splitlines() if "overhanging" in text]
    assert re.search(r"0 at \(\d[.\d]*e-09, 0\)", line)


@pytest.mark.parametrize(("join", "shared"), [(Glue, 1), (Compound, 0)])
def test_shared_vertices_are_reported(join, shared):
    """Two bodies whose sides enclose an angle with its tip at the origin: it cannot open there."""
    above = MoveTo(0, 0).LineTo(1, 0).LineTo(1, 1).LineTo(0, 1).Close().Face()
    below = MoveTo(0, 0).LineTo(0, -1).LineTo(1, -1).LineTo(1, -0.1).Close().Face()
    above.maxh, below.maxh = 0.3, 0.2
    report = contact_on(occ_mesh(above, below, above.edges[0], below.edges[3], 1, join)).Check()
    assert len(report.shared) == shared
    words = "shared vertices  1, of slave and master: (0, 0)"
    assert words in str(report) if shared else "shared" not in str(report)
    assert report.paired_area == pytest.approx(1, rel=1e-2)
