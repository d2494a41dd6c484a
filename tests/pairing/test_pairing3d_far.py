"""Curved slave faces far from a fine master: the search is narrow, however long it is."""

import numpy as np
from curved3d import bend, cube_on_sphere
from ngsolve import CF, Timers, VectorH1, sqrt, x, y, z
from surfaces3d import Sheet, quad_grid, sheet_mesh

from ngslac import LACContact, LACSpace


def ball_over_plate(divisions, height, half, order):
    """A coarse ball of radius 1, and a square plate."""
    ball, faces = cube_on_sphere(1, "all", 3)
    plate, cells = quad_grid(divisions, divisions)
    plate = np.column_stack([half * (2 * plate[:, :2] - 1), np.full(len(plate), -height)])
    mesh = sheet_mesh(
        Sheet("in", ball, faces, -0.3 * ball, "ball"),
        Sheet("out", plate, cells, (0, 0, -0.3), "plate"),
    )
    bend(mesh, order, (1 / sqrt(x * x + y * y + z * z) - 1) * CF((x, y, z)), "ball")
    return mesh


def seconds():
    return {timer["name"].removeprefix("ngslac::"): timer["time"] for timer in Timers()}


def test_faces_that_are_far_away_do_not_search_everywhere():
    mesh = ball_over_plate(80, height=20, half=30, order=3)
    V = VectorH1(mesh, order=3)
    u, lam = (V * LACSpace(V, slave="ball")).TrialFunction()
    contact = LACContact(u, lam, master="plate")
    before = seconds()
    contact.Update()
    spent = {name: now - before.get(name, 0) for name, now in seconds().items()}
    search = spent["Pair"] - spent["Facets"] - spent["Pair - tree"]
    assert contact.Table()["area"].sum() > 0
    assert search < 4 * spent["Surface"]  # to read the faces once
