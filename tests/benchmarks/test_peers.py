"""The drivers of Kratos and GetFEM: their input, how they fail. None of the peers is needed."""

import json
import sys
from itertools import product
from pathlib import Path

import numpy as np
import pytest

sys.path.insert(0, str(Path(__file__).parent / "peers"))

import calculix
import getfem_peer
import kratos
import kratos_files
from boundary import BODIES, SHIFT, Opposite, PressureForces
from meshes import EDGES, HELD
from metrics import LINE_FORCE, PATCH_PRESSURE, SPHERE_LOAD
from peercommand import Main
from tinypeers import TinyMesh

PROBLEMS = tuple(BODIES)
DRIVERS = {"CalculiX": calculix, "GetFEM": getfem_peer, "Kratos": kratos}


@pytest.fixture(params=PROBLEMS)
def mesh(request):
    return TinyMesh(request.param)


def test_opposite_corner(mesh):
    for name in np.unique(mesh.names):
        elements, corners = Opposite(mesh, name)
        assert len(elements) == np.sum(mesh.names == name)
        for element, corner, face in zip(elements, corners, mesh.Faces(1, name), strict=True):
            nodes = mesh.Elements(1)[element].tolist()
            assert sorted([*face.tolist(), nodes[corner]]) == sorted(nodes)


def test_faces_of_other_elements_are_noticed():
    mesh = TinyMesh("patch")
    mesh.owners[:] = 0
    with pytest.raises(ValueError, match="'master' do not belong"):
        Opposite(mesh, "master")


def test_forces_of_a_pressure():
    mesh = TinyMesh("patch")
    forces = PressureForces(mesh, "master", 3.0)  # a right angle between sides of 1.2
    assert forces.shape == (mesh.nvertices,)
    assert forces[mesh.Nodes(1, "master")] == pytest.approx(-3.0 * 0.72 / 3)
    assert forces.sum() == pytest.approx(-3.0 * 0.72)


# ---------------------------------------------------------------- Kratos


def read_mdpa(file):
    """Rows of words of each block, blocks of sub model parts by their names."""
    found, path = {}, []
    for line in file.read_text().splitlines():
        kind, *rest = line.split()
        if kind == "Begin":
            path.append(rest[0] if rest[0] != "SubModelPart" else rest[1])
            found.setdefault("/".join(path), [])
        elif kind == "End":
            path.pop()
        else:
            found["/".join(path)].append(line.split())
    assert not path
    return found


@pytest.fixture
def blocks(mesh, tmp_path):
    kratos_files.WriteMesh(tmp_path / "job.mdpa", mesh)
    return read_mdpa(tmp_path / "job.mdpa")


def numbers(rows):
    """The first word of each row as a number from 0."""
    return [int(row[0]) - 1 for row in rows]


def test_kratos_nodes_and_elements(mesh, blocks):
    nodes = np.array(blocks["Nodes"], float)
    assert numbers(blocks["Nodes"]) == list(range(mesh.nvertices))
    expected = np.zeros((mesh.nvertices, 3))
    expected[:, : mesh.dim] = mesh.Points(1)
    expected[: mesh.dim + 1, mesh.dim - 1] -= SHIFT[mesh.problem]
    assert np.array_equal(nodes[:, 1:], expected)
    elements = np.array(blocks["Elements"], int)
    assert np.array_equal(elements[:, 2:] - 1, mesh.Elements(1))
    for number, name in enumerate(BODIES[mesh.problem]):
        assert elements[number, 1] == number + 1
        assert numbers(blocks[f"Body_{name}/SubModelPartElements"]) == [number]
        inside = numbers(blocks[f"Body_{name}/SubModelPartNodes"])
        assert inside == mesh.MaterialNodes(1, name).tolist()


def test_kratos_conditions(mesh, blocks):
    conditions = {
        int(row[0]) - 1: [int(word) - 1 for word in row[2:]] for row in blocks["Conditions"]
    }
    assert len(conditions) == len(blocks["Conditions"])
    for name in ("slave", "master"):
        (number,) = numbers(blocks[f"Contact_{name}/SubModelPartConditions"])
        assert [conditions[number]] == mesh.Faces(1, name).tolist()
        nodes = numbers(blocks[f"Contact_{name}/SubModelPartNodes"])
        assert nodes == mesh.Nodes(1, name).tolist()
    loaded = [conditions[number] for number in numbers(blocks["Load/SubModelPartConditions"])]
    forces = kratos_files.NodalForces(mesh)
    assert loaded == [[node] for node in np.flatnonzero(forces)]
    for name in HELD[mesh.problem]:
        held = numbers(blocks[f"Held_{name}/SubModelPartNodes"])
        assert held == mesh.Nodes(1, name).tolist()


@pytest.mark.parametrize(
    ("problem", "total"),
    [
        ("hertz", -LINE_FORCE / 2),
        ("sphere", -SPHERE_LOAD * np.sqrt(3) / 2),  # the far face of the tiny mesh
        ("patch", -PATCH_PRESSURE * np.sqrt(3) / 2),
    ],
)
def test_kratos_load(problem, total):
    forces = kratos_files.NodalForces(TinyMesh(problem))
    assert forces.sum() == pytest.approx(total)
    assert np.flatnonzero(forces).tolist() == ([2] if problem == "hertz" else [1, 2, 3])


def test_kratos_parameters(mesh):
    options = {"friction": 0.2, "steps": 10, "linear_solver": "some"}
    read = json.loads(json.dumps(kratos_files.Parameters(mesh, Path("a/job"), **options)))
    solver = read["solver_settings"]
    assert solver["time_stepping"]["time_step"] == 0.1
    assert solver["linear_solver_settings"]["solver_type"] == "some"
    assert solver["contact_settings"]["mortar_type"] == "ALMContactFrictional"
    held = {}
    for process in read["processes"]["constraints_process_list"]:
        parameters = process["Parameters"]
        assert parameters["value"] == [
            0.0 if fixed else None for fixed in parameters["constrained"]
        ]
        name = parameters["model_part_name"].removeprefix("Structure.Held_")
        held[name] = parameters["constrained"].index(True)
    assert held == HELD[mesh.problem]
    materials = kratos_files.Materials(mesh, 0.2)["properties"]
    assert [entry["model_part_name"].split("_")[1] for entry in materials] == [
        *BODIES[mesh.problem]
    ]
    assert materials[0]["Material"]["Variables"]["FRICTION_COEFFICIENT"] == 0.2


def test_kratos_knows_linear_faces_only(arguments, monkeypatch, capsys):
    monkeypatch.setattr(kratos, "MISSING", None)
    line = arguments("sphere", "--order", "2")
    assert Main(kratos.Solve, peer="Kratos", options=kratos.Options, argv=line) == 1
    assert "use --order 1" in capsys.readouterr().err.splitlines()[-1]


# ---------------------------------------------------------------- GetFEM


@pytest.mark.parametrize("dim", [2, 3])
def test_getfem_second_order_nodes(dim):
    corners = np.vstack([np.zeros(dim), np.eye(dim)])
    nodes = np.vstack([corners, [(corners[a] + corners[b]) / 2 for a, b in EDGES[dim]]])
    lattice = [point[::-1] for point in product((0, 0.5, 1), repeat=dim) if sum(point) <= 1]
    assert nodes[getfem_peer.LATTICE[dim]].tolist() == [list(point) for point in lattice]


class FakeSpace:
    """A vector-valued Lagrange space of GetFEM with its nodes in another order."""

    def __init__(self, points):
        self.points = points[::-1]

    def basic_dof_nodes(self):
        return np.repeat(self.points, self.points.shape[1], axis=0).T


def test_getfem_dofs_of_nodes(mesh):
    points = mesh.points[mesh.Nodes(2, "slave")]
    space = FakeSpace(np.vstack([points + 1, points]))
    dofs = getfem_peer.NodeDofs(space, points)
    assert np.array_equal(space.basic_dof_nodes().T[dofs[:, -1]], points)
    assert np.array_equal(dofs - dofs[:, :1], np.tile(np.arange(mesh.dim), (len(points), 1)))


# ---------------------------------------------------------------- what is not installed


@pytest.mark.parametrize(
    ("peer", "remedy"),
    [
        ("CalculiX", "calculix-ccx"),
        ("GetFEM", "python3-getfem++"),
        ("Kratos", "KratosContactStructuralMechanicsApplication"),
    ],
)
def test_not_installed(peer, remedy, arguments, tmp_path, monkeypatch, capsys):
    monkeypatch.setenv("PATH", str(tmp_path))
    monkeypatch.setattr(getfem_peer, "getfem", None)
    monkeypatch.setattr(kratos, "MISSING", ModuleNotFoundError("No module named 'Kratos'"))
    driver = DRIVERS[peer]
    line = arguments("patch", "--order", "1")
    assert Main(driver.Solve, peer=peer, options=driver.Options, argv=line) == 3
    (said,) = capsys.readouterr().out.splitlines()
    assert "install" in said
    assert remedy in said
    assert not (tmp_path / "row.json").exists()


def test_getfem_of_the_system_is_asked(monkeypatch):
    monkeypatch.setattr(getfem_peer, "SYSTEM_PYTHON", "/nowhere/python3")
    assert not getfem_peer.SystemPythonHasIt()
