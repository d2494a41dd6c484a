"""Odd values, and which of them are legal for which kind of argument."""

import math
from itertools import count, repeat

import numpy as np
from ngsolve import CF, BitArray, Parameter, sqrt, x

__all__ = ["KINDS", "PLAIN", "VALUES", "IsLegal", "Near", "Pairs"]


def Pairs(text):
    """The pairs of a table that is written as words ``name:value``."""
    return dict(word.split(":") for word in text.split())


def Literal(text):
    return lambda w: eval(text, dict(vars(math)))


LITERALS = "None nan inf -inf -1 0 2.5 1e300 1e-300 True 10**400 2**31 1j 'nonsense' '' '[' '1'"
LITERALS = [*LITERALS.split(), "b'slave'", "[]", "[None]", "{}", "{3: 4}", "object()"]

# Made from the World when a case runs: some of them are objects of it, or of its second mesh.
PLAIN = {text: Literal(text) for text in LITERALS} | {
    "a class": lambda w: dict,
    "array(3)": lambda w: np.arange(3.0),
    "array of nan": lambda w: np.full(w.X.ndof, np.nan),
    "array of text": lambda w: np.array(["a", "b"]),
    "function": lambda w: lambda *given: None,
}
VALUES = PLAIN | {
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

# The words of values that are easily taken for those of a kind.
NEAR = Pairs("""
    axes:function background:CF,gf,mesh bits:array,bits bulk:form,matrix contacts:contact,solver
    density:CF,Parameter displacement:CF,gf energy:CF function:function,form,solver gap:CF,Parameter
    load:form,vector,gf matrix:matrix,form mesh:mesh motion:array,vector parameter:Parameter,CF
    path:file,folder,name point:array,CF prescribed:CF,gf region:region,mesh scalar:CF,Parameter
    saved-file:file,folder,name solution:gf,vector space:space tensor:CF,gf,array
    things:Parameter,gf tool:solver,contact trial:function,CF,gf vector:vector,gf
""")

SMALL = {"1e-300"}
POSITIVE = {"2.5", "1e300", *SMALL, "2**31"}
NUMBERS = POSITIVE | {"-1", "0"}
DENSITY = POSITIVE | {"scalar CF", "Parameter"}
CONSTANT = {"0", *SMALL, "scalar CF", "Parameter"}
FIELDS = {label for label in VALUES if "CF" in label and "trial" not in label}
# Patterns and regions without a boundary.
NOWHERE = {"empty region", "name with a zero", "folder", "file in a missing folder"}
NONE = "count tensor word pattern region bulk bits motion trial state point saved-file axes"
NONE += " communicator"

# What may be given, besides what the targets give themselves; "?" behind a kind adds None.
KINDS = dict.fromkeys([*NONE.split(), "values", "body"], frozenset()) | {
    "positive": POSITIVE,
    "number": NUMBERS,
    "nonnegative": NUMBERS - {"-1"},
    "ratio": {"0", *SMALL},
    "poisson": CONSTANT,
    "share": {"0", *SMALL},
    "below-one": SMALL,
    "flag": {"0", "True"},
    "any-pattern": {"'nonsense'", "''", "'1'", "[]", *NOWHERE},
    "function": {"function", "a class"},
    "mesh": {"mesh", "another mesh"},
    "space": {"space"},
    "solution": {"gf"},
    "contacts": {"contact"},
    "load": {"linear form", "vector", "function"},
    "vector": {"vector"},
    "matrix": {"matrix"},
    "parameter": {"Parameter"},
    "tool": {"solver"},
    "prescribed": {"{}", "function", "a class"},
    "things": {"{}"},
    "scalar": CONSTANT | POSITIVE,
    "density": DENSITY,
    "gap": CONSTANT | NUMBERS,
    "energy": CONSTANT | NUMBERS,
    "displacement": {"vector CF", "gf of a component"},
    "background": FIELDS | {"Parameter", "gf", "gf of a component"},
    "arrays": NUMBERS | {"array(3)", "[]", "vector", "vector of another mesh"},
    "path": {"'nonsense'", "'['", "'1'"},
}


def IsLegal(kind, label):
    """May an argument of this kind have the value with this label?"""
    return label in KINDS[kind.rstrip("?")] or (kind.endswith("?") and label == "None")


def Near(kind, label):
    """Is the value with this label easily taken for one of this kind?"""
    words = NEAR.get(kind.rstrip("?"))
    return words is not None and any(word in label for word in words.split(","))
