"""The driver of CalculiX: its input, its results, how it fails. CalculiX is not needed."""

import json
import sys
from pathlib import Path

import numpy as np
import pytest

sys.path.insert(0, str(Path(__file__).parent / "peers"))

import calculix
import calculix_files
from boundary import BODIES, SHIFT
from meshes import HELD
from metrics import LINE_FORCE, PATCH_PRESSURE, SPHERE_LOAD, SPHERE_PEAK
from peercommand import Main
from tinypeers import TinyMesh

CASES = [(problem, order) for problem in BODIES for order in (1, 2)]

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


class Deck:
    """An input file of CalculiX, read again."""

    def __init__(self, file):
        self.blocks = []
        for line in file.read_text().splitlines():
            if line.startswith("*"):
                self.blocks.append((line, []))
            else:
                self.blocks[-1][1].append(line)
        self.points = {int(row[0]): np.array(row[1:], float) for row in self.Rows("*NODE,")}
        self.kind, self.elements = None, {}
        for line, data in self.blocks:
            if line.startswith("*ELEMENT"):
                self.kind = line.split("TYPE=")[1].split(",")[0]
                words = "".join(f"{row.rstrip(',')}," for row in data).split(",")
                size = int(self.kind[3:]) + 1
                rows = np.array(words[:-1], int).reshape(-1, size)
                self.elements |= {row[0]: row[1:] for row in rows.tolist()}

    def Rows(self, head):
        """Words of each data line of the block that begins so."""
        (data,) = (data for line, data in self.blocks if line.startswith(head))
        return [row.rstrip(",").split(",") for row in data]

    def FacePoints(self, name):
        """Coordinates of the corners of the faces of a surface."""
        for element, face in self.Rows(f"*SURFACE,NAME={name}"):
            nodes = self.elements[int(element)]
            yield np.array([self.points[nodes[k - 1]] for k in FACES[self.kind][int(face[1])]])


@pytest.fixture(params=CASES, ids=lambda case: f"{case[0]}-P{case[1]}")
def deck(request, tmp_path):
    """Mesh, order and input file of a problem."""
    problem, order = request.param
    mesh = TinyMesh(problem)
    calculix_files.WriteInput(tmp_path / "job.inp", mesh, order, steps=4, stiffness=700e3)
    return mesh, order, Deck(tmp_path / "job.inp")


def test_elements(deck):
    _, order, read = deck
    assert len(read.elements) == 2
    assert {node for nodes in read.elements.values() for node in nodes} == set(read.points)
    for nodes in read.elements.values():
        points = np.array([read.points[node] for node in nodes])
        assert np.linalg.det(points[[1, 2, 3]] - points[0]) > 0
        if order == 2:
            pairs = np.array(MIDS[read.kind]) - 1
            assert points[-len(pairs) :] == pytest.approx(points[pairs].mean(axis=1), abs=1e-12)


def test_surfaces(deck):
    mesh, _, read = deck
    shift = SHIFT[mesh.problem] * np.eye(mesh.dim)[-1]
    for name in ("slave", "master"):
        expected = mesh.points[mesh.Faces(1, name)[0]] - shift * (name == "slave")
        (points,) = read.FacePoints(name.upper())
        flat = np.unique(np.round(points[:, : mesh.dim], 9), axis=0)
        assert flat == pytest.approx(np.unique(np.round(expected, 9), axis=0), abs=1e-8)


def test_supports_and_load(deck):
    mesh, order, read = deck
    for name, component in HELD[mesh.problem].items():
        held = [int(word) for (word,) in read.Rows(f"*NSET,NSET=N{name.upper()}")]
        spots = np.array([read.points[node][: mesh.dim] for node in held])
        expected = calculix_files.Solid(mesh, order).points[mesh.Nodes(order, name), : mesh.dim]
        assert {tuple(row) for row in spots.round(9)} == {tuple(row) for row in expected.round(9)}
        assert [f"N{name.upper()}", f"{component + 1}", f"{component + 1}"] in read.Rows(
            "*BOUNDARY"
        )
    if mesh.dim == 2:
        force = sum(float(row[2]) for row in read.Rows("*CLOAD"))
        assert force == pytest.approx(-LINE_FORCE / 2)
        spots = {tuple(read.points[int(row[0])][:2]) for row in read.Rows("*CLOAD")}
        assert spots == {(0.0, 1.0 - SHIFT["hertz"])}
    else:
        pressure = SPHERE_LOAD if mesh.problem == "sphere" else PATCH_PRESSURE
        assert read.Rows("*DLOAD") == [["1", "P3", repr(pressure)]]


def test_contact_law(tmp_path):
    file = tmp_path / "job.inp"
    options = {"friction": 0.2, "steps": 10, "stiffness": 700e3}
    calculix_files.WriteInput(file, TinyMesh("hertz"), 1, **options)
    read = Deck(file)
    assert read.Rows("*SURFACE BEHAVIOR") == [["700000.0"]]
    assert read.Rows("*FRICTION") == [["0.2", "70000.0"]]
    assert read.Rows("*STATIC")[0][0] == "0.1"
    calculix_files.WriteInput(file, TinyMesh("sphere"), 2, variant="mortar")
    assert "TYPE=MORTAR" in file.read_text()
    assert "*SURFACE BEHAVIOR" not in file.read_text()


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
 -1         7 0.00000E+00 0.00000E+00 0.00000E+00 5.00000E+00 0.00000E+00 0.00000E+00
 -3
 -4  ERROR       1    1
 -1         1 3.00000E+00
 -3
 9999
"""


def test_pressures_of_the_last_block(tmp_path):
    file = tmp_path / "job.frd"
    file.write_text(FRD)
    assert calculix_files.ReadContact(file, 3).tolist() == [4074.92, 0, -0.125]
    file.write_text(FRD.replace("CONTACT", "STRESS "))
    with pytest.raises(ValueError, match="no contact stresses"):
        calculix_files.ReadContact(file, 3)


def test_displacements_of_the_last_step(tmp_path):
    head = " displacements (vx,vy,vz) for set NALL and time  0.{}0000000E+01\n\n"
    rows = "         1  1.234567E-03 -2.000000E+00  {}\n         2  0.000000E+00  0.0  1.0E+00\n"
    file = tmp_path / "job.dat"
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
    Path("job.sta").write_text("head\\n 1 1 1 2 0.1E+01 0.1E+01 0.1E+01\\n")
    print(" Job finished")
else:
    print(" *ERROR: too many cutbacks\\n best solution is written")
    raise SystemExit(201)
"""


@pytest.fixture
def program(tmp_path, monkeypatch):
    """Put a program ccx on the path that pretends to solve, or to fail."""

    def write(finished):
        file = tmp_path / "ccx"
        file.write_text(CCX.format(python=sys.executable, finished=finished, frd=FRD))
        file.chmod(0o755)
        monkeypatch.setenv("PATH", str(tmp_path))

    return write


def test_row(program, arguments, tmp_path):
    program(finished=True)
    line = arguments("sphere", "--order", "1")
    assert Main(calculix.Solve, peer="CalculiX", options=calculix.Options, argv=line) == 0
    row = json.loads((tmp_path / "row.json").read_text())
    assert (row["version"], row["equations"], row["iterations"]) == ("2.20", 12, 2)
    assert row["dofs"] == 24
    assert row["peak"] == pytest.approx(4074.92 / SPHERE_PEAK - 1)
    assert row["settings"] == "surface to surface, K = 10 E/mm, C3D4, SPOOLES"
    assert min(row["seconds"], row["memory"]) > 0


def test_fails(program, arguments, tmp_path, capsys):
    program(finished=False)
    line = arguments("sphere", "--order", "1")
    assert Main(calculix.Solve, peer="CalculiX", options=calculix.Options, argv=line) == 1
    said = capsys.readouterr().err.splitlines()[-1]
    assert "ccx ended with 201: *ERROR: too many cutbacks best solution" in said
    assert not (tmp_path / "row.json").exists()


def test_last_words():
    assert calculix.LastWords("a\n *ERROR in x\n  no material \nb\n") == "*ERROR in x no material"
    assert calculix.LastWords("a\n\n matrix found to be singular\n ______\n").endswith("singular")
    assert calculix.LastWords("") == ""


def test_unfinished_run_counts_as_failure(tmp_path):
    file = tmp_path / "job.sta"
    assert not calculix.Completed(file)
    file.write_text("SUMMARY\n STEP INC\n 1 1 1 5 0.5E+00 0.5E+00 0.5E+00\n")
    assert not calculix.Completed(file)
