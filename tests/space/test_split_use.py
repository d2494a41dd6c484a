"""SplitSlaveFaces in use: finite elements on split meshes, macro-elements, wrong arguments."""

import doctest

import numpy as np
import pytest
from netgen.occ import Circle, MoveTo, OCCGeometry
from ngsolve import (
    H1,
    BilinearForm,
    GridFunction,
    IfPos,
    InnerProduct,
    Integrate,
    LinearForm,
    Mesh,
    cos,
    ds,
    dx,
    exp,
    grad,
    sin,
    x,
    y,
)
from ngsolve.meshes import Make1DMesh, MakeStructured2DMesh
from scipy.linalg import eigh
from splitmeshes import elements, occ_disk, square

import ngslac.mesh
from ngslac import SplitSlaveFaces


def poisson_error(mesh, order):
    exact = exp(x) * cos(y) + sin(x * y)
    source = (x * x + y * y) * sin(x * y)
    fes = H1(mesh, order=order, dirichlet=".*")
    u, v = fes.TnT()
    a = BilinearForm(grad(u) * grad(v) * dx).Assemble()
    f = LinearForm(source * v * dx).Assemble()
    gf = GridFunction(fes)
    gf.Set(exact, definedon=mesh.Boundaries(".*"))
    f.vec.data -= a.mat * gf.vec
    gf.vec.data += a.mat.Inverse(fes.FreeDofs(), inverse="sparsecholesky") * f.vec
    return Integrate((gf - exact) ** 2 * dx(bonus_intorder=6), mesh) ** 0.5


@pytest.mark.parametrize("quads", [False, True])
@pytest.mark.parametrize("order", [1, 2])
def test_poisson(order, quads):
    errors = []
    for n in (4, 8, 16):
        mesh = MakeStructured2DMesh(quads=quads, nx=n, ny=n)
        errors.append(poisson_error(SplitSlaveFaces(mesh, "left|top"), order))
        assert errors[-1] < 1.1 * poisson_error(mesh, order)
    rates = np.log2(np.array(errors[:-1]) / errors[1:])
    assert rates.min() > order + 0.8


def test_poisson_on_curved_split():
    for order in (2, 3):
        mesh = occ_disk(0.3).Curve(order)
        assert poisson_error(SplitSlaveFaces(mesh, "rim"), order) < poisson_error(mesh, order)


def contact_operator(fes, macros):
    """S = B A^-1 B^T: B the mean normal trace per macro-element, A the inner product of H1."""
    u, v = fes.TnT()
    a = BilinearForm((grad(u) * grad(v) + u * v) * dx).Assemble()
    inv = a.mat.Inverse(fes.FreeDofs(), inverse="sparsecholesky")
    columns = []
    for lower, upper in macros:
        one = IfPos(x - lower, 1, 0) * IfPos(upper - x, 1, 0)
        columns.append(LinearForm(one * v * ds("top")).Assemble().vec)
    solutions = [(inv * b).Evaluate() for b in columns]
    return np.array([[InnerProduct(b, s) for s in solutions] for b in columns])


@pytest.mark.parametrize("kind", ["trigs", "quads"])
@pytest.mark.parametrize("clamped", ["", "left|right"])
def test_parent_edges_are_stable_macro_elements(kind, clamped):
    """The inf-sup constant of one multiplier per parent edge does not fall with the mesh size."""
    betas = []
    for n in (4, 8, 16):
        mesh = MakeStructured2DMesh(quads=kind == "quads", nx=n, ny=n)
        split = SplitSlaveFaces(mesh, "top")
        macros = [(k / n, (k + 1) / n) for k in range(n)]
        lowest, fine = (
            contact_operator(H1(split, order=p, dirichlet=clamped), macros) for p in (1, 4)
        )
        betas.append(eigh(lowest, fine, eigvals_only=True)[0] ** 0.5)
    assert min(betas) > 0.5
    assert betas[-1] > 0.95 * betas[-2]


def test_example():
    result = doctest.testmod(ngslac.mesh)
    assert result.attempted > 0
    assert result.failed == 0


def test_region_argument():
    mesh = square()
    by_name = SplitSlaveFaces(mesh, "left|top")
    by_region = SplitSlaveFaces(mesh, mesh.Boundaries("left") + mesh.Boundaries("top"))
    assert elements(by_region) == elements(by_name)


def test_wrong_arguments():
    mesh, other = square(), square()
    with pytest.raises(
        ValueError, match=r"slave='rim' matches no boundary face; the boundaries are: bottom"
    ):
        SplitSlaveFaces(mesh, "rim")
    with pytest.raises(ValueError, match="slave=<Region> matches no boundary"):
        SplitSlaveFaces(mesh, mesh.Boundaries("rim"))
    with pytest.raises(Exception, match="slave is a region of another mesh"):
        SplitSlaveFaces(mesh, other.Boundaries("left"))
    for region in (mesh.Materials(".*"), mesh.BBoundaries(".*")):
        with pytest.raises(Exception, match=r"slave = .* must be a pattern of boundary names"):
            SplitSlaveFaces(mesh, region)
    with pytest.raises(TypeError, match="slave = 3 must be a pattern"):
        SplitSlaveFaces(mesh, 3)
    with pytest.raises(TypeError, match=r"mesh = <Mesh> must be an ngsolve\.Mesh"):
        SplitSlaveFaces(mesh.ngmesh, "left")


def test_unsupported_meshes():
    with pytest.raises(Exception, match="must be two- or three-dimensional"):
        SplitSlaveFaces(Make1DMesh(3), "left")
    quadratic = occ_disk().ngmesh
    quadratic.SecondOrder()
    with pytest.raises(Exception, match="second order"):
        SplitSlaveFaces(Mesh(quadratic), "rim")


def test_boundary_too_coarse_to_split():
    """A hole whose circle is met by five edges only: the new vertices would leave the body."""
    body = MoveTo(-1.2, -1.2).Rectangle(2.4, 2.4).Face() - Circle((0, 0), 1).Face()
    body.edges.name = "rim"
    mesh = Mesh(
        OCCGeometry(body, dim=2).GenerateMesh(maxh=10, curvaturesafety=0.5, segmentsperedge=0.5)
    )
    with pytest.raises(Exception, match="fold over"):
        SplitSlaveFaces(mesh, "rim")
