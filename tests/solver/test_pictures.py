"""Scenes of the webgui, profiles and files for ParaView show what the table of a contact says."""

import base64
import resource
import signal

import matplotlib
import meshio
import numpy as np
import pytest
from matplotlib import pyplot as plt
from ngsolve import CF
from press import press, press3d

from ngslac.output.facepoints import FacePoints

matplotlib.use("Agg")


def Solved(problem):
    problem.load.Set(1)
    problem.solver().Solve(printing=False)
    return problem


@pytest.fixture(scope="module")
def flat():
    return Solved(press(friction=0.2))


@pytest.fixture(scope="module")
def solid():
    return Solved(press3d(friction=0.2))


@pytest.fixture(params=["flat", "solid"])
def problem(request):
    return request.getfixturevalue(request.param)


def Glyphs(contact, field, **options):
    """Positions (n, points, 3) of the objects of a scene by name, and what it shows."""
    data = contact.Draw(field, show=False, **options).GetData()
    points = {"lines": 2, "points": 1}
    return {
        o["name"]: np.reshape(o["position"], (-1, points[o["type"]], 3)) for o in data["objects"]
    }, data


def Corners(data):
    """First points of the triangles that a scene draws, (n, 4): place and value."""
    return np.frombuffer(base64.b64decode(data["Bezier_trig_points"][0]), np.float32).reshape(-1, 4)


def test_arrows(problem):
    contact = problem.contact
    table, macros = contact.Table(), np.array(contact.space.macros)
    lines = Glyphs(contact, "traction", size=0.3)[0]["traction"]
    d = contact.mesh.dim
    count = len(lines) // 10  # a shaft and nine lines of the head
    shafts = (lines[:count, 1] - lines[:count, 0])[:, :d]
    wanted = table["traction"][macros[macros >= 0]]
    wanted *= 0.3 / np.linalg.norm(wanted, axis=1).max()
    shown = np.linalg.norm(wanted, axis=1) > 3e-4
    np.testing.assert_allclose(shafts, wanted[shown], atol=1e-12)
    # All heads end where the shafts do.
    np.testing.assert_allclose(lines[:, 1], np.tile(lines[:count, 1], (10, 1)), atol=1e-12)


def test_arrows_start_on_the_slave(solid):
    lines = Glyphs(solid.contact, "normal")[0]["normal"]
    start = lines[: len(lines) // 10, 0]
    faces = FacePoints(solid.contact)
    np.testing.assert_allclose(start, faces.centers, atol=1e-12)


def test_bars_have_the_force_as_area(flat):
    contact = flat.contact
    table = contact.Table()
    lines = Glyphs(contact, "pressure", size=1)[0]["pressure"][..., :2]
    macros = np.array(contact.space.macros)
    tops = lines[-(macros >= 0).sum() :]
    feet = FacePoints(contact).ends.transpose(1, 0, 2)
    heights = np.linalg.norm(tops - feet, axis=2)
    widths = np.linalg.norm(feet[:, 1] - feet[:, 0], axis=1)
    area = (heights.mean(axis=1) * widths).sum()
    force = (table["pressure"] * table["fullarea"]).sum() / table["pressure"].max()
    assert area == pytest.approx(force, rel=1e-12)
    # They stand on the side of the outward normal, which is the master's.
    assert np.all(tops[..., 1] <= feet[..., 1])


def test_dots_for_each_status(flat):
    dots, _ = Glyphs(flat.contact, "status")
    macros = np.array(flat.contact.space.macros)
    status = flat.contact.Table()["status"][macros[macros >= 0]]
    assert [len(dots[name]) for name in ("open", "stick", "slip")] == [
        np.sum(status == s) for s in range(3)
    ]
    assert len(np.unique(status)) > 1


def test_ticks_at_the_ends_of_macro_elements():
    contact = press(order=1, h=0.125).contact
    ticks = Glyphs(contact, "macros")[0]["macros"]
    assert contact.space.nmacros == 4  # of two edges each
    # Neighbours share their ends.
    assert len(np.unique(ticks.mean(axis=1).round(9), axis=0)) == contact.space.nmacros + 1


def test_deformation_moves_bodies_and_glyphs(problem):
    contact, u = problem.contact, problem.gf.components[0]
    d = contact.mesh.dim
    shift = CF((3, -2, 1)[:d])
    (still, data), (moved, shifted) = (
        Glyphs(contact, "traction", deformation=f, scale=2) for f in (0 * shift, shift)
    )
    np.testing.assert_allclose(
        moved["traction"] - still["traction"],
        np.broadcast_to(np.pad([6, -4, 2][:d], (0, 3 - d)), moved["traction"].shape),
        atol=1e-9,
    )
    bodies = [Corners(scene)[:, :d] for scene in (data, shifted)]
    moved_by = np.broadcast_to([6, -4, 2][:d], bodies[0].shape)
    np.testing.assert_allclose(bodies[1] - bodies[0], moved_by, atol=1e-5)
    if d == 2:  # the bodies carry the displacement itself, not the scaled one
        scene = contact.Draw("traction", deformation=u, scale=50, show=False).GetData()
        assert scene["funcmax"] < 0.1


def test_background(flat):
    data = Glyphs(flat.contact, "pressure", background=CF(7))[1]
    assert data["funcmin"] == data["funcmax"] == 7


@pytest.mark.parametrize("field", ["pressure", "gap", "traction", "slip"])
def test_colours_in_space(solid, field):
    table = solid.contact.Table()
    values = table[field]
    values = values if values.ndim == 1 else np.linalg.norm(values, axis=1)
    data = Glyphs(solid.contact, field)[1]
    assert data["funcmax"] == pytest.approx(values.max(), rel=1e-6, abs=1e-12)
    assert data["funcmin"] == pytest.approx(values.min(), rel=1e-6, abs=1e-12)


def test_status_and_macros_in_space(solid):
    data = Glyphs(solid.contact, "status")[1]
    assert (data["funcmin"], data["funcmax"]) == (0, 2)
    assert data["gui_settings"]["colormap_ncolors"] == 3
    data = Glyphs(solid.contact, "macros")[1]
    assert len(np.unique(Corners(data)[:, 3].round())) == solid.contact.space.nmacros


def test_segments_are_drawn(problem):
    names = Glyphs(problem.contact, "segments")[0]
    assert len(names["contact segments"]) >= len(problem.contact.Segments())


def test_draw_before_the_first_solve():
    scene = press().contact.Draw("segments", show=False)
    assert scene.GetData()["objects"]


def test_profile_of_steps(flat):
    table = flat.contact.Table()
    axes = flat.contact.Plot("pressure", axes=plt.figure().gca(), label="p")
    s, p = axes.lines[0].get_data()
    area = np.nansum(np.diff(s) * p[:-1])
    assert area == pytest.approx(table["pressure"] @ table["fullarea"], rel=1e-12)
    assert axes.get_ylabel() == "pressure"
    assert axes.lines[0].get_label() == "p"


def test_profile_of_the_tangential_traction(flat):
    _, q = flat.contact.Plot("traction", axes=plt.figure().gca()).lines[0].get_data()
    q = q.reshape(-1, 3)[:, 0]
    np.testing.assert_allclose(np.sort(q), np.sort(flat.contact.Table()["traction"][:, 0]))


def test_profile_of_points(solid):
    contact = solid.contact
    radius = lambda points: np.hypot(points[:, 0], points[:, 1])  # noqa: E731
    r, q = contact.Plot("traction", along=radius, axes=plt.figure().gca()).lines[0].get_data()
    table = contact.Table()
    assert len(r) == contact.space.nmacros
    friction = table["traction"] + table["pressure"][:, None] * table["normal"]
    np.testing.assert_allclose(q, np.linalg.norm(friction, axis=1), atol=1e-12)


def test_profile_over_current_points(flat):
    u = flat.gf.components[0]
    lines = [
        flat.contact.Plot(deformation=f, axes=plt.figure().gca()).lines[0].get_xdata()
        for f in (None, u, 1000 * CF((1, 0)))
    ]
    assert 0 < abs(lines[1] - lines[0]).max() < 0.1
    np.testing.assert_allclose(lines[2] - lines[0], 1000)


def test_file_for_paraview(problem, tmp_path):
    contact = problem.contact
    path = contact.WriteVTU(tmp_path / "slave", displacement=problem.gf.components[0])
    mesh = meshio.read(path)
    macros = np.array(contact.space.macros)
    assert sum(len(block.data) for block in mesh.cells) == (macros >= 0).sum()
    number = mesh.point_data["macro"].ravel().round().astype(int)
    assert set(number) == set(range(contact.space.nmacros))
    table = contact.Table()
    for name in ("pressure", "gap", "status"):
        np.testing.assert_allclose(mesh.point_data[name].ravel(), table[name][number], atol=1e-12)
    d = contact.mesh.dim
    for name in ("traction", "slip", "normal"):
        assert mesh.point_data[name].shape[1] == 3
        np.testing.assert_allclose(mesh.point_data[name][:, :d], table[name][number], atol=1e-12)
    largest = np.linalg.norm(mesh.point_data["displacement"], axis=1).max()
    assert 0 < largest < 0.1


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda c: c.Draw("presure", show=False), "field = 'presure' must be one of 'pressure'"),
        (lambda c: c.Plot("normal"), "field = 'normal' must be one of 'pressure'"),
        (lambda c: c.Plot(along="z"), "along = 'z' must be one of 'x', 'y'"),
    ],
)
def test_bad_names(flat, call, message):
    with pytest.raises(ValueError, match=message):
        call(flat.contact)


def test_moment_about_the_origin(problem):
    d = problem.contact.mesh.dim
    moment = problem.contact.Moment()
    np.testing.assert_array_equal(moment, problem.contact.Moment((0,) * d))
    with pytest.raises(ValueError, match=f"must be a point with {d} coordinates"):
        problem.contact.Moment((0,) * (5 - d))


# --- files that cannot be written, and wrong arguments --------------------------------------------


@pytest.fixture(params=["fields", "segments"])
def write(request, problem):
    contact = problem.contact
    return contact.WriteVTU if request.param == "fields" else contact.Segments().WriteVTU


def test_a_missing_folder(write, tmp_path):
    with pytest.raises(FileNotFoundError, match=r"the folder .*missing is missing; make it first"):
        write(tmp_path / "missing" / "slave")


def test_a_full_disk(write, tmp_path):
    """The older file stays, and nothing is left of the new one."""
    (tmp_path / "slave.vtu").write_text("older")
    before = signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
    limits = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (1000, limits[1]))
    try:
        with pytest.raises(OSError, match=r"slave.*could not be written|too large"):
            write(tmp_path / "slave")
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, limits)
        signal.signal(signal.SIGXFSZ, before)
    assert [file.name for file in tmp_path.iterdir()] == ["slave.vtu"]
    assert (tmp_path / "slave.vtu").read_text() == "older"


def test_names_of_files(write, tmp_path):
    with pytest.raises(TypeError, match="filename = 3 must be the name of a file"):
        write(3)
    (tmp_path / "folder.vtu").mkdir()
    with pytest.raises(IsADirectoryError, match=r"folder\.vtu is a folder"):
        write(tmp_path / "folder")
    assert write(str(tmp_path / "a.b")).name == "a.b.vtu"
    assert [file.name for file in tmp_path.iterdir() if file.is_file()] == ["a.b.vtu"]


@pytest.mark.parametrize(
    ("verb", "flags", "error"),
    [
        ("Draw", {"field": "presure"}, ValueError),
        ("Draw", {"field": None}, TypeError),
        ("Draw", {"background": 3}, TypeError),
        ("Draw", {"deformation": CF(1)}, ValueError),
        ("Draw", {"deformation": (0, 1)}, TypeError),
        ("Draw", {"scale": "2"}, TypeError),
        ("Draw", {"size": -1}, ValueError),
        ("Draw", {"size": float("nan")}, ValueError),
        ("Plot", {"field": "normal"}, ValueError),
        ("Plot", {"field": 3}, TypeError),
        ("Plot", {"along": "w"}, ValueError),
        ("Plot", {"along": 0}, TypeError),
        ("Plot", {"deformation": CF((0, 0, 0, 0))}, ValueError),
        ("WriteVTU", {"filename": "never", "displacement": CF(1)}, ValueError),
        ("WriteVTU", {"filename": "never", "displacement": 1.0}, TypeError),
    ],
)
def test_wrong_arguments(flat, verb, flags, error):
    name = list(flags)[-1]
    with pytest.raises(error, match=f"{name} = .* must be "):
        getattr(flat.contact, verb)(**flags)


def test_a_function_of_another_shape(flat):
    with pytest.raises(ValueError, match=r"along returns an array of the shape \(\)"):
        flat.contact.Plot(along=lambda points: 3.0)
