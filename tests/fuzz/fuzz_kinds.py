"""Odd values, and which of them are legal for which kind of argument."""

from itertools import count, repeat

import numpy as np
from ngsolve import CF, BitArray, Parameter, sqrt, x

__all__ = ["KINDS", "PLAIN", "VALUES", "IsLegal", "Near"]

# Made from the World when a case runs: some of them are objects of it, or of its second mesh.
VALUES = {
    "None": lambda w: None,
    "nan": lambda w: float("nan"),
    "inf": lambda w: float("inf"),
    "-inf": lambda w: float("-inf"),
    "-1": lambda w: -1,
    "0": lambda w: 0,
    "2.5": lambda w: 2.5,
    "1e300": lambda w: 1e300,
    "1e-300": lambda w: 1e-300,
    "True": lambda w: True,
    "10**400": lambda w: 10**400,
    "2**31": lambda w: 2**31,
    "1j": lambda w: 1j,
    "'nonsense'": lambda w: "nonsense",
    "''": lambda w: "",
    "'['": lambda w: "[",
    "'1'": lambda w: "1",
    "b'slave'": lambda w: b"slave",
    "[]": lambda w: [],
    "[None]": lambda w: [None],
    "{}": lambda w: {},
    "{3: 4}": lambda w: {3: 4},
    "object()": lambda w: object(),
    "a class": lambda w: dict,
    "array(3)": lambda w: np.arange(3.0),
    "array of nan": lambda w: np.full(w.X.ndof, np.nan),
    "array of text": lambda w: np.array(["a", "b"]),
    "function": lambda w: lambda *given: None,
    # Objects of NGSolve and ngslac.
    "mesh": lambda w: w.mesh,
    "another mesh": lambda w: w.other.mesh,
    "region of another mesh": lambda w: w.other.mesh.Boundaries("slave"),
    "region of volume": lambda w: w.mesh.Materials(".*"),
    "empty region": lambda w: w.mesh.Boundaries("nowhere"),
    "space": lambda w: w.V,
    "another product space": lambda w: w.other.X,
    "gf of another mesh": lambda w: w.other.gf,
    "gf of a component": lambda w: w.gf.components[0],
    "gf": lambda w: w.gf,
    "vector": lambda w: w.Vector(),
    "vector of another mesh": lambda w: w.other.gf.vec,
    "form of another mesh": lambda w: w.other.a,
    "linear form": lambda w: w.f,
    "contact": lambda w: w.contact,
    "contact of another mesh": lambda w: w.other.contact,
    "matrix": lambda w: w.a.mat,
    "matrix of another mesh": lambda w: w.form.mat.T,
    "bits(3)": lambda w: BitArray(3),
    "scalar CF": lambda w: 0.1 + 0 * x,
    "vector CF": lambda w: CF((x, 0)),
    "CF of 3": lambda w: CF((x, 0, 1)),
    "nan CF": lambda w: sqrt(-1 - x * x),
    "complex CF": lambda w: CF(1j),
    "Parameter": lambda w: Parameter(0.2),
    "trial function": lambda w: w.u,
    "test function": lambda w: w.v,
    "CF of a trial function": lambda w: 0.1 + w.u[1] * x,
    "vector CF of a trial function": lambda w: 0.1 * w.u,
    "endless": lambda w: count(),
    "endless of one": lambda w: repeat(w.contact),
    "solver": lambda w: w.solver,
    "file in a missing folder": lambda w: w.folder.name + "/missing/file",
    "folder": lambda w: w.folder.name,
    "name with a zero": lambda w: "a\0b",
}

PLAIN = list(VALUES)[: list(VALUES).index("mesh")]
# The words of values that are easily taken for those of a kind.
NEAR = {
    "axes": "function",
    "background": "CF gf mesh",
    "bits": "array bits",
    "bulk": "form matrix",
    "contacts": "contact solver",
    "density": "CF Parameter",
    "displacement": "CF gf",
    "energy": "CF",
    "function": "function form solver",
    "gap": "CF Parameter",
    "load": "form vector gf",
    "matrix": "matrix form",
    "mesh": "mesh",
    "motion": "array vector",
    "parameter": "Parameter CF",
    "path": "file folder name",
    "point": "array CF",
    "prescribed": "CF gf",
    "region": "region mesh",
    "saved-file": "file folder name",
    "scalar": "CF Parameter",
    "solution": "gf vector",
    "space": "space",
    "tensor": "CF gf array",
    "things": "Parameter gf",
    "tool": "solver contact",
    "trial": "function CF gf",
    "vector": "vector gf",
}

SMALL = {"1e-300"}
POSITIVE = {"2.5", "1e300", *SMALL, "2**31"}
NUMBERS = POSITIVE | {"-1", "0"}
SCALARS = {"0", "2.5", "1e300", *SMALL, "2**31", "scalar CF", "Parameter"}
DISPLACEMENTS = {"vector CF", "gf of a component"}
GIVEN_FIELDS = ("gf", "gf of a component")
# Patterns and regions without a boundary.
NOWHERE = {"empty region", "name with a zero", "folder", "file in a missing folder"}
ARRAYS = NUMBERS | {"array(3)", "[]", "vector", "vector of another mesh"}

# What may be given, besides what the targets give themselves; "?" behind a kind adds None.
KINDS = {
    "count": set(),
    "positive": POSITIVE,
    "number": NUMBERS,
    "nonnegative": NUMBERS - {"-1"},
    "ratio": {"0", *SMALL},
    "poisson": {"0", *SMALL, "scalar CF", "Parameter"},
    "tensor": set(),
    "share": {"0", *SMALL},
    "below-one": {*SMALL},
    "flag": {"0", "True"},
    "word": set(),
    "pattern": set(),
    "any-pattern": {"'nonsense'", "''", "'1'", "[]", *NOWHERE},
    "region": set(),
    "function": {"function", "a class"},
    "mesh": {"mesh", "another mesh"},
    "space": {"space"},
    "solution": {"gf"},
    "bulk": set(),
    "contacts": {"contact"},
    "load": {"linear form", "vector", "function"},
    "bits": set(),
    "vector": {"vector"},
    "matrix": {"matrix"},
    "motion": set(),
    "parameter": {"Parameter"},
    "tool": {"solver"},
    "prescribed": {"{}", "function", "a class"},
    "things": {"{}"},
    "scalar": SCALARS,
    "density": {"2.5", "1e300", *SMALL, "2**31", "scalar CF", "Parameter"},
    "gap": SCALARS | {"-1"},
    "energy": SCALARS | {"-1"},
    "displacement": DISPLACEMENTS,
    "background": {label for label in VALUES if "CF" in label and "trial" not in label}
    | {"Parameter", *GIVEN_FIELDS},
    "trial": set(),
    "state": set(),
    "point": set(),
    "arrays": ARRAYS,
    "path": {"'nonsense'", "'['", "'1'"},
    "saved-file": set(),
    "axes": set(),
    "values": set(),
    "body": set(),
}


def IsLegal(kind, label):
    """May an argument of this kind have the value with this label?"""
    return label in KINDS[kind.rstrip("?")] or (kind.endswith("?") and label == "None")


def Near(kind, label):
    """Is the value with this label easily taken for one of this kind?"""
    return any(word in label for word in NEAR.get(kind.rstrip("?"), "").split())
