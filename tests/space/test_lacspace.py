"""LACSpace as an NGSolve space: functions, integrals, pictures, pickles, refinement."""

import pickle

import numpy as np
import pytest
from bricks import KINDS, ball, brick, middle, mixed, slave_faces, unstructured
from ngsolve import (
    BND,
    CF,
    BilinearForm,
    GridFunction,
    InnerProduct,
    Integrate,
    VectorH1,
    VTKOutput,
    ds,
    x,
)
from ngsolve.webgui import Draw
from partitions import SPACES, check_partition, cores, faces_of_macros, sizes

from ngslac import LACContact, LACSpace
from ngslac.meshes import TwoBlocks

SLAVE = "bottom|surface"
MESHES = {
    "trig": lambda: brick("trig", 7),
    "disc": lambda: ball(2, 0.5, 3),
    "tet": lambda: brick("tet", 4, 1),
    "mixed": mixed,
    "ball": lambda: ball(3, 1.5),
}


def values(gf):
    return gf.vec.FV().NumPy()


@pytest.mark.parametrize("order", [1, 2])
@pytest.mark.parametrize("space", ["VectorH1", "H1(dim)"])
@pytest.mark.parametrize("name", MESHES)
def test_area_and_mean_values(name, space, order):
    """The mass matrix holds the areas; a form with a displacement gives its mean values."""
    mesh = MESHES[name]()
    rel = 1e-9 if name in ("ball", "disc") else 1e-12  # two rules of order 10 on curved faces
    Q = LACSpace(SPACES[space](mesh, order=order), slave=SLAVE)
    one, own = Q.WithComponents(1), faces_of_macros(Q)
    area = np.array(Integrate(CF(1), mesh, BND, element_wise=True, order=10))
    expected = np.array([area[faces].sum() for faces in own])
    lam, mu = one.TnT()
    on_slave = ds(SLAVE, bonus_intorder=10)
    mass = BilinearForm(lam * mu * on_slave, check_unused=False).Assemble().mat
    numbers = GridFunction(one)
    values(numbers)[:] = np.arange(1, one.ndof + 1)
    product = (mass * numbers.vec).Evaluate().FV().NumPy()
    assert product == pytest.approx(expected * values(numbers), rel=rel)
    total = Integrate(numbers, mesh.Boundaries(SLAVE), BND, order=10)
    assert total == pytest.approx(expected @ values(numbers), rel=1e-13)
    gf = GridFunction(Q.displacement * Q)
    (u, _), (_, mu) = gf.space.TnT()
    coupling = BilinearForm(InnerProduct(u, mu) * on_slave, check_unused=False).Assemble().mat
    gf.components[0].Set(CF((x, 1, 2)[: mesh.dim]))
    first = Integrate(gf.components[0][0], mesh, BND, element_wise=True, order=10)
    wanted = [np.array(first)[faces].sum() for faces in own]
    wanted = np.stack([wanted, *(expected * k for k in (1, 2)[: mesh.dim - 1])], axis=1)
    gf.vec.data = (coupling * gf.vec).Evaluate()
    assert values(gf.components[1]).reshape(-1, mesh.dim) == pytest.approx(wanted, abs=rel)
    assert not np.any(values(gf.components[0]))


@pytest.mark.parametrize("name", ["trig", "disc", "mixed"])
def test_functions_are_constant_on_macro_elements(name):
    mesh = MESHES[name]()
    gf = GridFunction(LACSpace(VectorH1(mesh, order=1), slave=SLAVE))
    values(gf)[:] = np.arange(len(values(gf)))
    if name != "disc":
        for el in slave_faces(mesh):
            point = np.append(middle(mesh, el), 0.0)[:3]
            macro = gf.space.macros[el.nr]
            value = [mesh.dim * macro + k for k in range(mesh.dim)]
            assert gf(mesh(*point, BND)) == pytest.approx(value)
    assert Integrate(InnerProduct(gf, gf), ~mesh.Boundaries(SLAVE), BND) == 0
    gf.Set(CF((3, -4, 5)[: mesh.dim]), definedon=mesh.Boundaries(SLAVE))
    for k, value in enumerate((3, -4, 5)[: mesh.dim]):
        assert values(gf)[k :: mesh.dim] == pytest.approx(value)


@pytest.mark.parametrize("name", ["trig", "mixed"])
def test_pictures(name, tmp_path):
    mesh = MESHES[name]()
    Q = LACSpace(VectorH1(mesh, order=1), slave="bottom")
    for k, gf in enumerate((GridFunction(Q.WithComponents(1)), GridFunction(Q)[1])):
        path = tmp_path / f"{k}.html"
        Draw(gf, mesh.Boundaries("bottom"), "pressure", filename=str(path))
        assert path.stat().st_size > 1000
    VTKOutput(mesh, [GridFunction(Q)], ["traction"], filename=str(tmp_path / "t")).Do(vb=BND)
    assert (tmp_path / "t.vtu").stat().st_size > 1000


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("space", SPACES)
def test_pickle(space, kind):
    V = SPACES[space](brick(kind, 3, 1), order=1)
    own = LACSpace(V, slave="bottom")
    for space, part in ((own, lambda gf: gf), (V * own, lambda gf: gf.components[1])):
        gf = GridFunction(space)
        values(part(gf))[:] = np.arange(own.ndof * own.dim) ** 2
        again = part(pickle.loads(pickle.dumps(gf)))
        assert np.array_equal(values(again), values(part(gf)))
        Q = again.space
        assert type(Q.displacement) is type(V)
        check_partition(Q)
        assert list(Q.macros) == list(own.macros)
        assert cores(Q) == cores(own)
    assert type(pickle.loads(pickle.dumps(own))) is LACSpace


@pytest.mark.pairwise
@pytest.mark.parametrize("autoupdate", [True, False])
@pytest.mark.parametrize("space", ["VectorH1", "H1(dim)", "Bubble"])
@pytest.mark.parametrize("order", [1, 2, 3])
@pytest.mark.parametrize("dim", [2, 3])
def test_refinement(dim, order, space, autoupdate):
    """A refined mesh gets macro-elements of its own; who wants V updated wants Q updated, too."""
    mesh = unstructured(dim, 0.4)
    V = SPACES[space](mesh, order=order, autoupdate=autoupdate)
    Q = LACSpace(V, slave="bottom")
    n, gf = len(slave_faces(mesh)), GridFunction(Q, autoupdate=autoupdate)
    mesh.Refine()
    if not autoupdate:
        for what in (V, Q, gf):
            what.Update()
    check_partition(Q)
    assert len(slave_faces(mesh)) == n * 2 ** (dim - 1)
    single = order >= dim or space == "Bubble"
    assert (sizes(Q) == [1] * len(slave_faces(mesh))) == single
    assert len(gf.vec) == Q.ndof == Q.FreeDofs().NumSet()


@pytest.mark.parametrize("space", ["VectorH1", "H1(dim)"])
def test_refinement_in_a_product_space(space):
    """A contact on the refined product space pairs anew and has fields of the new size."""
    mesh = TwoBlocks(0.34, structured=True)
    V = SPACES[space](mesh, order=2, autoupdate=True)
    X = V * LACSpace(V, slave="slave")
    gf = GridFunction(X, autoupdate=True)
    u, lam = X.TrialFunction()
    contact = LACContact(u, lam, master="master")
    contact.Update()
    n = contact.space.nmacros
    area = contact.Check().paired_area
    mesh.Refine()
    X.Update()
    gf.Update()
    assert X.components[1].nmacros == contact.space.nmacros == 2 * n
    assert len(gf.vec) == X.ndof == X.components[0].ndof + X.components[1].ndof
    contact.Update(gf)
    assert contact.Check().paired_area == pytest.approx(area, rel=1e-12)
    assert len(contact.Table()["area"]) == contact.pressure.space.nmacros == 2 * n
    assert len(contact.normal.vec) * contact.normal.space.dim == 4 * n
    contact.form.SetConstant(1.0)
    contact.AssembleLinearization(gf.vec)
    assert contact.form.mat.height == X.ndof * X.dim
