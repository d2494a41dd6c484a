"""NAFEMS contact benchmark 1 with large displacements (code_aster SSNP154).

Published is the displacement of the block under the axis: without friction -1.30690 mm with linear
and -1.30802 mm with quadratic elements, with friction 0.1 -1.30108 and -1.30264 mm. They hold for
Hooke's law of Green's strain, which softens in compression: the small-strain value is -1.2734 mm,
and the logarithmic strain gives a stiffer block than that.
"""

import pytest
from ironing import Quadratic
from problems_cb1 import FORCE, PUBLISHED, CylinderModel
from problems_large import Hencky

AXIS = (0.0, 0.0)


@pytest.fixture(scope="module")
def models():
    """Without friction the path does not matter."""
    models = {friction: CylinderModel(0.5, friction=friction or None) for friction in PUBLISHED}
    for friction, model in models.items():
        model.Run(steps=2 if friction else 1)
    return models


@pytest.mark.parametrize("friction", PUBLISHED)
def test_displacement_of_the_block(models, friction):
    block = models[friction].At("block", AXIS)[1]
    linear, quadratic = PUBLISHED[friction]
    assert block == pytest.approx(quadratic, rel=2e-4)
    assert block == pytest.approx(linear, rel=1.5e-3)
    assert models[friction].At("cylinder", AXIS)[1] == pytest.approx(block, abs=5e-5)


def test_the_contact_carries_the_load(models):
    for model in models.values():
        assert model.contact.Force()[1] == pytest.approx(FORCE, rel=1e-8)


def test_newton_converges_quadratically(models):
    for model in models.values():
        history = model.solver.history
        assert Quadratic([max(entry.equilibrium, entry.constraint) for entry in history])


def test_finite_sliding_matters():
    """Surfaces paired in the reference give another displacement, with the same bulk."""
    model = CylinderModel(0.5, finite=False)
    model.Run(steps=1)
    block = model.At("block", AXIS)[1]
    assert abs(block - PUBLISHED[0.0][1]) > 3 * 2e-4 * abs(block)


def test_the_published_values_depend_on_the_law():
    model = CylinderModel(1.0, energy=Hencky)
    model.Run(steps=1)
    assert -1.2734 < model.At("block", AXIS)[1] < -1.260
