"""Meshes for several processes, as far as a single one can tell; the rest is in tests/parallel."""

import pytest
from ngsolve import GridFunction, VectorH1

from ngslac.meshes import Distributed, TwoBlocks
from ngslac.meshes.distributed import _Copied
from ngslac.parallel.together import KEPT, Portable, Recall


class One:
    """A communicator of one process."""

    size, rank = 1, 0


@pytest.mark.parametrize("comm", [None, One()], ids=["none", "one"])
def test_a_single_process_gets_the_mesh_as_it_is_made(comm):
    made = TwoBlocks()
    assert Distributed(lambda: made, comm) is made


def test_the_mesh_stays_as_it_is():
    mesh = TwoBlocks(curved=True, order=3)
    ngmesh, order = _Copied(mesh)
    assert (ngmesh.dim, order) == (2, 3)
    assert ngmesh is not mesh.ngmesh


def test_what_is_no_mesh_is_refused():
    with pytest.raises(TypeError, match=r"must return an ngsolve\.Mesh, not int"):
        _Copied(3)


def test_a_deformation_is_refused():
    mesh = TwoBlocks()
    mesh.SetDeformation(GridFunction(VectorH1(mesh)))
    with pytest.raises(ValueError, match="UnsetDeformation"):
        _Copied(mesh)


def test_errors_that_cannot_be_sent_go_as_their_text():
    class LocalError(Exception):
        pass

    assert str(Portable(LocalError("why"))) == "LocalError: why"
    assert isinstance(Portable(KeyError("name")), KeyError)


def test_things_used_last_are_found_and_others_are_dropped():
    known = []
    for number in range(2 * KEPT):
        assert Recall(known, lambda thing: thing == [0], lambda: [0]) is known[-1]
        own = [number + 1]
        assert Recall(known, lambda thing, own=own: thing is own, lambda own=own: own) is own
    assert [0] in known  # as it was used in between
    assert len(known) == KEPT
