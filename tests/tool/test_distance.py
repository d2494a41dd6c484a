"""Signed distances of tools: values, derivatives, and what is refused."""

import struct

import numpy as np
import pytest
from netgen.occ import Box, OCCGeometry, Sphere
from ngsolve import (
    H1,
    GridFunction,
    IfPos,
    Mesh,
    Norm,
    NumberSpace,
    Parameter,
    floor,
    sqrt,
    x,
    y,
    z,
)

from ngslac import tools
from ngslac.facets import _Facets
from ngslac.meshes.boxes import StructuredBox

POINTS = np.random.default_rng(1).uniform(-2, 2, (300, 3))
CUBE = np.array([[i, j, k] for i in (-1, 1) for j in (-1, 1) for k in (-1, 1)], float)
SIDES = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
TRIANGLES = np.array([t for a, b, c, d in SIDES for t in ((a, b, c), (a, c, d))])
SQUARE = [(-1, -1), (1, -1), (1, 1), (-1, 1)]
STAR = [(0, 0), (1, 0), (1, 1), (0.5, 0.2)]

TOOLS = {
    "line": tools.Plane((0.1, 0), (1, 2)),
    "plane": tools.Plane((0, 0, 1), (1, 2, 3)),
    "disc": tools.Sphere((0.1, 0), 0.7),
    "sphere": tools.Sphere((0.1, 0, 0.2), 0.7),
    "cylinder": tools.Cylinder((0.1, 0, 0), (1, 1, 0), 0.5),
    "cone": tools.Cone((0, 0.1, 0), (1, 1, 0), 0.5),
    "torus": tools.Torus((0, 0.1, 0), (1, 1, 0), 1, 0.3),
    "function": tools.SignedDistance(sqrt(x * x + y * y + z * z) - Parameter(0.6)),
    "plane function": tools.SignedDistance(sqrt(x * x + 2 * y * y) - 0.6, dim=2),
    "polygon": tools.Polygon(STAR),
    "round polygon": tools.Polygon(STAR).Grown(0.2),
    "cavity": -tools.Sphere((0, 0, 0), 1.5),
    "both": tools.Sphere((0, 0, 0), 0.5) | tools.Plane((0, 0, -1), (0, 0, 1)),
    "turned profile": tools.Revolved(tools.Polygon(SQUARE).Grown(0.1), (0, 0.2, 0), (0, 1, 1)),
}


def evaluate(tool, points):
    values, gradients, hessians = map(np.array, tool._shape.Evaluate(points.ravel()))
    d = tool.dim
    return values, gradients.reshape(-1, d), hessians.reshape(-1, d, d)


def cube(order=TRIANGLES):
    return _Facets(CUBE, order, True)


@pytest.mark.parametrize("tool", [*TOOLS.values(), cube()], ids=[*TOOLS, "cube"])
def test_derivatives(tool):
    eps, points = 1e-6, POINTS[:, : tool.dim].copy()
    _, gradient, hessian = evaluate(tool, points)
    ways = eps * np.eye(tool.dim)
    for k, way in enumerate(ways):
        ahead, behind = (evaluate(tool, points + sign * way) for sign in (1, -1))
        assert gradient[:, k] == pytest.approx((ahead[0] - behind[0]) / (2 * eps), abs=1e-8)
        expected = (ahead[1] - behind[1]) / (2 * eps)
        assert hessian[:, :, k] == pytest.approx(expected, rel=1e-6, abs=1e-6)


@pytest.mark.parametrize("tool", [t for n, t in TOOLS.items() if n != "plane function"])
def test_distances_have_gradients_of_length_one(tool):
    _, gradient, _ = evaluate(tool, POINTS[:, : tool.dim].copy())
    assert np.linalg.norm(gradient, axis=1) == pytest.approx(1, abs=1e-12)


def test_a_cube_of_triangles_is_exact():
    outside = np.abs(POINTS) - 1
    exact = np.linalg.norm(np.maximum(outside, 0), axis=1) + np.minimum(outside.max(axis=1), 0)
    assert cube().Distance(POINTS) == pytest.approx(exact, abs=1e-14)
    box = StructuredBox([-1, 0, 1], [-1, 1], [-1, 1], "hex")
    from bricks import box_mesh

    assert tools.FromMesh(box_mesh(box)).Distance(POINTS) == pytest.approx(exact, abs=1e-14)


def test_the_side_of_a_point_is_right_beyond_edges_and_vertices():
    """A sharp spike: beyond it the normal of one of its facets alone may tell the wrong side."""
    corners = np.array([[0, 0, 0], [1, 0.05, 0], [1, -0.03, 0.02], [1, -0.02, -0.05]])
    spike = _Facets(corners, np.array([(0, 2, 1), (0, 3, 2), (0, 1, 3), (1, 2, 3)]), True)
    angles = np.linspace(0, 2 * np.pi, 40)
    around = np.stack([-0.01 * np.ones(40), 0.1 * np.cos(angles), 0.1 * np.sin(angles)], axis=1)
    assert np.all(spike.Distance(around) > 0)
    assert np.all(spike.Distance(np.array([(t, 0, -0.01 * t) for t in (0.3, 0.9)])) < 0)


def test_the_side_of_a_point_is_right_beyond_a_sharp_edge():
    """Of a wedge: whichever of both facets is found, its normal alone tells one point wrongly."""
    corners = np.array([[a, b, c] for c in (-1, 1) for a, b in ((0, 0), (1, -0.1), (1, 0.1))])
    ends = [(0, 2, 1), (3, 4, 5)]
    sides = [(0, 1, 4, 3), (1, 2, 5, 4), (2, 0, 3, 5)]
    triangles = ends + [t for a, b, c, d in sides for t in ((a, b, c), (a, c, d))]
    wedge = _Facets(corners, np.array(triangles), True)
    points = [(-0.012, side * 0.1, height) for side in (-1, 1) for height in (-0.31, 0.27)]
    assert wedge.Distance(points) == pytest.approx(np.hypot(0.012, 0.1), abs=1e-12)
    inside = wedge.Distance([(0.5, side * 0.049, 0.1) for side in (-1, 1)])
    assert np.all((inside > -1.1e-3) & (inside < -0.9e-3))


def test_finer_facets_come_nearer_to_a_ball():
    exact = np.linalg.norm(POINTS, axis=1) - 1
    mesh = Mesh(OCCGeometry(Sphere((0, 0, 0), 1)).GenerateMesh(maxh=0.5)).Curve(4)
    errors = [
        np.abs(tools.FromMesh(mesh, divisions=n).Distance(POINTS) - exact).max() for n in (2, 4, 8)
    ]
    assert errors[0] < 0.03
    assert errors[1] < 0.3 * errors[0]
    assert errors[2] < 0.3 * errors[1]
    shape = tools.FromShape(Sphere((0, 0, 0), 1), maxh=0.2)
    assert shape.Distance(POINTS) == pytest.approx(exact, abs=0.02)


def test_a_mesh_with_a_hole_in_2d():
    from netgen.occ import Circle, Rectangle

    shape = Rectangle(1, 1).Face() - Circle((0.5, 0.5), 0.2).Face()
    tool = tools.FromMesh(Mesh(OCCGeometry(shape, dim=2).GenerateMesh(maxh=0.3)).Curve(3))
    assert tool.Distance([(0.5, 0.5), (0.1, 0.5), (2, 0.5)]) == pytest.approx(
        [0.2, -0.1, 1], abs=1e-3
    )


@pytest.mark.parametrize("middle", [TOOLS["sphere"], TOOLS["function"], TOOLS["cylinder"]])
def test_the_middle_has_a_distance_and_no_direction(middle):
    at = np.array([[0.1, 0, 0.2]]) if middle is TOOLS["sphere"] else np.zeros((1, 3))
    at = np.array([[0.1, 0, 0]]) if middle is TOOLS["cylinder"] else at
    value, gradient, hessian = evaluate(middle, at)
    assert value[0] < 0
    assert not np.any(gradient)
    assert not np.any(hessian)


def test_motions_follow_each_other():
    """A quarter turn about (1, 0), then a shift; then a turn of all about the origin."""
    angle = Parameter(0)
    tool = tools.Sphere((2, 0), 0.5).Moved(shift=(3, 0), angle=angle, center=(1, 0))
    tool = tool.Moved(angle=angle)
    angle.Set(np.pi / 2)  # (2, 0) -> (1, 1) -> (4, 1) -> (-1, 4)
    assert tool.Distance([(-1, 4), (-1, 5)]) == pytest.approx([-0.5, 0.5])
    turned = tools.Torus((0, 0, 0), (0, 0, 1), 1, 0.2).Moved(angle=np.pi / 2, axis=(2, 0, 0))
    assert turned.Distance([(0, 0, 1), (0, 1, 0)]) == pytest.approx([-0.2, np.sqrt(2) - 0.2])


def write_stl(path, text=False, triangles=TRIANGLES):
    corners = CUBE[triangles]
    if text:
        lines = ["solid cube"]
        for t in corners:
            lines += ["facet normal 0 0 0", "outer loop"]
            lines += ["vertex {:e} {:e} {:e}".format(*p) for p in t] + ["endloop", "endfacet"]
        path.write_text("\n".join([*lines, "endsolid cube", ""]))
    else:
        record = b"".join(struct.pack("<12fH", *3 * (0,), *t.ravel(), 0) for t in corners)
        path.write_bytes(b"solid of 84 bytes".ljust(80) + struct.pack("<I", len(corners)) + record)
    return path


@pytest.mark.parametrize("text", [False, True])
def test_stl(tmp_path, text):
    tool = tools.FromSTL(write_stl(tmp_path / "cube.stl", text))
    assert tool.Distance(POINTS) == pytest.approx(cube().Distance(POINTS), abs=1e-7)


@pytest.mark.parametrize(
    ("triangles", "words"),
    [
        (TRIANGLES[:, ::-1], "turned inside out"),
        (TRIANGLES[1:], "open beside facet"),
        (np.concatenate([TRIANGLES[:1, ::-1], TRIANGLES[1:]]), "turn their normals to different"),
        (np.concatenate([TRIANGLES, TRIANGLES[:1]]), "more than two"),
    ],
)
def test_surfaces_that_are_none(tmp_path, triangles, words):
    with pytest.raises(Exception, match=words):
        tools.FromSTL(write_stl(tmp_path / "cube.stl", triangles=triangles))


def test_an_open_surface_where_that_is_allowed(tmp_path):
    file = write_stl(tmp_path / "cube.stl", triangles=TRIANGLES[2:])
    tool = tools.FromSTL(file, closed=False)
    assert tool.Distance([(1.5, 0, 0), (0.9, 0, 0)]) == pytest.approx([0.5, -0.1])


def test_files_that_are_no_stl(tmp_path):
    for content in (b"", b"solid\nvertex 1 2\n", b"x" * 200):
        (tmp_path / "none.stl").write_bytes(content)
        with pytest.raises(ValueError, match="no STL file"):
            tools.FromSTL(tmp_path / "none.stl")
    with pytest.raises(OSError, match="missing"):
        tools.FromSTL(tmp_path / "missing.stl")


def refused():
    mesh = Mesh(OCCGeometry(Box((0, 0, 0), (1, 1, 1))).GenerateMesh(maxh=1))
    field = GridFunction(H1(mesh, order=1))
    still, t = tools.Sphere((0, 0), 1), Parameter(0)
    number = NumberSpace(mesh).TrialFunction()
    return {
        "no coordinates": (lambda: tools.SignedDistance(t - 1), "does not depend on the coord"),
        "z in 2D": (lambda: tools.SignedDistance(x + z, dim=2), "coordinate z"),
        "a field": (lambda: tools.SignedDistance(x + field), "GridFunction.*away from the mesh"),
        "no derivative": (lambda: tools.SignedDistance(floor(x)), "not differentiable"),
        "no number": (lambda: tools.SignedDistance(Norm(x) + Parameter(np.nan)).Distance(POINTS),
                      "it is nan at"),
        "no function": (lambda: tools.SignedDistance(3), "function of x, y, z"),
        "radius": (lambda: tools.Sphere((0, 0), -1), "radius = -1"),
        "normal": (lambda: tools.Plane((0, 0), (0, 0)), "no vector of zeros"),
        "point": (lambda: tools.Plane((0, 0, 0, 0), (0, 0)), "2 or 3 coordinates"),
        "dimensions": (lambda: still | tools.Sphere((0, 0, 0), 1), "make no tool"),
        "moved before": (lambda: -still.Moved(shift=(1, 0)), "combine tools first"),
        "shift": (lambda: still.Moved(shift=(1, 0, 0)), "has 3 components"),
        "place": (lambda: still.Moved(shift=(x, 0)), "numbers and Parameters only"),
        "no axis": (lambda: tools.Sphere((0, 0, 0), 1).Moved(angle=t), "axis"),
        "clockwise": (lambda: tools.Polygon(SQUARE[::-1]), "inside out"),
        "not driven": (lambda: still.Driven(force=(1, 2)), "give travel="),
        "no sequence": (lambda: still.Moved(shift=5), "shift = 5 must be a list or tuple"),
        "one force": (lambda: still.Driven(turn=t, force=5), "force = 5 must be a list or tuple"),
        "one travel": (lambda: still.Driven(travel=t), "must be a list or tuple of 2"),
        "travel": (lambda: still.Driven(travel=(t, None)), "trial function of a NumberSpace"),
        "no motion": (lambda: still.Moved(), "give shift= or angle="),
        "axis in 2D": (lambda: still.Moved(angle=t, axis=(0, 0, 1)), "axis is for tools in 3D"),
        "a proxy": (lambda: still.Moved(shift=(0, H1(mesh).TrialFunction())), "trial or test"),
        "led, not driven": (lambda: still.Driven(travel=(None, number), force=(5, 1)),
                            r"force = \(5, 1\) acts where"),
        "idle moment": (lambda: still.Driven(travel=(None, number), moment=1), "does not turn"),
        "on a line": (lambda: tools.Polygon([(0, 0), (1, 0), (2, 0)]), "enclose no area"),
        "bow tie": (lambda: tools.Polygon([(0, 0), (1, 1), (1, 0), (0, 1)]), "enclose no area"),
        "by domain": (lambda: tools.SignedDistance(x * mesh.MaterialCF({"default": 1})),
                      "a function of each domain"),
        "profile": (lambda: tools.Revolved(tools.Sphere((0, 0, 0), 1), (0, 0, 0), (0, 0, 1)),
                    "tool in 2D"),
    }  # fmt: skip


REFUSED = refused()


@pytest.mark.parametrize("case", REFUSED)
def test_what_makes_no_tool(case):
    make, words = REFUSED[case]
    with pytest.raises(Exception, match=words):
        make()


def test_functions_by_cases_have_derivatives():
    tool = tools.SignedDistance(IfPos(x, x, 2 * x) + 0 * y, dim=2)
    _, gradient, _ = evaluate(tool, np.array([[1.0, 0], [-1, 0]]))
    assert gradient == pytest.approx(np.array([[1.0, 0], [2, 0]]))


# --- directions of any length --------------------------------------------------------------------

LENGTHS = [1e308, 1e200, 1.0, 1e-170, 1e-300, 1e-310]
ALONG = np.array([1.0, 2.0, -2.0]) / 3
TO = {  # a tool by its direction, and a point
    "plane": lambda n: tools.Plane((0, 1, 0), n),
    "cylinder": lambda n: tools.Cylinder((0, 1, 0), n, 0.5),
    "cone": lambda n: tools.Cone((0, 1, 0), n, 0.4),
    "torus": lambda n: tools.Torus((0, 1, 0), n, 2, 0.5),
    "revolved": lambda n: tools.Revolved(tools.Plane((0, 1), (1, 1)), (0, 1, 0), n),
    "moved": lambda n: tools.Plane((0, 0, 1), (0, 0, 1)).Moved(angle=1, axis=n, center=(0, 1, 0)),
    "line": lambda n: tools.Plane((0, 1), n[:2]),
}


@pytest.mark.parametrize("length", LENGTHS)
@pytest.mark.parametrize("name", TO)
def test_only_the_sense_of_a_direction_counts(name, length):
    expected, found = TO[name](ALONG), TO[name](length * 1.5 * ALONG)
    points = POINTS[:20, : expected.dim]
    np.testing.assert_allclose(found.Distance(points), expected.Distance(points), atol=1e-12)


@pytest.mark.parametrize("wrong", [0.0, np.nan, np.inf])
@pytest.mark.parametrize("name", TO)
def test_what_is_no_direction(name, wrong):
    with pytest.raises(ValueError, match=r"(normal|axis) = .* must be "):
        TO[name](wrong * ALONG)


@pytest.mark.parametrize("dim", [2, 2.0, np.int64(2), np.float32(2)])
def test_the_dimension_of_a_signed_distance(dim):
    tool = tools.SignedDistance(sqrt(x**2 + y**2) - 1, dim=dim)
    assert tool.dim == 2
    assert tool.Distance([(3, 4)]).tolist() == [4.0]


@pytest.mark.parametrize("dim", [2.5, 4, 1, True, "2", None, np.nan, (2,), 10**400])
def test_what_is_no_dimension(dim):
    with pytest.raises((ValueError, TypeError), match=r"dim = .* must be 2 or 3"):
        tools.SignedDistance(sqrt(x**2 + y**2) - 1, dim=dim)


@pytest.mark.parametrize("travel", [None, (None, None), [None, None]])
def test_a_driven_tool_of_which_nothing_is_unknown(travel):
    with pytest.raises(ValueError, match="what of the motion is unknown"):
        tools.Sphere((0, 2), 1).Driven(travel=travel)


@pytest.mark.parametrize("size", [1e-60, 1e60, np.nan, np.inf])
@pytest.mark.parametrize("closed", [True, False])
def test_facets_whose_areas_are_no_numbers(size, closed):
    with pytest.raises(ValueError, match="corners of the tool are"):
        tools.Polygon(size * np.array(SQUARE), closed=closed)


@pytest.mark.parametrize("size", [1e-40, 1e40])
def test_facets_of_odd_units(size):
    square = tools.Polygon(size * np.array(SQUARE))
    assert square.Distance([(0, 3 * size)])[0] == pytest.approx(2 * size)
