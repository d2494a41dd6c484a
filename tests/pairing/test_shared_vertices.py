"""Vertices that belong to both surfaces are reported: there nothing can open."""

import pytest
from netgen.occ import Compound, Glue, MoveTo, OCCGeometry
from ngsolve import Mesh, VectorH1

from ngslac import LACContact, LACSpace


def wedge(join):
    """Check() of two bodies whose sides enclose an angle, with its tip at the origin."""
    upper = MoveTo(0, 0).LineTo(1, 0).LineTo(1, 1).LineTo(0, 1).Close().Face()
    lower = MoveTo(0, 0).LineTo(0, -1).LineTo(1, -1).LineTo(1, -0.1).Close().Face()
    upper.edges[0].name, lower.edges[3].name = "slave", "master"
    upper.maxh, lower.maxh = 0.3, 0.2
    mesh = Mesh(OCCGeometry(join([upper, lower]), dim=2).GenerateMesh())
    V = VectorH1(mesh, order=2)
    u, lam = (V * LACSpace(V, slave="slave")).TrialFunction()
    return LACContact(u, lam, master="master").Check()


def test_at_the_tip():
    report = wedge(Glue)
    assert len(report.shared) == 1
    assert "shared vertices  1, of slave and master: (0, 0)" in str(report)


def test_none():
    report = wedge(Compound)
    assert len(report.shared) == 0
    assert "shared" not in str(report)
    assert report.paired_area == pytest.approx(1, rel=1e-2)
