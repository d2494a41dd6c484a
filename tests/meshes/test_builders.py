"""The mesh builders: names, sizes, normals, meshes that do not match, invariance."""

import math
from functools import cache

import ngsolve as ngs
import numpy as np
import pytest
from builders import CASES, KINDS2D, MeshOf
from measures import area, connectivity, determinants, flux, samples, vertices_of, volume
from ngsolve.meshes import MakeStructured2DMesh

from ngslac import meshes
from ngslac.meshes.boxes import KINDS
from ngslac.meshes.cylinders import _Prisms
from ngslac.meshes.geometry import CheckNonMatching, NonMatchingDivisions, RotationMatrix

TURN = ((1.0, 2.0, -0.5), 67.0)


@pytest.mark.parametrize("name", CASES)
def test_names_sizes_and_orientation(name):
    """Normals point outwards, all elements have the same sense, no vertex is common."""
    mesh, expected = MeshOf(name), CASES[name][2]
    measured = {part: volume(mesh, part) for part in mesh.GetMaterials()}
    measured |= {part: area(mesh, part) for part in mesh.GetBoundaries()}
    assert measured.keys() == expected.keys()
    for part, size in expected.items():
        assert measured[part] == size, part
    outer = "|".join({*mesh.GetBoundaries()} - {"arc" if "curved" in name else ""})
    assert flux(mesh, outer) == pytest.approx(mesh.dim * volume(mesh), rel=1e-6)
    values = determinants(mesh)  # Netgen's hexahedra have a negative one
    assert values.min() * values.max() > 0
    one, other = (vertices_of(mesh.Materials(body)) for body in dict.fromkeys(mesh.GetMaterials()))
    assert not one & other
    assert len(one | other) == mesh.nv
    assert "ring" in name or CheckNonMatching(mesh) > 5e-4


FRAMES = {
    2: [{"scale": 1e-3}, {"angle": 37.0}, {"scale": 1e3, "angle": -120.0}],
    3: [{"scale": 1e-3}, {"rotation": TURN}, {"scale": 1e3, "rotation": ("z", -120.0)}],
}
UNSTRUCTURED = {"unstructured": True, "shape": "oblique"}
MOVED = [
    *((meshes.HertzMesh, {"h": 1.0, "half": half}) for half in (True, False)),
    *((meshes.TwoBlocks, {"shape": "oblique"} | kind) for kind in KINDS2D),
    (meshes.TwoBlocks3D, {"kind_upper": "prism", "kind_lower": "tet", "perturb": 0.2}),
    (meshes.TwoBlocks3D, UNSTRUCTURED),
    (meshes.SphereOnBlock, {"h": 2.0}),
    (meshes.TwoSpheres, {"h": 2.0}),
    (meshes.CylinderOnBlock, {"h": 1.0}),
]


@cache
def unmoved(make, **options):
    return make(**options)


@pytest.mark.pairwise
@pytest.mark.parametrize(("make", "options"), MOVED)
@pytest.mark.parametrize("which", [0, 1, 2])
def test_frame_and_units(make, options, which):
    """Coordinates follow, the topology does not change."""
    mesh = unmoved(make, **options)
    frame = FRAMES[mesh.dim][which if make is not meshes.CylinderOnBlock else 0]
    moved = make(**options, **frame)
    assert connectivity(moved) == connectivity(mesh)
    assert moved.GetBoundaries() == mesh.GetBoundaries()
    assert moved.GetCurveOrder() == mesh.GetCurveOrder()
    matrix = RotationMatrix(frame.get("rotation", ("z", frame.get("angle", 0.0))))
    matrix = frame.get("scale", 1.0) * matrix[: mesh.dim, : mesh.dim]
    size = np.abs(samples(mesh)).max() * frame.get("scale", 1.0)
    # OCC projects points to spheres with a precision of its own.
    tol = 1e-10 if make in (meshes.SphereOnBlock, meshes.TwoSpheres) else 1e-12
    assert np.abs(samples(moved) - samples(mesh) @ matrix.T).max() < tol * size


@pytest.mark.parametrize(
    ("make", "options", "h"),
    [
        (meshes.HertzMesh, {"width": 2.0, "height": 4.0}, 1.0),
        (meshes.SphereOnBlock, {}, 2.0),
        (meshes.TwoSpheres, {}, 2.0),
    ],
)
def test_size_of_the_bodies(make, options, h):
    mesh, small = make(h), make(h / 50, radius=1.0, **options)
    assert connectivity(small) == connectivity(mesh)
    assert np.abs(50 * samples(small) - samples(mesh)).max() < 1e-10 * 100


@pytest.mark.pairwise
@pytest.mark.parametrize("kind", [*KINDS2D, *KINDS])
@pytest.mark.parametrize("overhang", [0.3, -0.3, 0.25])
@pytest.mark.parametrize("aligned", [True, False])
def test_overhang(kind, overhang, aligned):
    """The wider block's faces outside have names of their own, if they are aligned."""
    if kind in KINDS2D:
        mesh = meshes.TwoBlocks(0.2, overhang=overhang, aligned=aligned, **kind)
        least, rims = 5e-4, {"{}_left": abs(overhang), "{}_right": abs(overhang)}
    else:
        mesh = meshes.TwoBlocks3D(kind, overhang=overhang, aligned=aligned, perturb=0.2)
        least, rims = 1e-4, {"{}_rim": (1 + 2 * abs(overhang)) ** 2 - 1}
    wide, narrow = ("master", "slave") if overhang > 0 else ("slave", "master")
    body, outside = ("lower" if overhang > 0 else "upper"), sum(rims.values())
    assert area(mesh, narrow) == pytest.approx(1, rel=1e-12)
    assert area(mesh, wide) == pytest.approx(1 if aligned else 1 + outside, rel=1e-12)
    for name, size in rims.items():
        assert area(mesh, name.format(wide)) == pytest.approx(size if aligned else 0, rel=1e-12)
    assert volume(mesh, body) == pytest.approx(1 + outside, rel=3e-10)
    assert CheckNonMatching(mesh) > least


@pytest.mark.parametrize(
    ("make", "options"),
    [
        *((meshes.TwoBlocks, {"h_slave": 0.25, "h_master": h}) for h in (0.25, 0.125, 0.5)),
        *((meshes.HertzMesh, {"h": 1, "half": h, "ratio": r}) for r in (0.5, 1, 2) for h in (0, 1)),
    ],
)
def test_equal_or_nested_sizes_do_not_match(make, options):
    assert CheckNonMatching(make(**options)) > 5e-4


class TestHertz:
    def test_named_vertices(self):
        mesh = meshes.HertzMesh(1)
        for name, height in (("load", 100), ("foot", 0)):
            (nr,) = vertices_of(mesh.BBoundaries(name))
            assert mesh.vertices[nr].point == pytest.approx((0, height), abs=1e-9)

    @pytest.mark.parametrize("h", [1.0, 0.5, 0.3])
    def test_contact_edges_have_equal_sizes(self, h):
        mesh = meshes.HertzMesh(h)
        slave, master = Sizes(mesh, "slave"), Sizes(mesh, "master")
        assert np.ptp(slave) < 1e-6 * h
        assert np.ptp(master) < 1e-9 * h
        assert slave.mean() == pytest.approx(h, rel=0.01)
        assert master.mean() == pytest.approx(0.73 * h, rel=0.06)

    @pytest.mark.parametrize("order", [1, 2, 3])
    def test_curve_order(self, order):
        mesh = meshes.HertzMesh(1, order=order, scale=1e-3)
        assert mesh.GetCurveOrder() == order
        error = abs(volume(mesh, "cylinder") * 1e6 / (math.pi * 50**2 / 2) - 1)
        assert error < {1: 7e-3, 2: 2e-5, 3: 5e-6}[order]


def Sizes(mesh, name):
    """Lengths or areas of the faces of a boundary."""
    return np.array([a for a in ngs.Integrate(1, mesh.Boundaries(name), element_wise=True) if a])


class TestBlocks:
    def test_structured_elements(self):
        quads = meshes.TwoBlocks(0.25, 0.2, structured=True, quads=True)
        trigs = meshes.TwoBlocks(0.25, 0.2, structured=True)
        assert (quads.ne, trigs.ne) == (4 * 4 + 5 * 5, 2 * (4 * 4 + 5 * 5))
        assert quads.nv == trigs.nv == 5 * 5 + 6 * 6

    def test_curved_edges_lie_inside(self):
        mesh = meshes.TwoBlocks(curved=True)
        arc = area(mesh, "arc")
        assert arc > 2.02  # two arcs over a height of 1 each
        assert area(meshes.TwoBlocks(curved=True, order=1), "arc") < arc - 1e-4
        assert ngs.Integrate(ngs.y * ngs.y, mesh.Boundaries("slave|master")) == pytest.approx(
            0, abs=1e-25
        )

    def test_unstructured(self):
        sizes = {"n_slave": (4, 3), "n_master": 2, "overhang": -0.2}
        mesh = meshes.TwoBlocks3D(aligned=False, **sizes, **UNSTRUCTURED)
        assert {el.type for el in mesh.Elements(ngs.VOL)} == {ngs.ET.TET}
        assert determinants(mesh).min() > 0
        assert flux(mesh) == pytest.approx(3 * volume(mesh), rel=1e-12)
        assert area(mesh, "slave") == pytest.approx(1.96 / math.cos(math.radians(20)), rel=1e-12)
        ends = (vertices_of(mesh.Boundaries(name)) for name in ("slave", "front_upper"))
        assert len(set.intersection(*ends)) == 5


@pytest.mark.parametrize("model", ["quarter", "half", "full"])
def test_spheres_are_round(model):
    """They go through the origin, are round between their vertices, and end at planes."""
    mesh = MeshOf(f"balls {model}")
    for name, centre in (("slave", 50), ("master", -80)):
        distance = ngs.CF((ngs.x, ngs.y, ngs.z - centre))
        error = (ngs.InnerProduct(distance, distance) / centre**2 - 1) ** 2
        rms = math.sqrt(ngs.Integrate(error, mesh.Boundaries(name)) / area(mesh, name))
        assert rms < 1e-5  # the gap at the end of the zone is 0.068 of the radius
        points = [mesh.vertices[nr].point for nr in vertices_of(mesh.Boundaries(name))]
        least = np.linalg.norm(points, axis=1).min() / np.sqrt(Sizes(mesh, name).mean())
        assert model != "quarter" or least < 1e-12
    planes = {"top": ngs.z - 50, "bottom": ngs.z + 80, "sym_x": ngs.x, "sym_y": ngs.y}
    for name in planes.keys() & set(mesh.GetBoundaries()):
        assert ngs.Integrate(planes[name] ** 2, mesh.Boundaries(name)) < 1e-15


def test_sizes_in_the_contact_zone():
    """Twelve elements along a contact radius of a tenth: few displacements, equal sizes."""
    mesh = meshes.SphereOnBlock(5 / 12, zone=6.5)
    assert 20000 < ngs.VectorH1(mesh, order=2).ndof < 30000
    for name, h in (("slave", 5 / 12), ("master", 0.5)):
        edges = np.sqrt(4 / math.sqrt(3) * Sizes(mesh, name))  # of equilateral triangles
        assert edges.mean() == pytest.approx(h, rel=0.1)
        assert edges.max() < 1.7 * h


def test_slices_are_prisms():
    mesh = MeshOf("slice quarter")
    assert {el.type for el in mesh.Elements(ngs.VOL)} == {ngs.ET.PRISM}
    assert {el.type for el in mesh.Boundaries("slave|master").Elements()} == {ngs.ET.QUAD}


@pytest.mark.parametrize("side", [1, -1])
def test_prisms_have_one_orientation_whatever_that_of_the_triangles(side):
    plane = MakeStructured2DMesh(quads=False, nx=2, ny=2, mapping=lambda s, t: (side * s, t))
    prisms = _Prisms(plane, np.linspace(0, 1, 4), 1.0)
    corners = prisms.points[np.array(prisms.cells)]
    volumes = np.linalg.det(corners[:, [1, 2, 3]] - corners[:, :1])
    assert volumes.min() > 0
    assert volumes.sum() / 2 == pytest.approx(1)


@pytest.mark.parametrize(
    ("make", "kind"), {"HertzMesh": "an area", "SphereOnBlock": "a volume"}.items()
)
def test_a_face_that_netgen_left_out(make, kind, monkeypatch):
    monkeypatch.setattr("ngslac.meshes.geometry.Integrate", lambda *_: 0.5)
    with pytest.raises(RuntimeError, match=rf"netgen meshed {kind} of 0.5 of .*change"):
        getattr(meshes, make)(2)


def test_no_division_avoids_what_is_everywhere():
    with pytest.raises(ValueError, match=r"no division of the master edge near h = 0.1"):
        NonMatchingDivisions(np.linspace(0, 1, 10**5), 0, 1, 0.1)
