"""Stress set: bodies that are free to move, and that nothing moves.

Frictionless blocks at rest, things that lie in grooves and may spin, shrink fits that nothing
holds, and bodies that come loose: they stay where they were.
"""

import numpy as np
from netgen.occ import Box, Circle, Compound, OCCGeometry, Pnt, Sphere, Z
from ngsolve import Grad, Integrate, Mesh
from stress_meshes import Grids, Outline, Part, Plate, Rotated, Sketch
from stress_problem import MeanOf, MeanPressure, Problem, problem

PAIR = [("brick", "base")]
# What meshes of curved surfaces of these orders resist to a motion along them, relative to forces.
ROUGH = {1: 5e-2, 2: 1e-2, 3: 1e-2}


# --- at rest on a flat base ----------------------------------------------------------------------


def Brick2D(gap):
    base = ((-0.85, -0.9, 0.85, 0), (7, 4))
    return Grids(brick=((-0.6, gap, 0.6, gap + 0.8), (5, 3), "quad"), base=base)


def Brick3D(gap):
    return Grids(
        brick=((-0.6, -0.55, gap, 0.6, 0.65, gap + 0.7), (3, 3, 2)),
        base=((-1, -1, -0.8, 1, 1, 0), (4, 4, 2)),
    )


@problem(*((dim, gap, load) for dim in (2, 3) for gap in (0.0, 1e-9, 1e-3)
           for load in ("weight", "traction")))  # fmt: skip
def AtRest(dim, gap, load):
    """A block without friction on a flat base under a load along the normal."""
    down = (0,) * (dim - 1) + (-1.0,)
    p = Problem((Brick2D if dim == 2 else Brick3D)(gap), pairs=PAIR)
    extents = (1.2, 0.8) if dim == 2 else (1.2, 1.2, 0.7)
    force = np.prod(extents if load == "weight" else extents[:-1])
    p.Weight("brick", down) if load == "weight" else p.Traction("brick_top", down)
    return p.StaysAside("brick", *range(dim - 1)).Carries(tuple(-force * np.array(down)))


@problem((30.0, "brick"), (-77.0, "brick"), (30.0, "base"))
def AtRestTurned(degrees, slave):
    """The same in a turned frame; either side is the slave."""
    mesh = Grids(
        brick=(Rotated(lambda s, t: (1.2 * s, 0.001 + 0.8 * t), degrees), (5, 3)),
        base=(Rotated(lambda s, t: (-0.4 + 2 * s, -0.9 + 0.9 * t), degrees), (7, 4), "quad"),
    )
    other = ("base_top", "brick_bottom")
    p = Problem(mesh, pairs=PAIR if slave == "brick" else [other])
    angle = np.radians(degrees)
    down = np.array((np.sin(angle), -np.cos(angle)))
    sign = -1 if slave == "brick" else 1
    p.Weight("brick", tuple(down)).Carries(tuple(sign * 0.96 * down))
    along = np.array((np.cos(angle), np.sin(angle)))
    return p.Expect("drift of brick", MeanAlong("brick", along), 0.0, 1e-6)


def MeanAlong(body, along):
    return lambda p: sum(a * MeanOf(body, k)(p) for k, a in enumerate(along))


@problem((2, 0.0), (2, 1e-3), (3, 1e-3))
def StackAtRest(dim, gap):
    """Two blocks without friction above each other."""
    if dim == 2:
        mesh = Grids(
            top=((-0.4, 2 * gap + 0.5, 0.4, 2 * gap + 0.9), (4, 2)),
            brick=((-0.6, gap, 0.6, gap + 0.5), (5, 3), "quad"),
            base=((-0.85, -0.9, 0.85, 0), (7, 4)),
        )
    else:
        mesh = Grids(
            top=((-0.4, -0.4, 2 * gap + 0.5, 0.4, 0.4, 2 * gap + 0.9), (2, 2, 1)),
            brick=((-0.6, -0.6, gap, 0.6, 0.6, gap + 0.5), (3, 3, 1)),
            base=((-1, -1, -0.8, 1, 1, 0), (4, 4, 2)),
        )
    down = (0,) * (dim - 1) + (-1.0,)
    volumes = (0.6, 0.32) if dim == 2 else (0.72, 0.256)
    p = Problem(mesh, pairs=[("brick", "base"), ("top", "brick")])
    for body in ("brick", "top"):
        p.Weight(body, down).StaysAside(body, *range(dim - 1))
    return p.Carries(-sum(volumes) * np.array(down), 0).Carries(-volumes[1] * np.array(down), 1)


# --- in a groove or a hole -----------------------------------------------------------------------


def DiscInHole(radius, low, curve, hole=1.0, h=0.25):
    """A disc in the hole of a plate."""
    disc = Circle((0, low), radius).Face()
    plate = Plate(-2, -2, 2, 2) - Circle((0, 0), hole).Face()
    far = [(0, -2), (0, 2), (2, 0), (-2, 0)]
    return Sketch(
        Part("disc", disc, h, {"round": [(radius, low)]}),
        Part("plate", plate, 0.8, {"round": [(hole, 0)], "far": far}, {"round": 1.3 * h}),
        curve=curve,
    )


def Either(first, second, exchanged):
    return [(second, first) if exchanged else (first, second)]


@problem(*((curve, exchanged) for curve in (1, 2, 3) for exchanged in (0, 1)))
def SpinInHole(curve, exchanged):
    """A heavy disc without friction at the bottom of a hole with play may spin, and does not."""
    mesh = DiscInHole(0.96, -0.04, curve)
    pairs = Either("disc_round", "plate_round", exchanged)
    p = Problem(mesh, pairs=pairs, held="plate_far", rough=ROUGH[curve])
    p.Weight("disc", (0, -1.0))
    area = np.pi * 0.96**2
    # Facets have a slope; what is curved has none.
    sign = -1 if exchanged else 1
    return p.Carries((0, sign * area), error=0.03).Expect("spin", Spin("disc"), 0.0, 1e-4)


def Spin(body):
    """The mean rotation of a body in the plane."""

    def Measured(problem):
        G, region = Grad(problem.gf.components[0]), problem.mesh.Materials(body)
        return Integrate(G[1, 0] - G[0, 1], region) / 2 / Integrate(1.0, region)

    return Measured


@problem((1, 0.0), (2, 0.0), (2, 1e-3), (3, 0.0))
def SpinInGroove(curve, gap):
    """A heavy disc without friction in a groove of two walls may spin.

    Means of both sides' normals are none of the disc: it spins until further faces touch.
    """
    disc = Circle((0, np.sqrt(2) + gap), 1).Face()
    groove = Outline((-2, 2), (0, 0), (2, 2), (2, -1), (-2, -1))
    mesh = Sketch(
        Part("disc", disc, 0.3, {"round": [(0, np.sqrt(2) + 1 + gap)]}),
        Part(
            "groove", groove, 0.8, {"walls": [(-1, 1), (1, 1)], "far": [(0, -1)]}, {"walls": 0.35}
        ),
        curve=curve,
    )
    p = Problem(mesh, pairs=[("disc_round", "groove_walls")], held="groove_far", rough=ROUGH[curve])
    p.Weight("disc", (0, -1.0)).Expect("spin", Spin("disc"), 0.0, 0.1)
    return p.Carries((0, np.pi), error=0.03)


@problem((2, 0), (1, 0))
def BallInSocket(curve, exchanged):
    """A heavy ball without friction in the hollow of a block may spin about three axes."""
    pairs = Either("ball_round", "block_hollow", exchanged)
    p = Problem(Socket(curve), pairs=pairs, held="block_far", rough=ROUGH[curve])
    sign = -1 if exchanged else 1
    p.Weight("ball", (0, 0, -1.0))
    return p.Carries((0, 0, sign * 4 / 3 * np.pi * 0.95**3), error=0.1)


def Socket(curve, radius=0.95, h=0.7):
    """A ball that touches the bottom of a half-round hollow."""
    ball = Sphere(Pnt(0, 0, radius - 1), radius)
    block = Box(Pnt(-1.6, -1.6, -1.6), Pnt(1.6, 1.6, 0)) - Sphere(Pnt(0, 0, 0), 1)
    for body, name in (ball, "ball"), (block, "block"):
        body.mat(name)
        body.faces.name = f"{name}_free"
    ball.faces.name = "ball_round"
    block.faces.Nearest(Pnt(0, 0, -1)).name = "block_hollow"
    block.faces.Min(Z).name = "block_far"
    ball.maxh, block.maxh = h, 1.6
    block.faces["block_hollow"].maxh = 1.2 * h
    geometry = OCCGeometry(Compound([ball, block]))
    return Mesh(geometry.GenerateMesh(grading=0.8)).Curve(curve)


# --- free shrink fits ----------------------------------------------------------------------------


def Rings(inner, outer, h=0.3):
    """A disc, or a ring with a hole, in a ring; coincident circles of radius 1."""
    hole = [Circle((0, 0), inner).Face()] if inner else []
    disc = Circle((0, 0), 1).Face()
    for cut in hole:
        disc = disc - cut
    ring = Circle((0, 0), outer).Face() - Circle((0, 0), 1).Face()
    return Sketch(
        Part("disc", disc, h, {"round": [(1, 0)]}),
        Part("ring", ring, h, {"round": [(1, 0)], "far": [(outer, 0)]}, {"round": 1.3 * h}),
        curve=3,
    )


def Lame2D(excess, inner, outer, young=100.0, nu=0.3):
    """Pressure of a shrink fit at radius 1 in plane strain."""
    E, nu = young / (1 - nu**2), nu / (1 - nu)
    ring = (outer**2 + 1) / (outer**2 - 1) + nu
    return excess * E / (ring + (1 + inner**2) / (1 - inner**2) - nu)


@problem((0.0, 2.0, 0.0, 0), (0.0, 2.0, 0.3, 0), (0.0, 2.0, 0.0, 1), (0.4, 1.6, 0.0, 0),
         (0.4, 1.6, 0.5, 1), (0.7, 1.3, 0.0, 0))  # fmt: skip
def FreeFit(inner, outer, friction, exchanged):
    """A disc or a ring is shrunk into a ring; nothing holds either of them."""
    pairs = Either("disc_round", "ring_round", exchanged)
    options = {"held": "", "law": {"offset": -0.01}, "rough": ROUGH[3]}
    p = Problem(Rings(inner, outer), 100.0, pairs, friction or None, **options)
    exact = Lame2D(0.01, inner, outer)
    p.Expect("pressure", MeanPressure(), exact, 0.02 * exact)
    return p.StaysAside("disc", 0, 1, error=1e-5).StaysAside("ring", 0, 1, error=1e-5)


@problem(0.0, 0.3)
def FreeFit3D(friction):
    """A ball is shrunk into a shell; nothing holds either of them."""
    shell = Sphere(Pnt(0, 0, 0), 1.6) - Sphere(Pnt(0, 0, 0), 1)
    ball = Sphere(Pnt(0, 0, 0), 1)
    ball.mat("ball")
    shell.mat("shell")
    ball.faces.name, shell.faces.name = "ball_round", "shell_far"
    shell.faces.Nearest(Pnt(1, 0, 0)).name = "shell_hollow"
    ball.maxh, shell.maxh = 0.7, 0.8
    mesh = Mesh(OCCGeometry(Compound([ball, shell])).GenerateMesh(grading=0.8)).Curve(2)
    pairs, law = [("ball_round", "shell_hollow")], {"offset": -0.01}
    p = Problem(mesh, 100.0, pairs, friction or None, held="", law=law, rough=ROUGH[2])
    E, nu, b3 = 100.0, 0.3, 1.6**3
    shell = ((1 - 2 * nu) + (1 + nu) * b3 / 2) / (b3 - 1)
    exact = 0.01 * E / (shell + 1 - 2 * nu)
    return p.Expect("pressure", MeanPressure(), exact, 0.08 * exact)


@problem((0.3, 0.25), (0.0, 0.15), (0.3, 0.15))
def CoolsLoose(friction, h):
    """A disc that fits its hole is cooled and comes off all around."""
    p = Problem(DiscInHole(1.0, 0.0, 3, h=h), 100.0, [("disc_round", "plate_round")],
                friction or None, held="plate_far", rough=1e-2)  # fmt: skip
    p.Growth("disc", -1e-3)
    return p.StaysAside("disc", 0, 1, error=1e-5).Expect("pressure", MeanPressure(), 0.0, 1e-8)


@problem(0.0, 0.3)
def CoolsLoose3D(friction):
    """A block between two walls is cooled and comes off both."""
    mesh = Grids(
        brick=((0, 0, 0, 1, 1, 1), (2, 2, 2)),
        base=((-0.3, -0.3, -0.5, 1.3, 1.3, 0), (3, 3, 1)),
        lid=((-0.3, -0.3, 1, 1.3, 1.3, 1.5), (3, 3, 1)),
    )
    pairs = [("brick", "base"), ("brick_top", "lid_bottom")]
    p = Problem(mesh, 100.0, pairs, friction or None, held="base_bottom|lid_top")
    return p.Growth("brick", -1e-3).StaysAside("brick", 0, 1, 2, error=1e-5)
