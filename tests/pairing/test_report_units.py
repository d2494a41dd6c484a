"""Positions that a report tells, in any unit of length."""

import re

from ngsolve import VectorH1

from ngslac import LACContact, LACSpace
from ngslac.meshes import TwoBlocks


def test_positions_in_a_report_have_any_unit():
    mesh = TwoBlocks(0.5, overhang=-0.2, aligned=False, structured=True, scale=1e-7)
    V = VectorH1(mesh, order=2)
    contact = LACContact(*(V * LACSpace(V, slave="slave")).TrialFunction(), master="master")
    contact.Update()
    (line,) = [text for text in str(contact.Check()).splitlines() if "overhanging" in text]
    assert re.search(r"0 at \(\d[.\d]*e-09, 0\)", line)
