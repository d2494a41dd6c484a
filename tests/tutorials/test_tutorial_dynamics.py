"""The tutorial on dynamics: free fall, momentum, energy, refinement."""

import numpy as np
import pytest
from notebooks import Tutorial

DYNAMICS, VALUES = (
    "11_dynamics",
    """
VALUES = dict(
    error=error, arrival=arrival, impulse=impulse, change=change, back=back, losses=losses,
    balance=abs(left + lost).max(), taken=table["friction"] + table["impact"], force=force,
)
""",
)
drop = Tutorial(DYNAMICS, VALUES, pictures=2)
FINER = {"0.4, 0.2:": "0.4, 0.2, 0.1:"}
finer = Tutorial(DYNAMICS, VALUES, pictures=2, replace=FINER, keep=False)


def test_fall(drop):
    assert drop.error < 1e-12
    assert drop.arrival == pytest.approx(1, abs=0.05)


def test_momentum(drop):
    assert drop.force.min() > -1e-9
    assert drop.impulse == pytest.approx(drop.change, abs=0.01)


def test_energy(drop):
    assert drop.balance < 1e-10
    assert np.all(np.diff(drop.taken) > -1e-12)
    assert 0.8 < drop.back / 0.5 < 1


def test_refinement(drop):
    coarse, fine = drop.losses
    assert fine < coarse / 4
    assert fine < 0.025


@pytest.mark.full
def test_refinement_once_more(finer):
    coarse, middle, fine = finer.losses
    assert fine < middle / 2 < coarse / 4
    assert fine < 0.01
