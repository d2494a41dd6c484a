"""Distributed runs give the results of the serial one; nobody waits for ever."""

from functools import cache

import numpy as np
import pytest
from parallel_compare import differences
from parallel_start import missing, run
from parallel_worker import CASES

ALL = sorted(CASES, key=lambda name: name == "restarted")  # after "saved", whose file it reads
# All run on 3 ranks; on the others those whose faces, bodies or files divide differently there.
MANY = [
    "hertz2d", "blocks3d", "curved", "two_contacts", "condensed", "tied3d", "obstacle", "heat",
    "floating", "ironing", "selfcontact", "rigid_tool", "dynamics", "too_far", "failing_callback",
    "unknown_slave", "bubbles", "hexahedra", "saved", "restarted",
]  # fmt: skip
FEW = ["hertz2d", "tied3d", "two_contacts", "selfcontact", "unknown_slave", "saved", "restarted"]
RUNS = {3: ALL, 4: MANY, 5: FEW, 2: FEW, 1: FEW}
# By default 3 ranks alone run these: they reach what all reach of the rooms parallel and petsc.
SAMPLE = [
    "saved", "restarted", "vtu", "hertz2d", "builder", "curved", "two_contacts", "condensed",
    "nonlinear", "augmented", "bilateral", "tied3d", "heat", "floating", "load_as_linearform",
    "heat_flow", "tied_temperature", "surfaces_alone", "arrays",
    "interior_point", "selfcontact", "tied_finite", "rigid_tool", "dynamics", "dynamics_small",
    "dynamics3d", "torn_off", "too_few_iterations", "unknown_slave", "unknown_options",
    "negative_friction", "failing_callback", "failing_prescribe", "bad_loads", "bad_form",
    "interrupted", "alone", "split", "mixed", "hexahedra", "sphere", "regions", "switched",
    "ends", "queries", "by_iterations", "freedofs", "blocks_of_dofs", "bubbles",
    "product_in_product",
]  # fmt: skip
LIMIT = 60.0  # seconds for one case

pytestmark = pytest.mark.skipif(missing() is not None, reason=f"distributed runs: {missing()}")


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    return tmp_path_factory.mktemp("parallel")


@pytest.fixture(scope="module")
def wanted(request):
    """The cases of the tests that run, in order, on a number of ranks; None: on any number."""
    items = (item for item in request.session.items if item.path == request.path)
    options = [item.callspec.params for item in items]

    def on(ranks):
        here = (found for found in options if ranks in (None, found.get("ranks")))
        names = {found["name"] for found in here}
        if "restarted" in names:
            names.add("saved")  # which leaves the file
        return [name for name in ALL if name in names]

    return on


@pytest.fixture(scope="module")
def serial(folder, wanted):
    return run(0, wanted(None), folder, saved=folder / "state1", limit=LIMIT)


@pytest.fixture(scope="module")
def distributed(folder, wanted):
    """What the cases find on a number of ranks; 3 ranks come first and leave the saved state."""

    @cache
    def on(ranks):
        saved = folder / "state3"
        if ranks != 3 and not saved.exists():  # as 3 ranks were not asked for
            saved = folder / f"state{ranks}"
        return run(ranks, wanted(ranks), folder, saved=saved, limit=LIMIT)

    return on


def Case(ranks, name):
    """A case on a number of ranks, in the full run alone if it is not in the sample."""
    marks = () if ranks == 3 and name in SAMPLE else pytest.mark.full
    return pytest.param(ranks, name, id=f"{ranks}-{name}", marks=marks)


EACH = [Case(ranks, name) for ranks in RUNS for name in RUNS[ranks]]


@pytest.mark.parametrize(("ranks", "name"), EACH)
def test_ranks_agree_with_the_serial_run(serial, distributed, ranks, name):
    assert differences(serial[name], distributed(ranks)[name]) == []


def statuses(found):
    values = found["values"]
    return set(np.concatenate([values[name][0] for name in values if name.startswith("status")]))


FULL = [pytest.param(name, marks=pytest.mark.full) for name in ("hertz3d", "ironing")]


@pytest.mark.parametrize("name", ["hertz2d", "two_contacts", *FULL])
def test_what_is_compared_is_open_and_closed(serial, name):
    assert 0 in statuses(serial[name])
    assert 2 in statuses(serial[name])
