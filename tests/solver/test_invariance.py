"""Frame, place and units do not show in a frictional solution, from pairing to forces."""

from dataclasses import dataclass
from functools import cache

import numpy as np
import pytest
from ngsolve import (
    CF,
    BilinearForm,
    GridFunction,
    IfPos,
    InnerProduct,
    Mesh,
    Parameter,
    VectorH1,
    ds,
    x,
    y,
    z,
)
from press import linear, two_blocks
from scipy.spatial.transform import Rotation

from ngslac import BubbleVectorH1, ContactSolver, LACContact, LACSpace, LoadStepper

TOL = 1e-9


@dataclass
class Frame:
    """One metre is `length` units of the computation, one pascal `stress` units."""

    rotation: np.ndarray
    length: float = 1.0
    stress: float = 1.0
    shift: float = 0.0  # metres, of the bodies from the origin

    def Move(self, points):
        """Coordinates of the computation, of points given in metres by rows."""
        away = self.shift * np.array((1, -0.7, 0.3))[: len(self.rotation)]
        return self.length * (points + away) @ self.rotation.T


def Solved(dim, frame, space=VectorH1, finite=False, **mesh_flags):
    """Pressed and pushed aside in two steps, in small sliding with stick, slip and open at once.

    Springs and clamp act in all directions, so that nothing but the loads refers to the frame.
    Returns displacements of the vertices, the contact table and forces, in metres and pascals.
    """
    R, length, stress = frame.rotation, frame.length, frame.stress
    ngmesh = two_blocks(dim, h=0.15, **mesh_flags).ngmesh
    for point in ngmesh.Points():
        for k, value in enumerate(frame.Move(np.array(point.p[:dim]))):
            point[k] = value
    mesh = Mesh(ngmesh)
    flags = {"order": 2} if space is VectorH1 else {"order": 1, "slave": "slave"}
    V = space(mesh, dirichlet="bottom", **flags)
    X = V * LACSpace(V, slave="slave")
    (u, lam), (v, _) = X.TnT()
    origin = frame.Move(np.zeros(dim))
    at = [(c - o) / length for c, o in zip((x, y, z), origin, strict=False)]
    local = [sum(R[j, i] * at[j] for j in range(dim)) for i in range(dim)]
    push = (0.005, -0.02 + 0.025 * local[0])
    if dim == 3:
        push = (0.005, 0.003, -0.02 + 0.02 * local[0] + 0.01 * local[1])
    push = CF(tuple(length * sum(R[i, j] * push[j] for j in range(dim)) for i in range(dim)))
    load, a = Parameter(0.0), BilinearForm(X)
    a += stress * linear(u, v)
    a += 1000 * stress / length * InnerProduct(u - load * push, v) * ds("top")
    gf, friction = GridFunction(X), 0.3 if finite else IfPos(local[0] - 0.3, 0.1, 2.0)
    contact = LACContact(u, lam, master="master", friction=friction, finite=finite)
    steps = LoadStepper(ContactSolver(a, gf, contact), load).Integrate(steps=2, printing=False)
    assert [step.cuts for step in steps] == [0, 0]
    table, force = contact.Table(), stress * length ** (dim - 1)
    vertices = [V.GetDofNrs(vertex) for vertex in mesh.vertices]
    return {
        "displacement": gf.components[0].vec.FV().NumPy()[vertices] @ R / length,
        "force": contact.Force() @ R / force,
        "pressure": table["pressure"] / stress,
        "traction": table["traction"] @ R / stress,
        "slip": table["slip"] @ R / length,
        "normal": table["normal"] @ R,
        "area": table["area"] / length ** (dim - 1),
    }, table["status"]


def turned(dim, seed, **units):
    if dim == 3:
        return Frame(Rotation.random(random_state=seed).as_matrix(), **units)
    return Frame(Rotation.from_euler("z", 0.7 + seed).as_matrix()[:2, :2], **units)


CASES = {
    "2D": {"dim": 2},
    "3D": {"dim": 3, "kinds": ("hex", "tet")},
    "bubbles": {"dim": 3, "kinds": ("tet", "prism_side"), "space": BubbleVectorH1},
    "2D finite": {"dim": 2, "finite": True, "shape": "oblique"},
    "3D finite": {"dim": 3, "kinds": ("hex", "hex"), "finite": True, "shape": "oblique"},
}


@cache
def reference(case):
    given = CASES[case]
    found, status = Solved(frame=Frame(np.eye(given["dim"])), **given)
    assert set(status) == {0, 1, 2} or "finite" in given
    return found, status


UNITS = [{"length": 1e-3, "stress": 1e9}, {"length": 1e-6}, {"length": 1e6, "shift": 1e4}]
TURNED = [(0, {}), (2, {"length": 1e3, "stress": 1e-6})]


@pytest.mark.sample(12)
@pytest.mark.parametrize(
    ("case", "seed", "units"),
    [
        *((case, None, units) for case in CASES for units in UNITS),
        *(("2D", None, {"stress": size}) for size in (1e-140, 1e140)),
        # In finite sliding the shares of the bodies in the normal follow the rows of the matrix.
        *((case, *frame) for case in ("2D", "3D", "bubbles") for frame in TURNED),
    ],
)
def test_solution_is_that_of_the_first_frame(case, seed, units):
    """Metres and pascals, millimetres and megapascals, kilometres and nanopascals."""
    given, (expected, status) = CASES[case], reference(case)
    dim = given["dim"]
    frame = Frame(np.eye(dim), **units) if seed is None else turned(dim, seed, **units)
    found, same = Solved(frame=frame, **given)
    assert np.array_equal(same, status)
    for name, values in expected.items():
        scale = np.abs(expected["displacement" if name == "slip" else name]).max()
        assert found[name] == pytest.approx(values, abs=TOL * scale), name
