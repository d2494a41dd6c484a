"""Bodies that steps would carry through rigid tools: seen, however thin these are."""

import numpy as np
import pytest
from netgen.occ import OCCGeometry, Rectangle, X, Y
from ngsolve import (
    CF,
    BilinearForm,
    Grad,
    GridFunction,
    Id,
    Mesh,
    Parameter,
    Variation,
    VectorH1,
    ds,
    dx,
)

from ngslac import ContactSolver, LACContact, LACSpace, LoadStepper, tools
from ngslac.materials import NeoHooke


class Body:
    """A rectangle of rubber and a tool; a force acts on its top, springs may hold it."""

    def __init__(self, corner, sizes, tool, *, force=0.0, held="", slave="bottom", **options):
        face = Rectangle(*sizes).Face().Move((*corner, 0))
        face.edges.Min(X).name, face.edges.Max(X).name = "left", "right"
        face.edges.Min(Y).name, face.edges.Max(Y).name = "bottom", "top"
        mesh = Mesh(OCCGeometry(face, dim=2).GenerateMesh(maxh=0.1))
        V = VectorH1(mesh, order=options.pop("order", 2), dirichlet=held)
        X2 = V * LACSpace(V, slave=slave)
        (u, lam), (v, _) = X2.TnT()
        a, self.load, self.gf = BilinearForm(X2), Parameter(0), GridFunction(X2)
        a += Variation(NeoHooke(Id(2) + Grad(u), 100.0, 0.3) * dx)
        a += self.load * force * v[1] * ds("top")
        if not held:
            a += u * v * dx
        tool = tool(self.load) if callable(tool) else tool
        self.contact = LACContact(
            u, lam, obstacle=tool, finite=True, friction=options.pop("mu", None)
        )
        self.stepper = LoadStepper(ContactSolver(a, self.gf, self.contact), self.load, **options)

    def Load(self, steps):
        """The steps to the end of the load."""
        return self.stepper.Integrate(1, steps=steps, printing=False)


def Bar(thick, left=1.7, right=2.3):
    return tools.Polygon([(left, -thick), (right, -thick), (right, 0), (left, 0)])


@pytest.mark.parametrize(
    ("thick", "steps", "order", "friction"),
    [(0.1, 10, 2, 0.5), (0.1, 10, 2, None), (0.2, 1, 2, 0.5), (0.4, 1, 1, None)],
)
def test_a_strip_stays_on_a_thin_bar(thick, steps, order, friction):
    """It touches at the start, and a bar is no thicker than one or two macro-elements."""
    strip = Body((0, 0), (3, 0.1), Bar(thick), force=0.02, held="left", order=order, mu=friction)
    strip.Load(steps)
    assert strip.contact.Force()[1] == pytest.approx(0.0408, abs=2e-4)


@pytest.mark.parametrize("predict", [True, False])
def test_a_prediction_behind_a_plate_is_no_start_of_a_way(predict):
    """A block on soft springs comes down on a plate in its second step."""
    block = Body((-0.5, 1.0), (1, 0.1), Bar(0.75, -3, 3), force=1.9, predict=predict)
    block.Load(2)
    assert block.contact.Force()[1] > 0.05
    assert block.contact.Table()["x"][:, 1].min() > -1e-3


@pytest.mark.parametrize("friction", [None, 0.5])
def test_a_tool_that_goes_along_with_a_body_passes_nothing(friction):
    """Both are carried by ten sizes of the tool, in one step without a cut."""

    def along(load):
        return tools.Sphere((-0.5, 0), 0.5).Moved(shift=(5.01 * load, 0))

    body = Body((0, -0.5), (1, 1), along, held="right", slave="left", mu=friction)
    body.stepper.prescribe = {"right": body.load * CF((5, 0))}
    (step,) = body.Load(1)
    assert step.cuts == 0
    assert body.contact.Force()[0] > 0.1


def test_a_tool_that_jumps_into_a_body_at_rest_is_seen():
    """The disc ends deeper than macro-elements look, where no force would act."""

    def into(load):
        return tools.Sphere((0.5, 0.51), 0.5).Moved(shift=(0, -0.3 * load))

    block = Body((0, -1), (1, 1), into, held="bottom", slave="top")
    block.Load(1)
    assert block.contact.Force()[1] < -10
    distances = into(block.load).Distance(block.contact.Table()["x"])
    assert np.min(distances) > -0.02
