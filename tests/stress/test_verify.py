"""The checks that know nothing of the solver: their geometry, and that they find wrong answers."""

import numpy as np
import pytest
from ngsolve import CF, GridFunction, Integrate, VectorH1
from run import PROBLEMS  # all of them are registered there
from stress_check import WrongAnswerError
from stress_meshes import Grids
from verify import Verifier
from verify_faces import Faces, Rule
from verify_rays import MeetFaces


def Boxes(kind):
    """Two boxes with a gap of 0.1, in the plane if kind is "2d"."""
    if kind == "2d":
        return Grids(upper=((0, 0.1, 1, 0.5), (3, 2)), lower=((-1, -1, 1, 0), (5, 2)))
    return Grids(
        upper=((0, 0, 0.1, 1, 1, 0.5), (2, 3, 1), kind),
        lower=((-1, -1, -1, 1, 1, 0), (4, 3, 1), kind),
    )


KINDS = pytest.mark.parametrize("kind", ["2d", "hex", "tet", "prism"])


@KINDS
def test_faces_know_their_area_and_outside(kind):
    mesh = Boxes(kind)
    sides = "upper_bottom|upper_top" if kind == "prism" else "upper_.*"  # of one kind
    faces = Faces(mesh, sides, 2)
    points, weights = Rule(faces.kind, 4)
    tangents = np.einsum("qrn,fnd->fqrd", faces.Slopes(points), faces.position)
    normals = faces.Normals(tangents)
    x = np.einsum("qn,fnd->fqd", faces.Shapes(points), faces.position)
    # The flux of x through a closed surface is the dimension times the volume.
    outside = np.sum(weights * np.sum(normals * (x - [*[0] * (mesh.dim - 1), 0.3]), axis=-1))
    volume = mesh.dim * Integrate(CF(1), mesh.Materials("upper"))
    assert outside == pytest.approx(0.4 if kind == "prism" else volume)


@KINDS
def test_rays_meet_what_is_opposite(kind):
    mesh = Boxes(kind)
    slave, master = Faces(mesh, "upper_bottom", 2), Faces(mesh, "lower_top", 2)
    points, _ = Rule(slave.kind, 3)
    x = np.einsum("qn,fnd->fqd", slave.Shapes(points), slave.position).reshape(-1, mesh.dim)
    x = np.concatenate([x, x + 1.5])  # half of them beside the other box
    down = np.zeros_like(x)
    down[:, -1] = -1
    for cells in (1, 2):
        hits = MeetFaces(x, down, master, master.position, ahead=5, behind=1, cells=cells)
        met = hits.face >= 0
        assert np.array_equal(met, np.repeat([True, False], len(x) // 2))
        assert np.abs(hits.gap[met] - 0.1).max() < 1e-14
        shapes = master.Shapes(hits.place[met])
        y = np.einsum("pn,pnd->pd", shapes, master.position[hits.face[met]])
        assert np.abs(y - x[met] - 0.1 * down[met]).max() < 1e-14


def test_fields_are_interpolated_exactly():
    mesh = Boxes("tet")
    field = GridFunction(VectorH1(mesh, order=2))
    field.vec.FV().NumPy()[:] = np.random.default_rng(1).normal(size=len(field.vec))
    faces, finer = (Faces(mesh, "upper_bottom", degree) for degree in (2, 5))
    values = np.einsum("qn,fnd->fqd", faces.Shapes(finer.powers / 5), faces.Values(field))
    assert np.abs(values - finer.Values(field)).max() < 1e-13


# --- wrong answers -------------------------------------------------------------------------------


def Scale(factor):
    def spoil(problem, _):
        values, dofs = problem.gf.vec.FV().NumPy(), problem.contacts[0].form.MultiplierDofs()
        values[dofs] *= factor

    return spoil


def Rub(problem, _):
    dofs = problem.contacts[0].form.MultiplierDofs().reshape(-1, problem.mesh.dim)
    values = problem.gf.vec.FV().NumPy()
    normal = problem.contacts[0].Table()["normal"]
    along = np.zeros_like(normal)
    along[:, 0], along[:, 1] = normal[:, 1], -normal[:, 0]
    along[np.linalg.norm(along, axis=1) < 0.5, 0] = 1
    values[dofs] += 2 * np.linalg.norm(values[dofs], axis=1)[:, None] * along


def Sink(problem, _):
    moved = GridFunction(problem.X.components[0])
    moved.Set(problem.mesh.MaterialCF({"upper": CF((0, -0.02))}, default=CF((0, 0))))
    problem.gf.components[0].vec.data += moved.vec


def SlideBack(_, verify):
    verify.sides[0].last.jump[:] += [0.3, 0]  # as if it had slid the other way


def Load(problem, _):
    problem.Weight("b", CF((0, -0.2)))


EVERYWHERE = ["cyclic-0.3", "largeslide-0.3", "random-007"]


@pytest.mark.parametrize(
    ("names", "spoil", "what"),
    [
        (EVERYWHERE, Scale(-1.0), "tension"),
        (EVERYWHERE, Scale(1.1), "work of the contact"),
        (EVERYWHERE, Scale(0.0), "work"),
        (EVERYWHERE, Rub, "too much friction"),
        (EVERYWHERE[:2], Sink, "penetration"),
        (["fullslip-0.2"], SlideBack, "slip within friction"),
        (["stack"], Load, "equilibrium within|work of the contact"),
    ],
)
def test_wrong_answers_are_found(names, spoil, what):
    for name in names:
        problem = PROBLEMS[name]()
        verify = Verifier(problem)
        problem.Run(callback=lambda _, verify=verify: verify())
        spoil(problem, verify)
        with pytest.raises(WrongAnswerError, match=what):
            verify()


def test_elements_turned_inside_out_are_found():
    problem = PROBLEMS["neo-0.4"]()
    verify = Verifier(problem)
    verify._Orientation()
    values = problem.gf.components[0].vec.FV().NumPy()
    values[:] = np.random.default_rng(1).normal(size=len(values))
    with pytest.raises(WrongAnswerError, match="inside out"):
        verify._Orientation()
