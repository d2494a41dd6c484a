"""Scenes of the webgui, profiles and files for ParaView show what the table of a contact says."""

import base64
import json
import shutil
from functools import cache
from io import BytesIO
from pathlib import Path

import matplotlib
import meshio
import numpy as np
import pytest
from law import shear
from matplotlib import pyplot as plt
from ngsolve import CF, Integrate
from PIL import Image
from press import press, solved
from scipy.spatial.transform import Rotation

from ngslac.output.facepoints import FacePoints

matplotlib.use("Agg")


@cache
def pressed(dim):
    problem = press(dim=dim, friction=0.2)
    solved(problem)
    return problem


@pytest.fixture(params=[2, 3])
def problem(request):
    return pressed(request.param)


@pytest.fixture
def flat():
    return pressed(2).contact


@pytest.fixture
def solid():
    return pressed(3).contact


def macros_of_faces(contact):
    macros = np.array(contact.space.macros)
    return macros[macros >= 0]


# --- scenes --------------------------------------------------------------------------------------


def glyphs(contact, field, **options):
    """Positions (n, points, 3) of the objects of a scene by name, and what it shows."""
    data = contact.Draw(field, show=False, **options).GetData()
    points = {"lines": 2, "points": 1}
    objects = data["objects"]
    return {o["name"]: np.reshape(o["position"], (-1, points[o["type"]], 3)) for o in objects}, data


def corners(data):
    """First points of the triangles that a scene draws, (n, 4): place and value."""
    return np.frombuffer(base64.b64decode(data["Bezier_trig_points"][0]), np.float32).reshape(-1, 4)


def added(data):
    """Triangles (n, 3, 3) of the patches of a scene by name, and its legend."""
    first = data["on_init"].splitlines()[0]
    found = json.loads(first.removeprefix("const added = ").removesuffix(";"))
    patches = {
        p["name"]: np.frombuffer(base64.b64decode(p["position"]), np.float32).reshape(-1, 3, 3)
        for p in found["patches"]
    }
    return patches, dict(found["legend"])


def area(triangles):
    sides = np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0])
    return np.linalg.norm(sides, axis=1).sum() / 2


def test_arrows_and_segments(problem):
    contact = problem.contact
    lines = glyphs(contact, "traction", size=0.3)[0]["traction"]
    count = len(lines) // 10  # a shaft and nine lines of the head
    shafts = (lines[:count, 1] - lines[:count, 0])[:, : contact.mesh.dim]
    wanted = contact.Table()["traction"][macros_of_faces(contact)]
    wanted *= 0.3 / np.linalg.norm(wanted, axis=1).max()
    shown = np.linalg.norm(wanted, axis=1) > 3e-4
    np.testing.assert_allclose(shafts, wanted[shown], atol=1e-12)
    # All heads end where the shafts do: where the master pushes, on the face.
    np.testing.assert_allclose(lines[:, 1], np.tile(lines[:count, 1], (10, 1)), atol=1e-12)
    centers = FacePoints(contact).centers
    ends = lines[:count, 1, : contact.mesh.dim]
    np.testing.assert_allclose(ends, centers[shown], atol=1e-12)
    lines = glyphs(contact, "normal")[0]["normal"]
    start = lines[: len(lines) // 10, 0, : contact.mesh.dim]
    np.testing.assert_allclose(start, centers, atol=1e-12)
    drawn = glyphs(contact, "segments")[0]["contact segments"]
    assert len(drawn) >= len(contact.Segments())


def test_bars_have_the_force_as_area(flat):
    table = flat.Table()
    lines, data = glyphs(flat, "pressure", size=1, background=CF(7))
    assert data["funcmin"] == data["funcmax"] == 7
    lines = lines["pressure"][..., :2]
    tops = lines[-len(macros_of_faces(flat)) :]
    feet = FacePoints(flat).ends.transpose(1, 0, 2)
    heights = np.linalg.norm(tops - feet, axis=2)
    widths = np.linalg.norm(feet[:, 1] - feet[:, 0], axis=1)
    force = (table["pressure"] * table["fullarea"]).sum() / table["pressure"].max()
    assert (heights.mean(axis=1) * widths).sum() == pytest.approx(force, rel=1e-12)
    assert area(added(data)[0]["pressure (filled)"]) == pytest.approx(force, rel=1e-6)
    # They stand on the side of the outward normal, which is the master's.
    assert np.all(tops[..., 1] <= feet[..., 1])


def test_bands_for_each_status(flat):
    bands, legend = added(glyphs(flat, "status")[1])
    assert list(legend) == list(bands) == ["open", "stick", "slip"]
    status = flat.Table()["status"][macros_of_faces(flat)]
    counts = [len(bands[name]) / 2 for name in legend]
    assert counts == [np.sum(status == s) for s in range(3)]
    assert len(np.unique(status)) > 1
    # Bodies that no function colours are pale, so that marks are seen on them.
    assert np.min(flat.Draw("status", show=False).GetData()["colors"]) > 0.8


def test_strokes_at_the_ends_of_macro_elements():
    """Without a solution, which no field needs."""
    contact = press(order=1, h=0.125).contact
    strokes = added(glyphs(contact, "macros")[1])[0]["macros"]
    assert contact.space.nmacros == 4  # of two edges each
    # Neighbours share their ends.
    middles = strokes.reshape(2, -1, 3, 3).mean(axis=(0, 2)).round(6)
    assert len(np.unique(middles, axis=0)) == contact.space.nmacros + 1
    assert contact.Draw("segments", show=False).GetData()["objects"]


def test_deformation_moves_bodies_and_glyphs(problem):
    contact, u, d = problem.contact, problem.gf.components[0], problem.mesh.dim
    shift = CF((3, -2, 1)[:d])
    (still, data), (moved, shifted) = (
        glyphs(contact, "traction", deformation=f, scale=2) for f in (0 * shift, shift)
    )
    way = np.array([6, -4, 2][:d])
    for before, after, tolerance in (
        (still["traction"][..., :d], moved["traction"][..., :d], 1e-9),
        (corners(data)[:, :d], corners(shifted)[:, :d], 1e-5),
    ):
        np.testing.assert_allclose(after, before + way, atol=tolerance)
    if d == 2:  # the bodies carry the displacement itself, not the scaled one
        scene = contact.Draw("traction", deformation=u, scale=50, show=False).GetData()
        assert scene["funcmax"] < 0.1


def test_colours_in_space(solid):
    for field in ("pressure", "gap", "traction", "slip"):
        values = solid.Table()[field]
        values = values if values.ndim == 1 else np.linalg.norm(values, axis=1)
        data = glyphs(solid, field)[1]
        found = data["funcmin"], data["funcmax"]
        assert found == pytest.approx((values.min(), values.max()), rel=1e-6, abs=1e-12)
    data = glyphs(solid, "status")[1]
    assert (data["funcmin"], data["funcmax"]) == (0, 2)
    assert data["gui_settings"]["Objects"] == {"Colorbar": False}  # words in its place
    legend = added(data)[1]
    assert list(legend) == ["open", "stick", "slip"]
    colours = np.array(data["colors"]) * 255
    wanted = [[int(c[k : k + 2], 16) for k in (1, 3, 5)] for c in legend.values()]
    np.testing.assert_allclose(colours, wanted)
    data = glyphs(solid, "macros")[1]
    assert len(np.unique(corners(data)[:, 3].round())) == solid.space.nmacros


def test_bodies_are_translucent(solid):
    """All their surfaces but the slave face, drawn before it."""
    shift = CF((3, -2, 1))
    for deformation, way in ((None, 0), (shift, (3, -2, 1))):
        data = solid.Draw("pressure", deformation=deformation, show=False).GetData()
        bodies = added(data)[0]["Bodies"]
        whole, slave = (Integrate(1, solid.mesh.Boundaries(r)) for r in (".*", "slave"))
        assert area(bodies) == pytest.approx(whole - slave, rel=1e-5)
        low = np.min([v.point for v in solid.mesh.vertices], axis=0)
        np.testing.assert_allclose(bodies.min(axis=(0, 1)), low + way, atol=1e-5)
    found = json.loads(data["on_init"].splitlines()[0][len("const added = ") : -1])["patches"][0]
    assert 0 < found["opacity"] < 0.5
    assert found["behind"]


def test_camera_looks_at_the_slave_face(solid):
    data = solid.Draw("pressure", show=False).GetData()
    centers, normals = FacePoints(solid).centers, FacePoints(solid).normals
    turn = Rotation.from_euler("XYZ", data["gui_settings"]["camera"]["euler_angles"], degrees=True)
    assert turn.apply(normals)[:, 2].min() > 0.6  # towards the viewer
    assert turn.apply((0, 0, 1))[1] > 0  # what is above is above
    np.testing.assert_allclose(data["mesh_center"], centers.mean(axis=0), atol=1e-12)
    assert 0.5 < data["mesh_radius"] / FacePoints(solid).diameter < 2
    own = solid.Draw("pressure", euler_angles=[0, 0, 0], radius=9, show=False).GetData()
    assert own["gui_settings"]["camera"]["euler_angles"] == [0, 0, 0]
    assert own["mesh_radius"] == 9


def test_faces_without_partner_are_gray():
    """They have no gap; the ends of the colours are those of the others."""
    for dim in (2, 3):
        contact = press(dim=dim, n=(7, 2), h=0.1, mesh_flags={"overhang": -0.3}).contact
        contact.Update()
        gaps = contact.Table()["gap"]
        alone = np.isnan(gaps)
        assert 0 < alone.sum() < len(gaps)
        data = contact.Draw("gap", show=False).GetData()
        patches, legend = added(data)
        assert list(legend) == ["no partner"]
        faces = np.sum(alone[macros_of_faces(contact)])
        if dim == 3:
            found = area(patches["no partner"])
            assert found == pytest.approx(contact.Table()["fullarea"][alone].sum(), rel=1e-5)
            assert np.isnan(corners(data)[:, 3]).any()
            ends = data["funcmin"], data["funcmax"]
            assert ends == (gaps[~alone].min(), gaps[~alone].max())
        else:
            assert len(patches["no partner"]) == 2 * faces


@pytest.mark.full
@pytest.mark.parametrize("dim", [pytest.param(2, marks=pytest.mark.full), 3])
def test_scenes_in_a_browser(dim, tmp_path):
    """Bodies, words and colours are on the screen, without errors."""
    chromium = shutil.which("chromium") or shutil.which("chromium-browser")
    sync_api = pytest.importorskip("playwright.sync_api")
    widgets = pytest.importorskip("webgui_jupyter_widgets")
    if chromium is None:
        pytest.skip("live scenes are looked at in Chromium, which is not installed")
    script = (Path(widgets.__file__).parent / "js" / "webgui.js").read_text()
    data = json.dumps(pressed(dim).contact.Draw("status", show=False).GetData())
    (tmp_path / "scene.html").write_text(
        f"<body><div id=box style='width: 600px; height: 400px'></div><script>{script}</script>"
        f"<script>scene = new webgui.Scene(); scene.init(box, {data})</script>"
    )
    flags = ["--use-angle=swiftshader", "--enable-unsafe-swiftshader"]
    with sync_api.sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=chromium, args=flags)
        page, errors = browser.new_page(), []
        page.on("pageerror", lambda error: errors.append(str(error)))
        page.goto((tmp_path / "scene.html").as_uri())
        page.wait_for_timeout(1500)
        for word in ("open", "stick", "slip"):
            assert page.get_by_text(word, exact=True).last.is_visible()
        picture = Image.open(BytesIO(page.screenshot())).convert("RGB")
        browser.close()
    assert not errors
    pixels = np.asarray(picture).reshape(-1, 3).astype(int)
    orange = (pixels[:, 0] > 180) & (abs(pixels[:, 1] - 150) < 40) & (pixels[:, 2] < 60)
    assert orange.sum() > 300
    assert len(np.unique(pixels, axis=0)) > 30


def test_recovered_fields(problem):
    contact, smooth = problem.contact, problem.contact.Recovered()
    centers = FacePoints(contact)
    _, data = glyphs(contact, "recovered pressure")
    if contact.mesh.dim == 3:
        assert data["funcmax"] >= centers.Evaluate(smooth.pressure).max() * (1 - 1e-6)
    arrows = glyphs(contact, "recovered traction", size=1)[0]["recovered traction"]
    count = len(arrows) // 10
    lengths = np.linalg.norm(arrows[:count, 1] - arrows[:count, 0], axis=1)
    assert lengths.max() == pytest.approx(1, rel=1e-12)
    for field in ("recovered pressure", "recovered traction"):
        s, v, _ = profile(contact, field)
        assert len(s) == len(v) == len(centers.macro) * (10 if contact.mesh.dim == 2 else 1)
    _, p, _ = profile(contact, "recovered pressure")
    assert np.nanmin(p) >= 0


# --- profiles ------------------------------------------------------------------------------------


def profile(contact, field="pressure", **flags):
    """The plotted points, and the axes."""
    axes = contact.Plot(field, axes=plt.figure().gca(), **flags)
    return *axes.lines[0].get_data(), axes


def test_profile_of_steps(flat):
    table = flat.Table()
    s, p, axes = profile(flat, label="p")
    force = table["pressure"] @ table["fullarea"]
    assert np.nansum(np.diff(s) * p[:-1]) == pytest.approx(force, rel=1e-12)
    assert (axes.get_ylabel(), axes.lines[0].get_label()) == ("pressure", "p")
    _, q, _ = profile(flat, "traction")  # its tangential part
    np.testing.assert_allclose(np.sort(q.reshape(-1, 3)[:, 0]), np.sort(table["traction"][:, 0]))


def test_profile_of_points(solid):
    r, q, _ = profile(solid, "traction", along=lambda points: np.hypot(points[:, 0], points[:, 1]))
    assert len(r) == solid.space.nmacros
    np.testing.assert_allclose(q, np.linalg.norm(shear(solid.Table()), axis=1), atol=1e-12)


def test_profile_over_current_points(flat):
    u = pressed(2).gf.components[0]
    still, now, far = (profile(flat, deformation=f)[0] for f in (None, u, CF((1000, 0))))
    assert 0 < abs(now - still).max() < 0.1
    np.testing.assert_allclose(far - still, 1000)


# --- files ---------------------------------------------------------------------------------------


def test_file_for_paraview(problem, tmp_path):
    contact, d = problem.contact, problem.mesh.dim
    path = contact.WriteVTU(tmp_path / "slave", displacement=problem.gf.components[0])
    mesh = meshio.read(path)
    assert sum(len(block.data) for block in mesh.cells) == len(macros_of_faces(contact))
    number = mesh.point_data["macro"].ravel().round().astype(int)
    assert set(number) == set(range(contact.space.nmacros))
    for name in ("pressure", "gap", "status", "traction", "slip", "normal"):
        found, expected = mesh.point_data[name], contact.Table()[name][number]
        if expected.ndim > 1:
            assert found.shape[1] == 3
        found = found[:, :d] if expected.ndim > 1 else found.ravel()
        np.testing.assert_allclose(found, expected, atol=1e-12)
    assert mesh.point_data["recovered pressure"].min() >= 0
    assert mesh.point_data["recovered traction"].shape[1] == 3
    largest = np.linalg.norm(mesh.point_data["displacement"], axis=1).max()
    assert 0 < largest < 0.1


@pytest.mark.parametrize(
    ("verb", "flags", "error", "wanted"),
    [
        ("Draw", {"field": "presure"}, ValueError, "must be one of 'pressure'"),
        ("Draw", {"background": 3}, TypeError, "must be "),
        ("Draw", {"deformation": CF(1)}, ValueError, "must be "),
        ("Draw", {"scale": "2"}, TypeError, "must be "),
        ("Draw", {"size": float("nan")}, ValueError, "must be "),
        ("Plot", {"field": "normal"}, ValueError, "must be one of 'pressure'"),
        ("Plot", {"along": "z"}, ValueError, "must be one of 'x', 'y'"),
        ("Plot", {"along": 0}, TypeError, "must be "),
        ("Plot", {"along": lambda points: 3.0}, ValueError, r"an array of the shape \(\)"),
        ("Plot", {"deformation": (0, 1)}, TypeError, "must be "),
        ("WriteVTU", {"filename": "never", "displacement": CF(1)}, ValueError, "must be "),
        ("Moment", {"point": (0, 0, 0)}, ValueError, "must be a point with 2 coordinates"),
    ],
)
def test_wrong_arguments(flat, verb, flags, error, wanted):
    with pytest.raises(error, match=f"{list(flags)[-1]} .*{wanted}"):
        getattr(flat, verb)(**flags)
