"""What the solution of a contact problem obeys, macro-element by macro-element."""

import numpy as np
import pytest


def shear(table):
    """The tangential traction."""
    return table["traction"] + table["pressure"][:, None] * table["normal"]


def check_law(contact, tol=1e-9):
    """The contact conditions, relative to the largest pressure and size."""
    t = contact.Table()
    p, size = t["pressure"].max(), t["fullarea"].max()
    along = np.linalg.norm(shear(t), axis=1)
    is_open, stick, slip = (t["status"] == k for k in range(3))
    assert not np.any(t["gap"][is_open] <= -tol * size)
    assert np.abs(t["traction"][is_open]).max(initial=0) < tol * p
    assert np.abs(t["gap"][~is_open]).max(initial=0) < tol * size
    assert np.all(t["pressure"][~is_open] > -tol * p)
    bound = t["friction"] * t["pressure"]
    assert np.all(along <= bound + tol * p)
    assert np.abs(np.linalg.norm(t["slip"], axis=1)[stick]).max(initial=0) < tol * size
    assert along[slip] == pytest.approx(bound[slip], abs=tol * p)
    # Friction resists the slip of the slave.
    assert np.all(np.sum(shear(t) * t["slip"], axis=1)[slip] <= tol * p * size)
