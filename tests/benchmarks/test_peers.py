"""The drivers of CalculiX, Kratos and GetFEM pose the same problem, read results and fail.

None of these programs is needed.
"""

import json
import re
import sys
from itertools import product
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
OPTIONS = {"friction": 0.2, "steps": 10, "linear_solver": "some"}


def calculix_deck(mesh, order, folder):
    """An input file of CalculiX, read again; numbers from 0."""
    given = SimpleNamespace(**OPTIONS, variant="penalty")
    file, blocks = folder / "job.inp", {}
    calculix_files.WriteInput(file, calculix_files.Solid(mesh, order), given, 700e3)
    for line in re.sub(r",\n(?!\*)", ",", file.read_text()).splitlines():  # lines that go on
        if line.startswith("*"):
            block = blocks.setdefault(line, [])
        else:
            block.append([word for word in line.split(",") if word])

    def Rows(head):
        return [row for line, rows in blocks.items() if line.startswith(head) for row in rows]

    def Numbers(head):
        return np.array(Rows(head), int) - 1

    def Corners(element, face):
        return elements[int(element) - 1][np.array(FACES[kind][int(face[1])]) - 1]

    def Loads():
        yield from ((float(force), points[int(node) - 1]) for node, _, force in Rows("*CLOAD"))
        for element, face, pressure in Rows("*DLOAD"):
            a, b, c = points[Corners(element, face)]
            yield -float(pressure) * abs(np.cross(b - a, c - a)[2]) / 2, a

    kind, points = calculix_files.KINDS[mesh.dim, order], np.array(Rows("*NODE,"), float)[:, 1:]
    names = BODIES[mesh.problem]
    bodies = {name: Numbers(f"*ELEMENT,TYPE={kind},ELSET={name.upper()}") for name in names}
    elements = {row[0]: row[1:] for row in np.concatenate([*bodies.values()])}
    supports = {name: int(first) - 1 for name, first, _ in Rows("*BOUNDARY") if name != "NALL"}
    return SimpleNamespace(
        points=points,
        bodies=bodies,
        young=[float(row[0]) for row in Rows("*ELASTIC")],
        faces=[
            [Corners(*r) for r in Rows(f"*SURFACE,NAME={name}")] for name in ("SLAVE", "MASTER")
        ],
        held={(k, *Numbers(f"*NSET,NSET={name}").ravel()) for name, k in supports.items()},
        loads=Loads(),
        Rows=Rows,
    )


def mdpa_blocks(file):
    """Rows of numbers of each block of Kratos' mesh file."""
    blocks, path = {}, []
    for line in file.read_text().splitlines():
        kind, *rest = line.split()
        if kind == "Begin":
            path.append(rest[0] if rest[0] != "SubModelPart" else rest[1])
            blocks.setdefault("/".join(path), [])
        elif kind == "End":
            path.pop()
        else:
            blocks["/".join(path)].append([float(word) for word in line.split()])
    assert not path
    return blocks


def kratos_deck(mesh, order, folder):
    """Mesh, materials and supports of Kratos, read again; numbers from 0."""
    kratos_files.WriteMesh(folder / "job.mdpa", mesh)
    blocks = mdpa_blocks(folder / "job.mdpa")

    def Entities(name):
        return {int(number) - 1: np.array(row, int) for number, *row in blocks[name]}

    def Part(name, kind):
        return np.array(blocks[f"{name}/SubModelPart{kind}"], int).ravel() - 1

    def Faces(name):
        return [conditions[k][1:] - 1 for k in Part(name, "Conditions")]

    def Body(number, entry):
        name = entry["model_part_name"].removeprefix("Structure.")
        own = Part(name, "Elements")
        assert {elements[k][0] for k in own} == {entry["properties_id"]} == {number}
        nodes = np.array([elements[k][1:] for k in own]) - 1
        assert Part(name, "Nodes").tolist() == np.unique(nodes).tolist()
        return name.removeprefix("Body_"), np.column_stack([own, nodes])

    def Held(model_part_name, constrained, value, **_):
        assert value == [0.0 if fixed else None for fixed in constrained]
        return constrained.index(True), *Part(model_part_name.removeprefix("Structure."), "Nodes")

    elements, conditions = Entities("Elements"), Entities("Conditions")
    points, forces = np.array(blocks["Nodes"])[:, 1:], kratos_files.NodalForces(mesh)
    materials = kratos_files.Materials(mesh, 0.2)["properties"]
    supports = kratos_files.Parameters(mesh, folder / "job")["processes"][
        "constraints_process_list"
    ]
    assert np.concatenate(Faces("Load")).tolist() == np.flatnonzero(forces).tolist()
    for name in ("slave", "master"):  # the normals point outwards
        assert np.array(Faces(f"Contact_{name}")).tolist() == mesh.Faces(1, name).tolist()
    return SimpleNamespace(
        points=points,
        bodies=dict(Body(number, entry) for number, entry in enumerate(materials, 1)),
        young=[entry["Material"]["Variables"]["YOUNG_MODULUS"] for entry in materials],
        faces=[Faces(f"Contact_{name}") for name in ("slave", "master")],
        held={Held(**process["Parameters"]) for process in supports},
        loads=((forces[k], points[k]) for k in np.flatnonzero(forces)),
    )


@pytest.fixture(
    params=[(calculix_deck, 1), (calculix_deck, 2), (kratos_deck, 1)],
    ids=["ccx-1", "ccx-2", "kratos"],
)
def deck(request, mesh, tmp_path):
    """What a program gets of a problem."""
    read, order = request.param
    return read(mesh, order, tmp_path)


def test_deck_poses_the_problem(deck, mesh):
    dim, points, names = mesh.dim, deck.points, BODIES[mesh.problem]
    lowered = SHIFT[mesh.problem] * np.eye(dim)[-1]
    assert deck.young == [YOUNG[name] for name in names]
    assert set(np.concatenate([rows[:, 1:].ravel() for rows in deck.bodies.values()])) == set(
        range(len(points))
    )
    for name, down in zip(names, (lowered, 0 * lowered), strict=True):
        own = deck.bodies[name]
        assert own[:, 0].tolist() == np.flatnonzero(mesh.materials == name).tolist()
        wanted = mesh.points[mesh.Elements(1, name)] - down
        assert points[own[:, 1 : dim + 2], :dim] == pytest.approx(wanted, abs=1e-10)
    for name, down, faces in zip(
        ("slave", "master"), (lowered, 0 * lowered), deck.faces, strict=True
    ):
        found = [np.unique(points[face, :dim].round(9), axis=0) for face in faces]
        wanted = [sorted((mesh.points[f] - down).round(9).tolist()) for f in mesh.Faces(1, name)]
        assert np.array(found) == pytest.approx(np.array(wanted), abs=1e-8)
    planes = {k: np.isclose(points[:, k], points[:, k].min()) for k in HELD[mesh.problem].values()}
    held = {(row[0], *sorted(row[1:])) for row in deck.held}
    assert held == {(k, *np.flatnonzero(plane)) for k, plane in planes.items()}
    forces, places = map(np.array, zip(*deck.loads, strict=True))
    assert forces.sum() == pytest.approx(LOAD[mesh.problem], rel=CLOSE[mesh.problem])
    assert places[:, dim - 1] == pytest.approx(points[:, dim - 1].max())
    assert dim == 3 or np.allclose(places[:, :2], [0, 99.95], atol=1e-12)


@pytest.mark.parametrize("order", [1, 2])
def test_calculix_numbers_nodes_as_its_manual(order, mesh, tmp_path):
    deck, kind = calculix_deck(mesh, order, tmp_path), calculix_files.KINDS[mesh.dim, order]
    assert mesh.dim == 3 or ["NALL", "3", "3"] in deck.Rows("*BOUNDARY")
    assert all(first == last for _, first, last in deck.Rows("*BOUNDARY"))
    points = deck.points[np.concatenate([*deck.bodies.values()])[:, 1:]]
    assert points.shape[1] == int(kind[3:])
    assert np.linalg.det(points[:, 1:4] - points[:, :1]).min() > 0
    if order == 2:
        ends = points[:, np.array(MIDS[kind]) - 1]
        bow = np.linalg.norm(points[:, -len(MIDS[kind]) :] - ends.mean(axis=2), axis=-1)
        most = 1e-9 if mesh.problem == "patch" else 0.2  # others are curved
        assert (bow < most * np.ptp(ends, axis=2).max(axis=-1)).all()


def test_decks_have_the_contact_law(files, tmp_path):
    mesh, file = Load(files["hertz"]), tmp_path / "hard.inp"
    deck = calculix_deck(mesh, 2, tmp_path)
    assert deck.Rows("*SURFACE BEHAVIOR") == [["700000.0"]]
    assert deck.Rows("*FRICTION") == [["0.2", "70000.0"]]
    assert deck.Rows("*STATIC,SOLVER=some")[0][0] == "0.1"
    mortar = SimpleNamespace(**OPTIONS | {"variant": "mortar", "friction": 0.0})
    calculix_files.WriteInput(file, calculix_files.Solid(mesh, 1), mortar)
    assert re.findall("TYPE=MORTAR|SURFACE BEHAVIOR|FRICTION", file.read_text()) == ["TYPE=MORTAR"]
    read = json.loads(json.dumps(kratos_files.Parameters(mesh, tmp_path, **OPTIONS)))
    solver = read["solver_settings"]
    assert solver["time_stepping"]["time_step"] == 0.1
    assert solver["linear_solver_settings"]["solver_type"] == "some"
    assert solver["contact_settings"]["mortar_type"] == "ALMContactFrictional"
    for entry in kratos_files.Materials(mesh, 0.2)["properties"]:
        assert entry["Material"]["Variables"]["FRICTION_COEFFICIENT"] == 0.2


def test_kratos_and_ngsolve_have_the_same_load(mesh, files):
    forces, line = kratos_files.NodalForces(mesh), LOAD[mesh.problem]
    arguments = SimpleNamespace(mesh=files[mesh.problem], order=1)
    space = VectorH1(elastic.Read(arguments), order=1)
    vector = elastic.Loads(mesh, space).FV().NumPy().reshape(mesh.dim, -1)
    assert vector[-1] == pytest.approx(forces, abs=1e-9 * abs(line))
    assert not vector[:-1].any()


# ---------------------------------------------------------------- results of CalculiX

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
 -1     99999 0.00000E+00 0.00000E+00 0.00000E+00 5.00000E+00 0.00000E+00 0.00000E+00
 -3
 -4  ERROR       1    1
 -1         1 3.00000E+00
 -3
 9999
"""


def test_calculix_results_of_the_last_step(tmp_path):
    file = tmp_path / "job.frd"
    file.write_text(FRD)
    assert calculix_files.ReadContact(file, 3).tolist() == [4074.92, 0, -0.125]
    file.write_text(FRD.replace("CONTACT", "STRESS "))
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
    print(" Job finished\\n ______")
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
    node, program = Load(files["sphere"]).Nodes(1, "slave")[0] + 1, tmp_path / "ccx"
    frd = FRD.replace("     99999", f"{node:10d}")
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
    assert row["peak"] == pytest.approx(5 / SPHERE_PEAK - 1)


# ---------------------------------------------------------------- GetFEM, what is not there


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
    dofs = getfem_peer.NodeDofs(SimpleNamespace(basic_dof_nodes=lambda: nodes.T), points)
    assert np.array_equal(nodes[dofs[:, -1]], points)
    assert np.array_equal(dofs - dofs[:, :1], np.tile(np.arange(mesh.dim), (len(points), 1)))


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
    monkeypatch.setattr(getfem_peer, "SYSTEM_PYTHON", "/nowhere/python3")
    assert not getfem_peer.SystemPythonHasIt()
    monkeypatch.setattr(kratos, "MISSING", ModuleNotFoundError("No module named 'Kratos'"))
    assert drive(driver, "patch", "--order", "1") == (3, None)
    (said,) = capsys.readouterr().out.splitlines()
    assert "install" in said
    assert remedy in said
