"""What the tests of the peers share."""

import pytest


@pytest.fixture
def arguments(tmp_path):
    """Command line of a peer for a problem, with the mesh written."""
    from tinypeers import TinyMesh

    def write(problem, *more):
        TinyMesh(problem).Save(tmp_path / "mesh.npz")
        row = str(tmp_path / "row.json")
        return [problem, str(tmp_path / "mesh.npz"), "--json", row, *more]

    return write
