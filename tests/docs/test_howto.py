"""The scripts of the how-to pages run as they stand, and their results are the stated ones."""

import re
from pathlib import Path

import numpy as np
import pytest
from howtos import Execute, Pages, Printed, Script
from ngsolve import Det, Grad, GridFunction, Id, InnerProduct, Integrate, Parameter, x
from press import press, same
from test_snippets import Fences

from ngslac import Law, LoadStepper

HOWTO = Path(__file__).parents[2] / "docs" / "howto"
NUMBER = re.compile(r"[-+]?\d+(?:\.\d*)?(?:e[-+]?\d+)?")


def CheckPrinted(shown, printed):
    """The words are those of the page, the numbers nearly so."""
    for one, other in zip(shown.splitlines(), printed.splitlines(), strict=True):
        words, wanted = ("".join(NUMBER.sub("#", line).split()) for line in (other, one))
        assert words == wanted
        numbers, found = (np.array(NUMBER.findall(line), dtype=float) for line in (one, other))
        size = np.abs(numbers).max(initial=0)
        assert found == pytest.approx(numbers, rel=0.03, abs=0.01 * size)


@pytest.fixture
def run(tmp_path, monkeypatch):
    """Execute the script of a page in a folder of its own; the names it leaves."""

    def Run(page):
        monkeypatch.chdir(tmp_path)
        names, printed = Execute(page)
        CheckPrinted(Printed(page), printed)
        return names

    return Run


def test_pages_are_complete():
    """Each has a picture, is in the index, and has a test of its results here."""
    pages, index = Pages(), (HOWTO / "index.md").read_text()
    assert len(pages) >= 17
    for page in pages:
        text = (HOWTO / f"{page}.md").read_text()
        assert f"(pictures/{page}.png)" in text
        assert (HOWTO / "pictures" / f"{page}.png").exists()
        assert f"({page}.md)" in index
        assert f"test_{page}" in globals()


NEW = ("drop_and_bounce", "own_law", "preload_force", "seal", "snap_fit", "stack")


@pytest.mark.parametrize("page", NEW)
def test_problems_are_short(page):
    assert len(Script(page).splitlines()) <= 40


def test_seal(run):
    low, high = run("seal")["contacts"]
    assert low.Force() == pytest.approx(-high.Force(), rel=1e-6)
    assert low.Force()[1] == pytest.approx(2.33, rel=0.02)


def test_rubber(run):
    names = run("rubber")
    u, mesh = names["gf"].components[0], names["mesh"]
    area = Integrate(Det(Id(2) + Grad(u)), mesh, definedon=mesh.Materials("rubber"))
    assert area == pytest.approx(20 * 12, rel=1e-9)
    assert names["contact"].Force()[1] == pytest.approx(11.8, rel=0.01)


def test_axisymmetric(run):
    """The axial force is the load; without friction tractions are normal to the cone."""
    names = run("axisymmetric")
    contact, (_, axial) = names["contact"], names["contact"].Force()
    assert axial == pytest.approx(2e3, rel=1e-4)  # the ball is of curved triangles
    table = contact.Table()
    along = table["traction"] + table["pressure"][:, None] * table["normal"]
    assert np.all(np.linalg.norm(along, axis=1) <= 0.2 * table["pressure"] * (1 + 1e-8))
    assert np.any(table["status"] > 0)


def test_torque():
    """The snippet: friction bears the torque, up to its bound at the end that slips."""
    ((snippet, _),) = Fences(HOWTO / "axisymmetric.md", {"python"})
    exec(snippet, names := {})
    table, least = names["table"], 1e-9
    assert np.all(table["pressure"] > 0)
    over = -table["flux_out"] / (0.2 * table["pressure"])
    assert over.max() == pytest.approx(1, rel=1e-8)
    slipped = np.abs(table["way"]) > least
    assert 0 < slipped.sum() < len(over)
    assert np.all(over[~slipped] < 1)
    assert np.all(over[slipped] > 1 - 1e-8)
    gf, end = names["gf"], names["mesh"].Boundaries("end")
    forces, arm = gf.vec.CreateVector(), GridFunction(gf.space)
    names["a"].Apply(gf.vec, forces)
    arm.components[1].Set(x, definedon=end)
    assert InnerProduct(arm.vec, forces) == pytest.approx(names["torque"], rel=1e-9)


def test_laws(run):
    """Friction of the speed, and what is worn off by pressure and way."""
    names = run("laws")
    table = names["contact"].Table()
    rate = np.linalg.norm(table["slip"], axis=1) / 1.0  # of the last step, of a second
    closed = table["status"] == 2
    expected = 0.2 + 0.2 * np.exp(-rate / 5)
    assert table["friction"][closed] == pytest.approx(expected[closed], rel=1e-6)
    work = 1e-4 * names["press"] * 10  # at most: the pressure falls
    assert work < names["worn"] < 1.5 * work


def test_stack(run):
    names = run("stack")
    carried = [contact.Force()[1] for contact in names["contacts"]]
    assert carried == pytest.approx([6.6, 4.0, 1.8], rel=1e-9)
    assert names["push"].Get() == pytest.approx(0.4)  # friction times weight: the exact limit


@pytest.mark.full
def test_snap_fit(run):
    names = run("snap_fit")
    assert names["largest"] == pytest.approx(0.077, rel=0.1)
    assert names["least"] == pytest.approx(-0.033, rel=0.1)
    assert names["pushes"][-1][1] == pytest.approx(0, abs=1e-9)  # snapped in


def test_drop_and_bounce(run):
    names = run("drop_and_bounce")
    assert names["lowest"][0] == pytest.approx(1.2, abs=0.05)
    assert 1.35 < names["highest"][1] < 1.5  # no higher than where it was let go
    assert names["stepper"].balance.impact > 0


def test_own_law(run):
    names = run("own_law")
    table = names["contact"].Table()
    assert table["pressure"].max() == pytest.approx(names["Coating"].limit, rel=1e-12)
    grows = (table["pressure"] > 0) & (table["pressure"] < 29.9)
    assert table["pressure"][grows] == pytest.approx(-300 * table["gap"][grows], rel=1e-6)


@pytest.fixture
def laws():
    """The laws on the page of laws of one's own that its script does not use."""
    names = {}
    for code, _ in Fences(HOWTO / "own_law.md", {"python"}):
        exec(code, names)
    return names


def places_at_random(d, n=40):
    """Made up as the page says, of every branch."""
    random = np.random.default_rng(d)
    normal = random.normal(size=(n, d))
    normal /= np.linalg.norm(normal, axis=1)[:, None]
    trial = random.normal(size=(n, d)) - 2 * random.normal(size=(n, 1)) * normal
    jump = 0.004 * random.normal(size=(n, d))
    farthest = np.where(np.arange(n) % 2, 1e-3, 5e-3)
    return {"normal": normal, "trial": trial, "jump": jump, "farthest": farthest}


@pytest.mark.parametrize(("law", "place"), [("Coulomb", "trial"), ("Glue", "jump")])
@pytest.mark.parametrize("d", [2, 3])
def test_derivatives_of_laws(laws, law, place, d):
    law, places, size = laws[law](), places_at_random(d), 1e-8
    derivative = law(places)["by_" + place]
    for k, way in enumerate(size * np.eye(d)):
        ahead, behind = (law(places | {place: places[place] + s * way}) for s in (1, -1))
        found = (ahead["traction"] - behind["traction"]) / (2 * size)
        assert found == pytest.approx(derivative[:, :, k], rel=1e-5, abs=1e-5)


@pytest.mark.parametrize("size", [0.01, 0.02, 0.04])
@pytest.mark.parametrize("dim", [2, 3])
def test_coulomb_on_the_page_is_friction(laws, dim, size):
    """Pressed first, then pushed: the macro-elements stick, some of them or all slide."""
    problems = []
    for law in ({"friction": 0.3}, {"law": laws["Coulomb"]()}):
        aside = Parameter(0.0)
        push = (*(size * aside, size / 2 * aside)[: dim - 1], -0.02)
        problems.append(press(dim=dim, push=push, **law))
        solver = problems[-1].solver()
        solver.Solve(printing=False)
        LoadStepper(solver, aside).Integrate(1, steps=1, printing=False)
    same(*problems, tol=1e-8)
    one, other = (problem.contact.Table()["status"] for problem in problems)
    assert np.array_equal(one, other)
    assert set(one) <= {1, 2}


def test_glue_on_the_page_goes_back_on_a_line(laws):
    law, jump = laws["Glue"](), np.array([[0.0, 5.5e-3]])
    first = law({"jump": jump} | law.kept)
    pull, kept = first["traction"], {"farthest": first["farthest"]}
    assert pull == pytest.approx(np.array([[0.0, -0.025]]))  # half of the strength
    back = law({"jump": jump / 2} | kept)
    assert back["traction"] == pytest.approx(pull / 2)
    assert back["farthest"] == kept["farthest"]
    assert np.all(law({"jump": 2 * jump} | kept)["traction"] == 0)


@pytest.mark.parametrize("finite", [False, True])
def test_glue_on_the_page_is_torn(laws, finite):
    """The pull rises to the strength, and falls to nothing."""
    problem = press(law=laws["Glue"](), tied=True, finite=finite, push=(0, 0.014))
    problem.load.Set(0)
    steps = LoadStepper(problem.solver(), problem.load).Integrate(1, steps=14, printing=False)
    pull = -np.array([step.forces[0][1] for step in steps])
    assert pull.max() == pytest.approx(0.05, rel=0.1)
    assert 0 < np.argmax(pull) < 5
    assert pull[-1] == pytest.approx(0, abs=1e-10)
    assert np.all(problem.contact.Table()["farthest"] > 0.01)


def test_wearing_on_the_page(laws):
    problem = press(law=laws["Wearing"]())
    problem.solver().Solve(printing=False)
    problem.contact.Commit(problem.gf)
    assert problem.contact.Table()["worn"].max() > 0


def test_preload_force(run):
    names = run("preload_force")
    assert names["force"] == pytest.approx(names["wanted"], rel=1e-4)


def test_press_fit(run):
    names = run("press_fit")
    assert names["lame"] == pytest.approx(69.23, abs=0.005)
    assert names["pressure"] == pytest.approx(names["lame"], rel=3e-3)


def test_rigid_tool(run):
    names = run("rigid_tool")
    push, lift = names["contact"].Force()
    assert lift == pytest.approx(-0.373, rel=0.02)
    assert abs(push) < 0.005 * abs(lift)  # symmetric but for the mesh


def test_bolt_preload(run):
    names = run("bolt_preload")
    assert names["clamp"] == pytest.approx([names["inside"]] * 3, rel=1e-5)
    assert names["inside"] == pytest.approx(8360, rel=0.01)


def test_contact_without_names(run):
    names = run("contact_without_names")
    assert len(names["found"].pairs) == 40 + 13  # those in two corners lie on two sides of the box
    assert names["carried"] == pytest.approx((0, 2.5), abs=1e-8)
    assert len({body for pair in names["forces"] for body in pair}) == 26


def test_heat_through_contact(run):
    names = run("heat_through_contact")
    contact, table = names["contact"], names["contact"].Table()
    out, into = contact.Flow()
    aside = table["traction"] + table["pressure"][:, None] * table["normal"]
    power = -np.sum(table["area"][:, None] * aside * table["slip"]) / 0.02
    assert into - out == pytest.approx(power, rel=1e-10)


def test_heat_across_interface(run):
    names = run("heat_across_interface")
    assert names["exact"] == pytest.approx(121.554, abs=1e-3)
    assert names["heat"] == pytest.approx(names["exact"], rel=1e-4)
    assert names["middle"] == pytest.approx(88.80, abs=0.02)


def test_heat_across_an_interface_that_resists():
    """The snippet below the script."""
    page = "heat_across_interface"
    ((film, _),) = Fences(HOWTO / f"{page}.md", {"python"})
    exec(film, names := {"Law": Law})
    exec(Script(page).replace("tied=True)", "tied=True, law=film)"), names)
    through = sum(np.log(b / a) / k for a, b, k in ((0.05, 0.06, 15.0), (0.06, 0.1, 0.5)))
    assert names["heat"] == pytest.approx(np.pi / 2 * 80 / (through + 1 / (200 * 0.06)), rel=1e-4)
    assert names["heat"] == pytest.approx(112.5, abs=0.05)


def test_many_bodies(run):
    names = run("many_bodies")
    for contact in names["contacts"]:
        assert contact.Force() == pytest.approx([-1000, 0, 5000], abs=1e-6)


def test_reaction_forces(run):
    names = run("reaction_forces")
    top, bottom = (np.array(names["forces"][name]) for name in ("top", "bottom"))
    assert bottom == pytest.approx([-6.05, 140.03], rel=0.02)
    assert bottom == pytest.approx(names["contact"].Force(), rel=1e-9)
    assert top == pytest.approx(-bottom, rel=1e-9)
    assert names["moment"] == pytest.approx(names["contact"].Moment((0, 0)), rel=1e-9)


def test_convergence_study(run):
    names = run("convergence_study")
    assert 1.5 < names["order"] < 2.5
    assert names["limit"] == pytest.approx(137.19, rel=1e-3)
    assert np.all(np.diff(names["errors"]) < 0)
    assert names["errors"] == pytest.approx([3.1e-3, 1.14e-3, 3e-4, 8e-5], rel=0.2)


def test_from_contactboundary(run):
    names = run("from_contactboundary")
    assert names["lac"] == pytest.approx(137.45, rel=5e-3)
    assert names["contact"].Force()[1] == pytest.approx(names["lac"], rel=1e-9)
    # The penalty gives way by 7e-6 of the 1e-3 that are pressed.
    assert 0.99 < names["penalty"] / names["lac"] < 1


def test_from_calculix(run, tmp_path):
    names = run("from_calculix")
    assert names["contact"].Force() == pytest.approx([0, 0, 5000], abs=1e-6)
    assert (tmp_path / "slave.vtu").exists()


def test_choosing_slave(run):
    names = run("choosing_slave")
    fine, coarse, both = names["results"].values()
    assert both[:2] == pytest.approx((0.00904, 0.0571), rel=0.01)
    assert fine[:2] == pytest.approx(both[:2], rel=0.01)
    assert coarse[:2] == pytest.approx(both[:2], rel=0.01)


def test_when_it_fails(run):
    names = run("when_it_fails")
    floats, slides = names["messages"]
    assert "'upper' floats (translation in x)" in floats
    assert "'upper' slides away" in slides
    assert names["contact"].Force() == pytest.approx([20, 100], rel=1e-9)


def test_on_many_cores(run):
    assert run("on_many_cores")["contact"].Force() == pytest.approx([0, 0, 0.01], abs=1e-9)
