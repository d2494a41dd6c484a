"""A disc in a ring: two concentric circular surfaces, meshed independently."""

import math

from netgen.occ import Circle, Compound, OCCGeometry
from ngsolve import Mesh


def divided(edge, n):
    """Cut an edge into n equal parts."""
    edge.partition = [k / n for k in range(1, n)]
    edge.maxh = 1.01 * edge.mass / n


def disc_in_ring(inner=1.0, outer=1.1, order=1, n_inner=12, n_outer=17, center=(0.0, 0.0)):
    """Mesh of a disc (boundary "disc") in a ring whose inner boundary is "ring"."""
    disc = Circle(center, inner).Face()
    disc.edges.name = "disc"
    divided(disc.edges[0], n_inner)
    hole = Circle(center, outer).Face()
    ring = Circle(center, 2 * outer).Face() - hole
    for edge in ring.edges:
        near = edge.mass < 3 * math.pi * outer
        edge.name = "ring" if near else "far"
        divided(edge, n_outer if near else 12)
    disc.faces.name, ring.faces.name = "disc", "ring"
    geometry = OCCGeometry(Compound([disc, ring]), dim=2)
    mesh = Mesh(geometry.GenerateMesh(maxh=outer, grading=0.9, minedgelen=None))
    mesh.Curve(order)
    return mesh
