"""A quarter of a ring that is pressed into another one; both begin at the same radius."""

import math

from ngsolve import Parameter, VectorH1
from posed import elastic, posed

from ngslac.meshes.geometry import Arc, Body, GenerateMesh, Line

INNER, COMMON, OUTER = 10.0, 20.0, 30.0
YOUNG, NU = 210e3, 0.3


def fit_pressure(interference):
    """In plane strain (Timoshenko and Goodier, Theory of Elasticity, art. 28)."""
    a, b, c = INNER, COMMON, OUTER
    stress = YOUNG * interference * (b**2 - a**2) * (c**2 - b**2) / (2 * b**3 * (c**2 - a**2))
    return stress / (1 - NU**2)


def quarter(inner, outer, names, counts):
    """A quarter of a ring; `names` and `counts` of its inner and outer side."""

    def at(radius):
        return lambda angle: (radius * math.cos(angle), radius * math.sin(angle))

    return [
        Line((inner, 0), (outer, 0), "symy"),
        Arc(at(outer), 0, math.pi / 2, names[1], counts[1]),
        Line((0, outer), (0, inner), "symx"),
        Arc(at(inner), math.pi / 2, 0, names[0], counts[0]),
    ]


def rings_mesh(n, curve):
    """The inner ring has n slave edges, the outer one fewer; curved of an order."""
    inner = quarter(INNER, COMMON, ("bore", "slave"), (None, n))
    outer = quarter(COMMON, OUTER, ("master", "rim"), (round(0.7 * n), None))
    bodies = [Body(inner, "inner"), Body(outer, "outer")]
    return GenerateMesh(bodies, order=curve, maxh=1.2 * math.pi / 2 * COMMON / n, grading=0.3)


def press_fit(n, interference, *, order=2, curve=4, **law):
    """Rings that overlap by an interference, a number or a function of the load."""
    mesh = rings_mesh(n, curve)
    V = VectorH1(mesh, order=order, dirichletx="symx", dirichlety="symy")
    load = Parameter(1.0)
    overlap = interference(load) if callable(interference) else interference
    return posed(V, elastic(YOUNG, NU), load=load, offset=-overlap, **law)
