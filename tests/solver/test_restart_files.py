"""Files of a saved state: whole or not there, checked bit by bit, and without code."""

import os
import pickle
import tracemalloc

import continued
import numpy as np
import pytest
from motions import moving, values
from netgen.csg import CSGeometry, Pnt, Sphere
from netgen.geom2d import SplineGeometry
from netgen.occ import Circle, OCCGeometry
from ngsolve import Integrate, Mesh, x, y
from ngsolve.meshes import MakeStructured2DMesh, MakeStructured3DMesh

from ngslac import LACContact, LoadMesh, LoadState, SaveState
from ngslac.files import Replacing
from ngslac.steps.meshstate import MeshOf, MeshState
from ngslac.steps.statefile import ReadTree, WriteTree


@pytest.fixture(scope="module")
def stepper():
    return continued.half(continued.loading(nonlinear=False))


@pytest.fixture
def file(stepper, tmp_path):
    SaveState(tmp_path / "state", stepper)
    return tmp_path / "state"


# --- what is read --------------------------------------------------------------------------------


def refused(file, stepper, data, message):
    file.write_bytes(data)
    for read in (LoadMesh, lambda name: LoadState(name, stepper)):
        with pytest.raises(ValueError, match=message):
            read(file)


def test_every_flipped_bit_is_found(file, stepper):
    data, before = file.read_bytes(), values(stepper.solver.gf)
    for place in np.unique(np.linspace(0, len(data) - 1, 60).astype(int)):
        bad = bytearray(data)
        bad[place] ^= 1 << int(place % 8)
        refused(file, stepper, bad, "state is damaged|not written by SaveState|a pickle")
    assert np.array_equal(values(stepper.solver.gf), before)


def test_files_that_are_shorter_longer_or_something_else(file, stepper):
    data = file.read_bytes()
    for size in (0, 1, 20, 40, -1, -32):
        refused(file, stepper, data[:size], "damaged|not written by SaveState")
    refused(file, stepper, data + b"\0", "damaged")
    refused(file, stepper, b"no state at all", "not written by SaveState of this version")


class Foreign:
    def __init__(self, file):
        self.file = file

    def __reduce__(self):
        return open, (self.file, "w")


def test_no_code_of_a_file_runs(file, stepper):
    ran = file.with_name("ran")
    refused(file, stepper, pickle.dumps(Foreign(str(ran))), "is a pickle, as earlier versions")
    assert not ran.exists()


MISSING = r"the folder .*missing is missing; make it first"


@pytest.mark.parametrize(
    ("call", "name", "error", "match"),
    [
        (LoadMesh, "missing", FileNotFoundError, "missing"),
        (LoadState, ".", OSError, "no regular file"),
        (LoadMesh, 3, TypeError, "file = 3 must be the name of a file"),
        (SaveState, ".", IsADirectoryError, "is a folder"),
        (SaveState, "missing/state", FileNotFoundError, MISSING),
        (SaveState, "pipe", OSError, "no regular file"),
        (SaveState, "", ValueError, "file = '' must be"),
    ],
)
def test_places_where_no_file_can_be(call, name, error, match, tmp_path, stepper):
    os.mkfifo(tmp_path / "pipe")
    place = tmp_path / name if isinstance(name, str) and name else name
    with pytest.raises(error, match=match):
        call(place, *([] if call is LoadMesh else [stepper]))
    assert (tmp_path / "pipe").is_fifo()


# --- what is written -----------------------------------------------------------------------------


def test_the_file_is_replaced_as_a_whole(file, stepper, monkeypatch):
    """A computation that dies while it writes leaves the older state, and nothing else."""

    def full(*arguments, **options):
        raise OSError(28, "No space left on device")

    before = file.read_bytes()
    for owner, name, broken, error, match in (
        (LACContact, "State", lambda self: full, TypeError, "a function cannot be saved"),
        (np.lib.format, "write_array", full, OSError, "No space left"),
    ):
        with monkeypatch.context() as patch:
            patch.setattr(owner, name, broken)
            with pytest.raises(error, match=match):
                SaveState(file, stepper)
        assert file.read_bytes() == before
        assert os.listdir(file.parent) == [file.name]


def test_a_link_stays_a_link(tmp_path, stepper):
    (tmp_path / "link").symlink_to(tmp_path / "state")
    SaveState(tmp_path / "link", stepper)
    assert (tmp_path / "link").is_symlink()
    assert (tmp_path / "state").is_file()


def test_an_interrupt_leaves_nothing(tmp_path):
    with pytest.raises(KeyboardInterrupt), Replacing(tmp_path / "text") as part:  # noqa: PT012
        part.write_text("half")
        raise KeyboardInterrupt
    assert not os.listdir(tmp_path)


def test_memory(tmp_path):
    """The comparison of meshes takes no lists of dofs."""
    mesh = MakeStructured3DMesh(hexes=True, nx=6, ny=6, nz=6)
    solver = moving(mesh, gap=0.1, dt=1.0).stepper.static
    SaveState(tmp_path / "warm", solver)
    tracemalloc.start()
    SaveState(tmp_path / "state", solver)
    peak = tracemalloc.get_traced_memory()[1] / mesh.ne
    tracemalloc.stop()
    assert peak < 1300  # twice the dofs of an element


# --- values and meshes ---------------------------------------------------------------------------


def test_values_come_back_with_their_types(tmp_path):
    tree = {
        "numbers": [1, 1.5, float("inf"), True, None, "text", 10**30, 0.1 + 0.2],
        "pair": (1.0, (2, "b")),
        "arrays": {"array": np.arange(6.0).reshape(2, 3).T, "none": np.empty(0, int)},
        "bytes": b"\x00\xff",
        "kind": {"tuple": [1], "record": "x"},
    }
    WriteTree(tmp_path / "tree", tree)
    found = ReadTree(tmp_path / "tree")
    arrays = found.pop("arrays"), tree.pop("arrays")
    assert found == tree
    for name, array in arrays[1].items():
        assert np.array_equal(arrays[0][name], array)
        assert arrays[0][name].dtype == array.dtype


def occ():
    shape = Circle((0, 0), 1).Face()
    shape.edges.name, shape.faces.name = "side", "steel"
    return OCCGeometry(shape, dim=2).GenerateMesh(maxh=0.7)


def csg():
    geometry = CSGeometry()
    geometry.Add(Sphere(Pnt(0, 0, 0), 1).bc("sphere").mat("steel"))
    return geometry.GenerateMesh(maxh=2)


def spline():
    geometry = SplineGeometry()
    geometry.AddCircle((0, 0), 1, bc="circle")
    return geometry.GenerateMesh(maxh=0.5)


def structured():
    return MakeStructured2DMesh(nx=2, ny=3, mapping=lambda s, t: (s / 3, t / 7)).ngmesh


@pytest.mark.parametrize("make", [occ, csg, spline, structured])
@pytest.mark.parametrize("refine", [False, True])
def test_meshes_come_back(make, refine, tmp_path):
    """With their geometry: they can be curved again."""
    mesh = Mesh(make())
    if refine:
        mesh.Refine()
    mesh.Curve(1 if make is structured else 3)
    WriteTree(tmp_path / "mesh", MeshState(mesh))
    found = MeshOf(ReadTree(tmp_path / "mesh"))
    assert found.GetBoundaries() == mesh.GetBoundaries()
    assert found.GetMaterials() == mesh.GetMaterials()
    assert found.GetCurveOrder() == mesh.GetCurveOrder()
    assert np.array_equal(mesh.ngmesh.Coordinates(), found.ngmesh.Coordinates())
    of = [np.array(Integrate(1 + x * y, m, element_wise=True)) for m in (mesh, found)]
    assert of[0] == pytest.approx(of[1], rel=1e-9 if refine else 0, abs=0)
    if make is spline:
        found.Curve(5)
        assert Integrate(1, found) == pytest.approx(np.pi, rel=1e-7)
