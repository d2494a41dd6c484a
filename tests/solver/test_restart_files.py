"""Files of a saved state: checked bit by bit, without code, and with the mesh."""

import pickle
import sys
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

from ngslac import LoadMesh, LoadState, SaveState
from ngslac.steps.meshstate import MeshOf, MeshState, Parts
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


def test_what_is_no_file(tmp_path, stepper):
    with pytest.raises(FileNotFoundError, match="missing"):
        LoadMesh(tmp_path / "missing")
    with pytest.raises(OSError, match="no regular file"):
        LoadState(tmp_path, stepper)
    with pytest.raises(TypeError, match="file = 3 must be the name of a file"):
        LoadMesh(3)


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


def test_meshes_that_do_not_come_back(monkeypatch):
    state = MeshState(Mesh(structured()))
    state["volumes"][0] *= 1 + 1e-6
    with pytest.raises(ValueError, match="the mesh does not come back as it was saved"):
        MeshOf(state)
    geometry = OCCGeometry(Circle((0, 0), 1).Face(), dim=2)
    monkeypatch.setitem(sys.modules, "netgen.occ", None)
    with pytest.raises(TypeError, match="a mesh with a OCCGeometry cannot be saved"):
        Parts(geometry)
