"""What is measured on a mesh in 2D or 3D."""

import numpy as np
from ngsolve import (
    BBND,
    BND,
    CF,
    ET,
    VOL,
    InnerProduct,
    Integrate,
    IntegrationRule,
    specialcf,
    x,
    y,
    z,
)

PLACES = [(0.2, 0.2, 0.2), (0.02, 0.03, 0.04), (0.1, 0.2, 0.3), (0, 0, 0), (0.5, 0.5, 0)]


def area(mesh, name=".*"):
    """Of boundaries; in 2D their length."""
    return Integrate(CF(1), mesh.Boundaries(name))


def volume(mesh, name=".*"):
    return Integrate(CF(1), mesh.Materials(name))


def positions(mesh):
    return CF((x, y, z)[: mesh.dim])


def flux(mesh, name=".*"):
    """Of the position through boundaries; of a closed surface dim times the volume."""
    normal = specialcf.normal(mesh.dim)
    return Integrate(InnerProduct(normal, positions(mesh)), mesh.Boundaries(name))


def in_all_elements(mesh, function, places=PLACES):
    """Values of a function at some places of the reference element, in every element."""
    shapes = (ET.TRIG, ET.QUAD) if mesh.dim == 2 else (ET.TET, ET.PYRAMID, ET.PRISM, ET.HEX)
    rule = IntegrationRule(points=[p[: mesh.dim] for p in places], weights=[0] * len(places))
    return function(mesh.MapToAllElements(dict.fromkeys(shapes, rule), VOL))


def samples(mesh):
    """Points in all elements, seen through the curved geometry."""
    return in_all_elements(mesh, positions(mesh))


def determinants(mesh):
    """Of the Jacobian in all elements, in their middle and near a corner."""
    jacobians = in_all_elements(mesh, specialcf.JacobianMatrix(mesh.dim), PLACES[:2])
    return np.linalg.det(jacobians.reshape(-1, mesh.dim, mesh.dim))


def connectivity(mesh):
    return [
        (vb, el.index, tuple(v.nr for v in el.vertices))
        for vb in (VOL, BND, BBND)
        for el in mesh.Elements(vb)
    ]


def vertices_of(region):
    return {v.nr for el in region.Elements() for v in el.vertices}
