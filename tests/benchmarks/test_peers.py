"""The drivers of CalculiX, Kratos and GetFEM pose the same problem, read results and fail.

None of these programs is needed.
"""

import json
import sys
from itertools import product
from pathlib import Path
from types import SimpleNamespace

import calculix
import calculix_files
import elastic
import getfem_peer
import kratos
import kratos_files
import numpy as np
import pytest
from meshes import BODIES, EDGES, HELD, SHIFT, Load
from metrics import LINE_FORCE, SPHERE_FORCE, SPHERE_PEAK, YOUNG
from ngsolve import VectorH1

# From CalculiX' manual, from 1: the corners of each face, and those beside each mid node.
FACES = {
    "C3D4": {1: (1, 2, 3), 2: (1, 4, 2), 3: (2, 4, 3), 4: (3, 4, 1)},
    "C3D6": {3: (1, 2, 5, 4), 4: (2, 3, 6, 5), 5: (3, 1, 4, 6)},
}
FACES |= {"C3D10": FACES["C3D4"], "C3D15": FACES["C3D6"]}
MIDS = {
    "C3D10": [(1, 2), (2, 3), (3, 1), (1, 4), (2, 4), (3, 4)],
    "C3D15": [(1, 2), (2, 3), (3, 1), (4, 5), (5, 6), (6, 4), (1, 4), (2, 5), (3, 6)],
}
CLOSE = {"hertz": 1e-9, "patch": 1e-9, "sphere": 2e-2}  # the boundary of the sphere is a polygon
# Forces on the models: half of the cylinder, a quarter of the sphere, all of the cube.
LOAD = {"hertz": -LINE_FORCE / 2, "sphere": -SPHERE_FORCE / 4, "patch": -1.0}
OPTIONS = {"friction": 0.2, "steps": 10, "variant": "penalty", "linear_solver": "some"}


def supported(points, mesh):
    """Numbers of the nodes on each supported plane, which is where a coordinate is smallest."""
    return {
        name: set(np.flatnonzero(np.isclose(points[:, k], points[:, k].min())).tolist())
        for name, k in HELD[mesh.problem].items()
    }


def placed(mesh, name):
    """Coordinates of the corners of the faces of a boundary, the upper body lowered."""
    shift = SHIFT[mesh.problem] * np.eye(mesh.dim)[-1] * (name != "master")
    return [
        sorted(map(tuple, (mesh.points[face] - shift).round(9))) for face in mesh.Faces(1, name)
    ]


# ---------------------------------------------------------------- CalculiX


class Deck:
    """An input file of CalculiX, read again."""

    def __init__(self, file):
        self.blocks = {}
        for line in file.read_text().splitlines():
            if line.startswith("*"):
                rows = self.blocks.setdefault(line, [])
            elif rows and rows[-1][-1] == "":  # goes on
                rows[-1][-1:] = line.split(",")
            else:
                rows.append(line.split(","))
        self.points = np.array(self.Rows("*NODE,"), float)[:, 1:]
        self.elements = {}
        for line, data in self.blocks.items():
            if line.startswith("*ELEMENT"):
                self.kind = line.split("TYPE=")[1].split(",")[0]
                self.elements |= {int(row[0]): np.array(row[1:], int) - 1 for row in data}

    def Rows(self, head):
        """Words of each data line of the block that begins so."""
        (data,) = (data for line, data in self.blocks.items() if line.startswith(head))
        return data

    def FacePoints(self, element, face):
        """Coordinates of the corners of a face, as the manual numbers them."""
        nodes = self.elements[int(element)]
        return self.points[[nodes[k - 1] for k in FACES[self.kind][int(face[1])]]]


@pytest.fixture(params=[1, 2])
def deck(request, mesh, tmp_path):
    """Mesh and input file of a problem."""
    solid = calculix_files.Solid(mesh, request.param)
    calculix_files.WriteInput(tmp_path / "job.inp", solid, SimpleNamespace(**OPTIONS), 700e3)
    return mesh, Deck(tmp_path / "job.inp")


def test_calculix_elements(deck):
    mesh, read = deck
    assert sorted(read.elements) == list(range(1, len(mesh.elements) + 1))
    assert set(np.concatenate([*read.elements.values()])) == set(range(len(read.points)))
    for nodes in read.elements.values():
        points = read.points[nodes]
        assert len(points) == int(read.kind[3:])
        assert np.linalg.det(points[[1, 2, 3]] - points[0]) > 0
        if read.kind in MIDS:
            ends = points[np.array(MIDS[read.kind]) - 1]
            bow = np.linalg.norm(points[-len(ends) :] - ends.mean(axis=1), axis=1)
            most = 1e-9 if mesh.problem == "patch" else 0.2  # others are curved
            assert np.all(bow < most * np.ptp(ends, axis=1).max(axis=1))
    for body in BODIES[mesh.problem]:
        own = read.Rows(f"*ELEMENT,TYPE={read.kind},ELSET={body.upper()}")
        assert [int(row[0]) - 1 for row in own] == np.flatnonzero(mesh.materials == body).tolist()
    young = [row[0] for row in read.Rows("*ELASTIC")]
    assert young == [str(YOUNG[body]) for body in BODIES[mesh.problem]]


def test_calculix_surfaces(deck):
    mesh, read = deck
    for name in ("slave", "master"):
        rows = read.Rows(f"*SURFACE,NAME={name.upper()}")
        found = [np.unique(read.FacePoints(*row)[:, : mesh.dim].round(9), axis=0) for row in rows]
        assert np.array(found) == pytest.approx(np.array(placed(mesh, name)), abs=1e-8)


def test_calculix_supports_and_load(deck):
    mesh, read = deck
    for name, nodes in supported(read.points, mesh).items():
        rows = read.Rows(f"*NSET,NSET=N{name.upper()}")
        assert {int(word) - 1 for row in rows for word in row if word} == nodes
        component = str(HELD[mesh.problem][name] + 1)
        assert [f"N{name.upper()}", component, component] in read.Rows("*BOUNDARY")
    if mesh.dim == 2:
        assert ["NALL", "3", "3"] in read.Rows("*BOUNDARY")
        rows = read.Rows("*CLOAD")
        for row in rows:
            assert read.points[int(row[0]) - 1][:2] == pytest.approx([0, 99.95], abs=1e-12)
        assert sum(float(row[2]) for row in rows) == pytest.approx(LOAD["hertz"])
        return
    force = 0
    for element, face, pressure in read.Rows("*DLOAD"):
        a, b, c = read.FacePoints(element, face)
        force -= float(pressure) * abs(np.cross(b - a, c - a)[2]) / 2
    assert force == pytest.approx(LOAD[mesh.problem], rel=CLOSE[mesh.problem])


def test_calculix_contact_law(deck, tmp_path):
    mesh, read = deck
    assert read.Rows("*SURFACE BEHAVIOR") == [["700000.0"]]
    assert read.Rows("*FRICTION") == [["0.2", "70000.0"]]
    assert read.Rows("*STATIC,SOLVER=some")[0][0] == "0.1"
    mortar = SimpleNamespace(**OPTIONS | {"variant": "mortar", "friction": 0.0})
    calculix_files.WriteInput(tmp_path / "hard.inp", calculix_files.Solid(mesh, 1), mortar)
    assert "TYPE=MORTAR" in (text := (tmp_path / "hard.inp").read_text())
    assert "*SURFACE BEHAVIOR" not in text
    assert "*FRICTION" not in text


FRD = """\
    2C                             3                                     1
 -1         1 8.00000E+00-1.95943E-15 5.44149E-01
 -3
 -4  CONTACT     6    1
 -5  COPEN       1    4    1    1
 -1         1 0.00000E+00 0.00000E+00 0.00000E+00 9.99999E+03 0.00000E+00 0.00000E+00
 -3
 -4  CONTACT     6    1
 -1         1-5.82132E-03-1.00000E+00 0.00000E+00 4.07492E+03-2.00000E+00 0.00000E+00
 -1         3 0.00000E+00 0.00000E+00 0.00000E+00-1.25000E-01 0.00000E+00 0.00000E+00
 -1{beyond:10d} 0.00000E+00 0.00000E+00 0.00000E+00 5.00000E+00 0.00000E+00 0.00000E+00
 -3
 -4  ERROR       1    1
 -1         1 3.00000E+00
 -3
 9999
"""


def test_calculix_results_of_the_last_step(tmp_path):
    file = tmp_path / "job.frd"
    file.write_text(FRD.format(beyond=7))
    assert calculix_files.ReadContact(file, 3).tolist() == [4074.92, 0, -0.125]
    file.write_text(FRD.format(beyond=7).replace("CONTACT", "STRESS "))
    with pytest.raises(ValueError, match="no contact stresses"):
        calculix_files.ReadContact(file, 3)
    head = " displacements (vx,vy,vz) for set NALL and time  0.{}0000000E+01\n\n"
    rows = "         1  1.234567E-03 -2.000000E+00  {}\n         2  0.000000E+00  0.0  1.0E+00\n"
    file.write_text(head.format(5) + rows.format("9.0E+00") + head.format(1) + rows.format("3.0"))
    found = calculix_files.ReadDisplacement(file, 2)
    assert found.tolist() == [[1.234567e-3, -2, 3], [0, 0, 1]]
    with pytest.raises(ValueError, match="missing"):
        calculix_files.ReadDisplacement(file, 3)


CCX = """\
#!{python}
from pathlib import Path
print("CalculiX Version 2.20, Copyright")
print(" number of equations\\n 12\\n iteration            1\\n iteration            2\\n")
if {finished}:
    Path("job.frd").write_text({frd!r})
    Path("job.sta").write_text("head\\n 1 1 1 2 {time} {time} {time}\\n")
    print(" Job finished")
else:
    print(" *ERROR: too many cutbacks\\n best solution is written")
    raise SystemExit(201)
"""


@pytest.mark.parametrize(
    ("finished", "time", "said"),
    [
        (True, "0.1E+01", None),
        (True, "0.5E+00", "ccx ended with 0: Job finished"),
        (False, "", "ccx ended with 201: *ERROR: too many cutbacks best solution"),
    ],
)
def test_calculix_run(finished, time, said, drive, files, tmp_path, monkeypatch, capsys):
    slave = Load(files["sphere"]).Nodes(1, "slave")
    program, frd = tmp_path / "ccx", FRD.format(beyond=slave[-1] + 1)
    program.write_text(CCX.format(python=sys.executable, finished=finished, time=time, frd=frd))
    program.chmod(0o755)
    monkeypatch.setenv("PATH", str(tmp_path))
    code, row = drive(calculix, "sphere", "--order", "1")
    if said:
        assert (code, row) == (1, None)
        assert said in capsys.readouterr().err.splitlines()[-1]
        return
    assert code == 0
    assert (row["version"], row["equations"], row["iterations"]) == ("2.20", 12, 2)
    assert row["settings"] == "surface to surface, K = 10 E/mm, C3D4, SPOOLES"
    assert min(row["seconds"], row["memory"]) > 0
    assert row["peak"] == pytest.approx((4074.92 if 0 in slave else 5) / SPHERE_PEAK - 1)


def test_calculix_last_words():
    assert calculix.LastWords("a\n *ERROR in x\n  no material \nb\n") == "*ERROR in x no material"
    assert calculix.LastWords("a\n\n matrix found to be singular\n ______\n").endswith("singular")
    assert calculix.LastWords("") == ""


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


def test_kratos_mesh(mesh, tmp_path):
    kratos_files.WriteMesh(tmp_path / "job.mdpa", mesh)
    blocks = read_mdpa(tmp_path / "job.mdpa")

    def Numbers(name):
        return [int(row[0]) - 1 for row in blocks[name]]

    points = np.array(blocks["Nodes"], float)[:, 1:]
    assert Numbers("Nodes") == list(range(mesh.nvertices))
    elements = {int(row[0]) - 1: np.array(row[1:], int) for row in blocks["Elements"]}
    for i, name in enumerate(BODIES[mesh.problem]):
        own = np.flatnonzero(mesh.materials == name)
        assert Numbers(f"Body_{name}/SubModelPartElements") == own.tolist()
        assert (
            np.array([elements[k] for k in own]).tolist()
            == np.insert(mesh.elements[own, : mesh.dim + 1] + 1, 0, i + 1, axis=1).tolist()
        )
        inside = mesh.MaterialNodes(1, name).tolist()
        assert Numbers(f"Body_{name}/SubModelPartNodes") == inside
        shift = (1 - i) * SHIFT[mesh.problem] * np.eye(mesh.dim)[-1]
        assert points[inside, : mesh.dim] == pytest.approx(mesh.points[inside] - shift, abs=1e-14)
    conditions = {int(row[0]) - 1: [int(w) - 1 for w in row[2:]] for row in blocks["Conditions"]}
    assert len(conditions) == len(blocks["Conditions"])
    forces = kratos_files.NodalForces(mesh)
    wanted = {f"Contact_{name}": mesh.Faces(1, name).tolist() for name in ("slave", "master")}
    for name, faces in (wanted | {"Load": [[k] for k in np.flatnonzero(forces)]}).items():
        assert [conditions[k] for k in Numbers(f"{name}/SubModelPartConditions")] == faces
    for name, nodes in supported(points, mesh).items():
        assert set(Numbers(f"Held_{name}/SubModelPartNodes")) == nodes


def test_kratos_parameters(mesh):
    options = {"friction": 0.2, "steps": 10, "linear_solver": "some"}
    read = json.loads(json.dumps(kratos_files.Parameters(mesh, Path("a/job"), **options)))
    solver = read["solver_settings"]
    assert solver["time_stepping"]["time_step"] == 0.1
    assert solver["linear_solver_settings"]["solver_type"] == "some"
    assert solver["contact_settings"]["mortar_type"] == "ALMContactFrictional"
    held = {}
    for process in read["processes"]["constraints_process_list"]:
        given = process["Parameters"]
        assert given["value"] == [0.0 if fixed else None for fixed in given["constrained"]]
        name = given["model_part_name"].removeprefix("Structure.Held_")
        held[name] = given["constrained"].index(True)
    assert held == HELD[mesh.problem]
    for entry, name in zip(
        kratos_files.Materials(mesh, 0.2)["properties"], BODIES[mesh.problem], strict=True
    ):
        assert entry["model_part_name"] == f"Structure.Body_{name}"
        variables = entry["Material"]["Variables"]
        assert (variables["FRICTION_COEFFICIENT"], variables["YOUNG_MODULUS"]) == (0.2, YOUNG[name])


def test_kratos_and_ngsolve_have_the_same_load(mesh, files):
    forces, line = kratos_files.NodalForces(mesh), LOAD[mesh.problem]
    assert forces.sum() == pytest.approx(line, rel=CLOSE[mesh.problem])
    arguments = SimpleNamespace(mesh=files[mesh.problem], order=1)
    space = VectorH1(elastic.Read(arguments), order=1)
    vector = elastic.Loads(mesh, space).FV().NumPy().reshape(mesh.dim, -1)
    assert vector[-1] == pytest.approx(forces, abs=1e-9 * abs(line))
    assert not vector[:-1].any()


def test_kratos_knows_linear_faces_only(drive, monkeypatch, capsys):
    monkeypatch.setattr(kratos, "MISSING", None)
    assert drive(kratos, "sphere", "--order", "2") == (1, None)
    assert "use --order 1" in capsys.readouterr().err.splitlines()[-1]


# ---------------------------------------------------------------- GetFEM


@pytest.mark.parametrize("dim", [2, 3])
def test_getfem_second_order_nodes(dim):
    corners = np.vstack([np.zeros(dim), np.eye(dim)])
    nodes = np.vstack([corners, [(corners[a] + corners[b]) / 2 for a, b in EDGES[dim]]])
    lattice = [point[::-1] for point in product((0, 0.5, 1), repeat=dim) if sum(point) <= 1]
    assert nodes[getfem_peer.LATTICE[dim]].tolist() == [list(point) for point in lattice]


def test_getfem_dofs_of_nodes(mesh):
    """Of a vector-valued Lagrange space with its nodes in another order."""
    points = mesh.points[mesh.Nodes(2, "slave")]
    nodes = np.repeat(np.vstack([points + 1, points])[::-1], mesh.dim, axis=0)
    space = SimpleNamespace(basic_dof_nodes=lambda: nodes.T)
    dofs = getfem_peer.NodeDofs(space, points)
    assert np.array_equal(nodes[dofs[:, -1]], points)
    assert np.array_equal(dofs - dofs[:, :1], np.tile(np.arange(mesh.dim), (len(points), 1)))


# ---------------------------------------------------------------- what is not installed


@pytest.mark.parametrize(
    ("driver", "remedy"),
    [
        (calculix, "calculix-ccx"),
        (getfem_peer, "python3-getfem++"),
        (kratos, "KratosContactStructuralMechanicsApplication"),
    ],
)
def test_not_installed(driver, remedy, drive, tmp_path, monkeypatch, capsys):
    monkeypatch.setenv("PATH", str(tmp_path))
    monkeypatch.setattr(getfem_peer, "getfem", None)
    monkeypatch.setattr(kratos, "MISSING", ModuleNotFoundError("No module named 'Kratos'"))
    assert drive(driver, "patch", "--order", "1") == (3, None)
    (said,) = capsys.readouterr().out.splitlines()
    assert "install" in said
    assert remedy in said


def test_getfem_of_the_system_is_asked(monkeypatch):
    monkeypatch.setattr(getfem_peer, "SYSTEM_PYTHON", "/nowhere/python3")
    assert not getfem_peer.SystemPythonHasIt()
