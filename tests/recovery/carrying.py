"""Contacts that carry given multipliers, and what a recovered traction sums up to."""

import numpy as np
from ngsolve import GridFunction, IntegrationRule
from press import press

from ngslac.recovery.surface import CORNERS, SlaveSurface

WHOLE = {"overhang": 0.2, "aligned": True}


def carrying(tractions, **flags):
    """A contact that nothing deforms; `tractions` (m, d) is a function of its table."""
    contact = press(**({"mesh_flags": WHOLE} | flags)).contact
    contact.Update()
    return carry(contact, tractions)


def carry(contact, tractions):
    gf = GridFunction(contact.form.fes)
    dofs = contact.form.MultiplierDofs()
    gf.vec.FV().NumPy()[dofs] = np.asarray(tractions(contact.Table())).ravel()
    contact.Evaluate(gf)
    return contact


def pressing(pressure):
    """Tractions along the normals; `pressure` is a function of the middles (m, d)."""
    return lambda table: -pressure(table["x"])[:, None] * table["normal"]


def at_points(contact, function):
    """Positions, weights and values (q, ...) at the points where contact acts."""
    surface = SlaveSurface(contact)
    element, xi = surface.table[:, 0].astype(int), surface.table[:, 2:4]
    values = surface.Evaluate(function, element, xi)
    return surface.position, surface.weight, values


def resultants(contact):
    """Force and moment about the origin of the recovered traction, and the size of the forces."""
    x, weight, t = at_points(contact, contact.Recovered().traction)
    arms, forces = (np.pad(v, ((0, 0), (0, 3 - v.shape[1]))) for v in (x, weight[:, None] * t))
    moment, d = np.cross(arms, forces).sum(axis=0), x.shape[1]
    size = np.linalg.norm(forces, axis=1).sum()
    return forces.sum(axis=0)[:d], moment[2] if d == 2 else moment, size


def keeps_resultants(contact, tol=1e-12):
    force, moment, size = resultants(contact)
    surface = SlaveSurface(contact)
    length = np.abs(surface.points).max()
    assert np.abs(force - contact.Force()).max() <= tol * size
    assert np.abs(moment - contact.Moment()).max() <= tol * size * length


def never_pulls(contact):
    """Neither at the points where contact acts nor at the corners of the faces."""
    pressure = contact.Recovered().pressure
    assert at_points(contact, pressure)[2].min() >= 0
    corners = {kind: IntegrationRule(places, [0] * len(places)) for kind, places in CORNERS.items()}
    assert pressure(contact.mesh.MapToAllElements(corners, contact.space.slave)).min() >= 0
