"""A half ring pressed on a block (code_aster SSNP165): deep indentation, then the ring buckles.

PA is the middle of the block's top, PB a point 66.7 mm beside it. The published values belong to a
mesh with one linear quadrilateral through each layer of the ring, which locks in bending, and to
contact edges of 8 to 10 mm: on triangles of order 2 the middle sinks in by half as much. On their
own mesh they are met to within what code_aster's own variants differ by.
"""

import numpy as np
import pytest
from ironing import Quadratic
from problems_halfring import PA, PB, QuadMesh, RingMesh, RingModel

# SSNP165 by the friction: time -> DY of PA, DY of PB. Variants a and b: logarithmic strain, contact
# in nodes, inertia (negligible before the ring buckles).
LOGARITHMIC = {
    None: {0.4: (-4.29574, -0.06323), 0.6: (-2.48392, -5.25683)},
    0.5: {0.4: (-4.38098, -0.01923), 0.6: (-2.94209, -5.46777)},
}
# Variant c: LAC, no friction, linear elasticity in the updated configuration.
UPDATED = {0.4: (-4.38954, -0.06968), 0.6: (-2.86806, -4.74671)}
# Order 2 with edges of 2.1 mm, here: time -> DY of PA, DY of PB.
FINE = {0.4: (-2.0419, -0.0252), 0.6: (-0.2648, -3.6671)}


def Follow(model, motion, *, end, steps):
    """Values after each step (by the time), residuals of those in contact, and the steps."""
    values, falls = {}, []

    def Record(step):
        table = model.contact.Table()
        closed = table["x"][table["status"] > 0, 0]
        values[round(step.time, 6)] = {
            "PA": model.At("block", PA),
            "PB": model.At("block", PB),
            "ring": model.At("outer", (0.0, 70.0))[1],
            "contact": (closed.min(), closed.max()) if len(closed) else (0.0, 0.0),
            "force": np.array(model.contact.Force()),
        }
        history = model.solver.history
        if len(closed):
            falls.append([max(entry.equilibrium, entry.constraint) for entry in history])

    steps = model.Run(end=end, steps=steps, prescribe=motion, callback=Record)
    return values, falls, steps


@pytest.fixture(scope="module")
def fall():
    """The whole way, on triangles of order 2."""
    return Follow(*RingModel(RingMesh(6.3)), end=1.0, steps=40)


@pytest.mark.parametrize("friction", LOGARITHMIC)
def test_on_the_published_mesh(friction):
    values, _, _ = Follow(*RingModel(QuadMesh(), order=1, friction=friction), end=0.6, steps=12)
    # The published values without friction differ from each other by 2 % (0.4) and 15 % (0.6).
    assert values[0.4]["PA"][1] == pytest.approx(LOGARITHMIC[friction][0.4][0], rel=0.09)
    assert values[0.6]["PB"][1] == pytest.approx(LOGARITHMIC[friction][0.6][1], rel=0.08)
    if friction is None:
        assert values[0.4]["PA"][1] == pytest.approx(UPDATED[0.4][0], rel=0.07)
        assert values[0.6]["PA"][1] == pytest.approx(LOGARITHMIC[None][0.6][0], rel=0.07)
    else:  # the ring drags the top of the block inwards
        assert values[0.6]["PB"][0] == pytest.approx(-2.07715, rel=0.12)


def test_values_do_not_depend_on_the_mesh(fall):
    values, _, _ = fall
    for time, (middle, beside) in FINE.items():
        assert values[time]["PA"][1] == pytest.approx(middle, abs=0.01)
        assert values[time]["PB"][1] == pytest.approx(beside, rel=0.025, abs=3e-3)


def test_the_ring_buckles_and_rests_on_two_places(fall):
    values, _, _ = fall
    assert values[0.7]["ring"] < -10 < 40 < values[1.0]["ring"]
    assert values[0.5]["contact"][0] < 5  # closed in the middle
    low, high = values[1.0]["contact"]
    assert 50 < low < high < 85
    assert values[1.0]["PA"][1] > 0  # the middle of the block bulges
    forces = {time: abs(state["force"][1]) for time, state in values.items()}
    assert max(forces, key=forces.get) == pytest.approx(0.725)
    assert forces[1.0] < 0.5 * forces[0.725]


def test_every_step_converges_quadratically_through_the_buckling(fall):
    _, falls, steps = fall
    assert [step.cuts for step in steps] == [0] * 40
    assert max(step.iterations for step in steps) <= 26
    assert len(falls) == 32
    # One ends in 4.5e-7, 2.2e-10, 1e-13: a tenth above the bound, and rounding errors next.
    assert sum(not Quadratic(residuals) for residuals in falls) <= 1
