"""What the tests of the meshes in 3D measure."""

import numpy as np
from ngsolve import BND, CF, ET, VOL, InnerProduct, Integrate, IntegrationRule, specialcf, x, y, z

__all__ = ["Area", "Connectivity", "Determinants", "Flux", "Samples", "Volume"]


def Area(mesh, name):
    return Integrate(CF(1), mesh.Boundaries(name))


def Volume(mesh, name=".*"):
    return Integrate(CF(1), mesh.Materials(name))


def Flux(mesh, name=".*"):
    """Of the position through boundaries; three times the volume for a closed surface."""
    return Integrate(InnerProduct(specialcf.normal(3), CF((x, y, z))), mesh.Boundaries(name))


def Determinants(mesh):
    """Of the Jacobian in all elements, in their middle and near a corner."""
    rule = IntegrationRule(points=[(0.2, 0.2, 0.2), (0.02, 0.03, 0.04)], weights=[0, 0])
    kinds = (ET.TET, ET.PYRAMID, ET.PRISM, ET.HEX)
    points = mesh.MapToAllElements(dict.fromkeys(kinds, rule), VOL)
    return np.linalg.det(specialcf.JacobianMatrix(3)(points).reshape(-1, 3, 3))


def Samples(mesh):
    rule = IntegrationRule(points=[(0.1, 0.2, 0.3), (0, 0, 0), (0.5, 0.5, 0)], weights=[0] * 3)
    kinds = (ET.TET, ET.PYRAMID, ET.PRISM, ET.HEX)
    return CF((x, y, z))(mesh.MapToAllElements(dict.fromkeys(kinds, rule), VOL))


def Connectivity(mesh):
    return [
        (vb, el.index, tuple(v.nr for v in el.vertices))
        for vb in (VOL, BND)
        for el in mesh.Elements(vb)
    ]
