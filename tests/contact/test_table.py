"""What fields and tables say of macro-elements without a partner, and of open ones."""

import numpy as np
import pytest
from blocks import block_mesh, contact_form
from ngsolve import GridFunction
from press import press

from ngslac import ContactSolver


@pytest.fixture(scope="module", params=["2D", "tet"])
def contact(request):
    """The master covers the middle of the slave."""
    if request.param == "2D":
        return contact_form(block_mesh(2, 0.2))
    return contact_form(block_mesh(3, "tet", "prism", 5, 3, overhang=-0.5))


def of_fields(contact):
    return contact.gap.vec.FV().NumPy()


@pytest.mark.parametrize("finite", [False, True])
def test_no_gap_without_a_partner(finite, contact):
    table = contact.Table()
    alone = table["area"] == 0
    assert 0 < alone.sum() < len(alone)
    assert np.array_equal(np.isnan(table["gap"]), alone)
    assert np.array_equal(np.isnan(of_fields(contact)), alone)
    assert contact.form.Table()["gap"][alone] == pytest.approx(0)
    report = contact.Check()
    assert len(report.undefined) == 0
    assert np.isfinite([report.min_gap, report.max_gap]).all()


def test_switched_off_there_is_no_gap(contact):
    contact.Deactivate()
    assert np.isnan(of_fields(contact)).all()
    contact.Activate()
    assert np.isfinite(of_fields(contact)).any()


def test_pictures_without_a_partner(contact, tmp_path):
    meshio = pytest.importorskip("meshio")
    scene = contact.Draw("gap", show=False).GetData()
    assert np.isfinite([scene.get("funcmin", 0), scene.get("funcmax", 0)]).all()
    for thing in scene["objects"]:
        assert np.isfinite(thing["position"]).all()
    lines = contact.Plot("gap").lines[-1].get_ydata()
    assert np.isnan(lines).any()
    gaps = meshio.read(contact.WriteVTU(tmp_path / "slave")).point_data["gap"]
    assert 0 < np.isnan(gaps).sum() < len(gaps)


@pytest.mark.parametrize("solver", ["interface", "direct", "iterative"])
@pytest.mark.parametrize("finite", [False, True])
def test_what_is_open_has_no_pressure_at_all(solver, finite):
    problem = press(h=0.25, friction=0.3, finite=finite, master="master")
    problem.load.Set(3.0)
    ContactSolver(problem.a, problem.gf, problem.contact, solver=solver).Solve(printing=False)
    contact, table = problem.contact, problem.contact.Table()
    is_open = table["status"] == 0
    assert not np.any(table["pressure"][is_open])
    assert not np.any(table["traction"][is_open])
    assert not np.any(np.signbit(table["pressure"][is_open]))
    dofs = contact.form.MultiplierDofs().reshape(len(is_open), -1)
    assert not np.any(problem.gf.vec.FV().NumPy()[dofs[is_open]])
    assert not np.any(contact.pressure.vec.FV().NumPy()[is_open])


def test_tractions_of_what_is_open_do_not_count(contact):
    """An iterate may have some: they are none of the solution."""
    gf = GridFunction(contact.form.fes)
    gf.vec.FV().NumPy()[contact.form.MultiplierDofs()] = 1.0
    contact.Evaluate(gf)
    table = contact.Table()
    is_open = table["status"] == 0
    assert is_open.any()
    assert not np.any(table["traction"][is_open])
    assert contact.Force() == pytest.approx(table["area"] @ table["traction"], abs=1e-12)
