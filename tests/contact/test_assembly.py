"""Contact without names: which faces are paired, the slave side, forces, ties, bad input."""

import numpy as np
import pytest
from netgen.occ import (
    Box,
    Circle,
    Compound,
    Cylinder,
    Glue,
    MoveTo,
    OCCGeometry,
    Rectangle,
    X,
    Y,
    Z,
)
from ngsolve import (
    BND,
    CF,
    BilinearForm,
    FESpace,
    Grad,
    GridFunction,
    InnerProduct,
    Integrate,
    Mesh,
    Parameter,
    Sym,
    VectorH1,
    dx,
)
from posed import elastic, posed

from ngslac import ContactSolver, FindContacts, LoadStepper
from ngslac.materials import Stress


def clevis(order=2):
    """An eye in a fork, held together by a pin with play."""
    hole = Cylinder((0, 0, -1), Z, 0.3, 2)
    eye = Box((-0.6, -0.6, -0.2), (2, 0.6, 0.2)) - hole
    upper = Box((-2, -0.6, 0.22), (0.6, 0.6, 0.5)) - hole
    lower = Box((-2, -0.6, -0.5), (0.6, 0.6, -0.22)) - hole
    pin = Cylinder((0, 0, -0.6), Z, 0.295, 1.2)
    for solid, name in (eye, "eye"), (upper, "upper"), (lower, "lower"), (pin, "pin"):
        solid.solids.name = name
    eye.faces.Max(X).name = "pull"
    geometry = OCCGeometry(Compound([eye, upper, lower, pin]))
    return Mesh(geometry.GenerateMesh(maxh=0.3)).Curve(order)


@pytest.mark.parametrize("order", [1, 2])
def test_an_assembly_is_paired_as_one_would(order):
    mesh = clevis(order)
    before = mesh.GetBoundaries()
    found = FindContacts(mesh, within=0.04)
    sides = {frozenset((pair.slave, pair.master)) for pair in found.pairs}
    names = "eye upper", "eye lower", "pin eye", "pin upper", "pin lower"
    assert sides == {frozenset(two.split()) for two in names}
    assert not found.left_out
    assert mesh.GetBoundaries() == before
    assert set(found.mesh.GetBoundaries()) == set(before)
    assert found.mesh.GetCurveOrder() == order
    assert found.mesh.Boundaries("pull").Mask().NumSet() == 1
    for pair in found.pairs:
        low, high = pair.gap
        assert low <= high < 0.03
        assert low > 0 or order == 1
        areas = [Integrate(1.0, faces) for faces in (pair.slave_faces, pair.master_faces)]
        assert min(areas) > 0
    one, other = (Integrate(CF(1), m, BND) for m in (mesh, found.mesh))
    assert other == pytest.approx(one, rel=1e-12)
    assert str(found).count("\n") == 4


def grains(order=None, gap=0.002, n=3):
    """A block of n x n squares on a floor; `order` is the seed of a random order of bodies."""
    parts = []
    for i in range(n):
        for j in range(n):
            face = MoveTo(i * (1 + gap), j * (1 + gap)).Rectangle(1, 1).Face()
            face.faces.name, face.faces.maxh = "grain", 0.26
            parts.append(face)
    floor = MoveTo(-1, -1 - gap).Rectangle(n + 2, 1).Face()
    floor.faces.name, floor.edges.name = "floor", "side"
    floor.edges.Min(Y).name = "ground"
    parts.append(floor)
    if order is not None:
        parts = [parts[k] for k in np.random.default_rng(order).permutation(len(parts))]
    return Mesh(OCCGeometry(Compound(parts), dim=2).GenerateMesh(maxh=0.5))


def solved(found, *, weight=1e-3, **law):
    V = VectorH1(found.mesh, order=2, dirichlet="ground")
    fes = FESpace([V, *found.Spaces(V)])
    u, *lams = fes.TrialFunction()
    v, *_ = fes.TestFunction()
    a = BilinearForm(fes)
    a += InnerProduct(Stress(Sym(Grad(u)), 100.0, 0.3), Sym(Grad(v))) * dx
    a += weight * v[1] * dx("grain")
    contacts = found.Contacts(u, lams, **law)
    ContactSolver(a, GridFunction(fes), contacts).Solve(printing=False)
    return found.Forces(contacts)


def test_forces_of_pairs_balance():
    """On each grain, the forces of its neighbours balance its weight."""
    found = FindContacts(grains(), within=0.05)
    forces = solved(found, friction=0.3)
    assert len(found.pairs) == 15
    total = {}
    for (slave, master), force in forces.items():
        total[slave] = total.get(slave, 0) + force
        total[master] = total.get(master, 0) - force
    assert total.pop("floor") == pytest.approx((0, -9e-3), abs=1e-9)
    assert len(total) == 9
    for force in total.values():
        assert force == pytest.approx((0, 1e-3), abs=1e-9)
    assert "grain 5" in " ".join(found.left_out)  # it pairs with no diagonal neighbour


def test_the_order_of_bodies_does_not_matter():
    reports, forces = [], []
    for order in (None, 1, 2):
        found = FindContacts(grains(order), within=0.05)
        reports.append({frozenset((pair.slave, pair.master)) for pair in found.pairs})
        total = sum(
            (-1 if slave == "floor" else 1) * force
            for (slave, master), force in solved(found).items()
            if "floor" in (slave, master)
        )
        forces.append(total)
    assert reports[0] == reports[1] == reports[2]
    for force in forces:
        assert force == pytest.approx((0, 9e-3), abs=1e-9)


def stack(names=("slave", "master")):
    """A block on a plate; `names` are those of the two sides that face each other."""
    low, up = Rectangle(2, 1).Face().Move((0, -1, 0)), MoveTo(0.4, 0.05).Rectangle(1, 0.6).Face()
    for face, name, h in (low, "low", 0.5), (up, "grain", 0.1):
        face.faces.name, face.edges.name, face.faces.maxh = name, "side", h
    if names:
        up.edges.Min(Y).name, low.edges.Max(Y).name = names
    low.edges.Min(Y).name = "ground"
    return Mesh(OCCGeometry(Compound([low, up]), dim=2).GenerateMesh(maxh=0.5))


@pytest.mark.parametrize("tied", [False, True])
def test_as_with_names(tied):
    mesh = stack()
    V = VectorH1(mesh, order=2, dirichlet="ground")
    law = {"tied": True} if tied else {"friction": 0.3}
    problem = posed(V, elastic(100.0, 0.3), lambda u, v, load: 1e-3 * v[1] * dx("grain"), **law)
    problem.solver().Solve(printing=False)
    options = {"tied": [("grain", "low")]} if tied else {}
    found = FindContacts(stack(None), within=0.06, **options)
    (pair,) = found.pairs
    assert (pair.slave, pair.master, pair.tied) == ("grain", "low", tied)
    (force,) = solved(found, friction=0.3).values()
    assert force == pytest.approx(problem.contact.Force(), abs=1e-9)
    assert force[1] == pytest.approx(0.6e-3, rel=1e-9)


def test_the_softer_one_is_the_slave_where_faces_are_alike():
    for moduli, slave in (((100, 1), "b"), ((1, 100), "a")):
        parts = [MoveTo(0, y).Rectangle(1, 1).Face() for y in (0, 1.01)]
        for part, name in zip(parts, "ab", strict=True):
            part.faces.name, part.faces.maxh = name, 0.3
        mesh = Mesh(OCCGeometry(Compound(parts), dim=2).GenerateMesh())
        young = dict(zip("ab", moduli, strict=True))
        (pair,) = FindContacts(mesh, within=0.02, young=young).pairs
        assert pair.slave == slave


def test_masters_and_what_is_left_out():
    (pair,) = FindContacts(stack(None), within=0.06, masters=["grain"]).pairs
    assert (pair.slave, pair.master) == ("low", "grain")
    found = FindContacts(stack(None), within=0.03)
    assert not found.pairs
    assert "farther than faces are paired" in found.left_out[0]


@pytest.mark.parametrize("dim", [2, 3])
def test_a_small_foot_on_a_large_face(dim):
    """The foot lies between the points at which the large face is sampled."""
    if dim == 2:
        plate, foot = Rectangle(2, 1).Face(), MoveTo(0.95, 1.001).Rectangle(0.1, 0.1).Face()
        plate.faces.name, foot.faces.name, foot.faces.maxh = "plate", "foot", 0.05
        mesh = Mesh(OCCGeometry(Compound([plate, foot]), dim=2).GenerateMesh(maxh=2, grading=0.9))
    else:
        plate, foot = Box((0, 0, 0), (2, 2, 1)), Box((0.8, 0.9, 1.001), (0.9, 1, 1.1))
        plate.solids.name, foot.solids.name, foot.faces.maxh = "plate", "foot", 0.05
        mesh = Mesh(OCCGeometry(Compound([plate, foot])).GenerateMesh(maxh=2, grading=0.9))
    (pair,) = FindContacts(mesh, within=0.01).pairs
    assert (pair.slave, pair.master) == ("foot", "plate")
    assert pair.gap == pytest.approx((0.001, 0.001))


def test_a_foot_at_the_edge_of_a_plate():
    """Nearer sides that face elsewhere do not hide the face that the foot stands on."""
    plate, foot = Rectangle(2, 1).Face(), MoveTo(1.7, 1.001).Rectangle(0.3, 0.3).Face()
    plate.faces.name, foot.faces.name, foot.faces.maxh = "plate", "foot", 0.05
    foot.edges.Min(Y).name, foot.edges.Max(Y).name = "below", "above"
    mesh = Mesh(OCCGeometry(Compound([plate, foot]), dim=2).GenerateMesh(maxh=2, grading=0.9))
    found = FindContacts(mesh, within=0.01, tied=[("plate", "plate")])
    (pair,) = found.pairs
    assert pair.count == sum(1 for _ in mesh.Boundaries("below").Elements())
    assert "tie of plate to plate" in found.left_out[0]


def test_sheets_thinner_than_the_distance():
    """No face is paired through its own body, or through a sheet in between."""
    sheets = [Box((0, 0, 0.02 * k), (1, 1, 0.02 * (k + 1))) for k in range(4)]
    for k, sheet in enumerate(sheets):
        sheet.solids.name, sheet.faces.maxh = f"sheet{k}", 0.2 + 0.05 * (k % 2)
    ngmesh = OCCGeometry(Compound(sheets)).GenerateMesh(maxh=0.3)
    found = FindContacts(Mesh(ngmesh), within=0.015)
    assert len(found.pairs) == 3
    for pair in found.pairs:
        assert pair.gap == pytest.approx((0, 0), abs=1e-12)
    thicker = FindContacts(Mesh(ngmesh), within=0.05)
    for pair in thicker.pairs:
        assert pair.gap[0] > -1e-12
    assert thicker.Spaces(VectorH1(thicker.mesh, order=3))


def test_names_of_bodies_differ():
    """Also if a material is called like a numbered body, or a body has two materials."""
    names, parts = ("block", "block", "block 1"), []
    for k, name in enumerate(names):
        part = MoveTo(2 * k, 0.01).Rectangle(1, 1).Face()
        part.faces.name = name
        parts.append(part)
    base = Glue([MoveTo(0, -1).Rectangle(3, 1).Face(), MoveTo(3, -1).Rectangle(3, 1).Face()])
    base.faces[0].name, base.faces[1].name = "steel", "rubber"
    mesh = Mesh(OCCGeometry(Compound([*parts, base]), dim=2).GenerateMesh(maxh=0.5))
    found = FindContacts(mesh, within=0.02, masters=["rubber"], tied=[("rubber", "block")])
    assert {pair.master for pair in found.pairs} == {"steel+rubber"}
    assert len({pair.slave for pair in found.pairs}) == 3
    assert sum(pair.tied for pair in found.pairs) == 2


def test_curved_edges_stay_curved():
    """Also if bodies are paired along only a part of the edges."""
    hub = Circle((0, 0), 2).Face() - Circle((0, 0), 1).Face()
    shaft = Circle((0, 0), 1.01).Face()
    hub.faces.name, shaft.faces.name = "a(2)|b", "shaft"
    mesh = Mesh(OCCGeometry(Compound([hub, shaft]), dim=2).GenerateMesh(maxh=0.4)).Curve(3)
    found = FindContacts(mesh, within=0.05)
    assert Integrate(1.0, found.mesh) == pytest.approx(Integrate(1.0, mesh), rel=1e-13)
    assert {found.pairs[0].slave, found.pairs[0].master} == {"a(2)|b", "shaft"}


def test_a_mesh_whose_bodies_share_a_boundary(tmp_path):
    """A mesh from a file may have one: the boundary is divided, and keeps its name."""
    mesh = stack(None)
    mesh.ngmesh.Elements1D().NumPy()["index"][:] = 1
    mesh.ngmesh.SetBCName(0, "outside")
    mesh.ngmesh.Save(str(tmp_path / "mesh.vol"))
    mesh = Mesh(str(tmp_path / "mesh.vol"))
    found = FindContacts(mesh, within=0.06)
    (pair,) = found.pairs
    assert set(found.mesh.GetBoundaries()) == set(mesh.GetBoundaries())
    assert not np.any((pair.slave_faces * pair.master_faces).Mask().NumSet())
    V = VectorH1(found.mesh, order=2)
    u, *lams = FESpace([V, *found.Spaces(V)]).TrialFunction()
    assert len(found.Contacts(u, lams, friction=0.1)) == 1


def test_bodies_that_meet_later():
    """A block is pushed from one plate on to the next one."""
    plates = [MoveTo(s, -1).Rectangle(1.98, 1).Face() for s in (0, 2)]
    block = MoveTo(0.6, 0.001).Rectangle(1, 0.5).Face()
    for face, name in zip((*plates, block), ("first", "second", "grain"), strict=True):
        face.faces.name, face.edges.name = name, "side"
        face.faces.maxh = 0.17 if name == "grain" else 0.3
    for plate in plates:
        plate.edges.Min(Y).name = "ground"
    block.edges.Max(Y).name = "top"
    mesh = Mesh(OCCGeometry(Compound([*plates, block]), dim=2).GenerateMesh(maxh=0.3))
    found = FindContacts(mesh, within=0.01, sliding=1.3)
    V = VectorH1(found.mesh, order=2, dirichlet="ground|top")
    fes = FESpace([V, *found.Spaces(V)])
    u, *lams = fes.TrialFunction()
    v, *_ = fes.TestFunction()
    a = BilinearForm(fes)
    a += InnerProduct(Stress(Sym(Grad(u)), 100.0, 0.3), Sym(Grad(v))) * dx
    contacts, way = found.Contacts(u, lams, finite=True), Parameter(0)
    held = {"top": CF((1.9 * way, -0.011)), "ground": CF((0, 0))}
    stepper = LoadStepper(ContactSolver(a, GridFunction(fes), contacts), way, prescribe=held)
    stepper.Integrate(0.1, steps=1, printing=False)
    forces = found.Forces(contacts)
    assert forces["grain", "first"][1] > 0.5
    assert np.abs(forces.get(("grain", "second"), np.zeros(2))).max() < 1e-9
    stepper.Integrate(1, steps=12, printing=False)
    forces = found.Forces(contacts)
    assert forces["grain", "second"][1] > 0.5
    assert np.abs(forces.get(("grain", "first"), np.zeros(2))).max() < 1e-9


def test_bad_input():
    mesh = stack()
    for within in (0, -1, np.nan, None, "near"):
        with pytest.raises((TypeError, ValueError), match="within"):
            FindContacts(mesh, within=within)
    with pytest.raises(TypeError, match="mesh"):
        FindContacts(mesh.ngmesh, within=1)
    with pytest.raises(ValueError, match="angle"):
        FindContacts(mesh, within=1, angle=91)
    with pytest.raises(ValueError, match="sliding"):
        FindContacts(mesh, within=1, sliding=-1)
    with pytest.raises(ValueError, match="grain, low"):
        FindContacts(mesh, within=1, tied=[("low", "wood")])
    with pytest.raises(ValueError, match="grain, low"):
        FindContacts(mesh, within=1, young={"wood": 1.0})
    with pytest.raises(ValueError, match="pairs of names"):
        FindContacts(mesh, within=1, tied=("low", "grain"))
    with pytest.raises(TypeError, match="young"):
        FindContacts(mesh, within=1, young=3.0)
    with pytest.raises(TypeError, match="masters"):
        FindContacts(mesh, within=1, masters="low")
    found = FindContacts(mesh, within=1e-6)
    assert "no bodies face each other" in str(found)
    assert found.Spaces(VectorH1(found.mesh)) == []
    found = FindContacts(mesh, within=0.06)
    V = VectorH1(found.mesh, order=2)
    u, *_ = FESpace([V, *found.Spaces(V)]).TrialFunction()
    with pytest.raises(ValueError, match="one for each of Spaces"):
        found.Contacts(u, [])
