"""The closed-form solutions: constructors and methods, found by their signatures."""

import inspect

from fuzz_kinds import PLAIN
from fuzz_targets import Target

import ngslac.reference as reference

__all__ = ["REFERENCE_TARGETS"]

ELASTIC = {"young1": 1.0, "nu1": 0.3, "young2": 1.0, "nu2": 0.3}
PAIR = {"force": 1.0, "radius1": 10.0} | ELASTIC
LINE, POINT = reference.HertzLine(**PAIR), reference.HertzPoint(**PAIR)
PARTIAL = {"shear": 0.1, "friction": 0.3}
SLIDING = {
    "line": reference.CattaneoMindlin(hertz=LINE, **PARTIAL),
    "point": reference.CattaneoMindlinPoint(hertz=POINT, **PARTIAL),
    "twist": reference.TwistPoint(hertz=POINT, moment=0.01, friction=0.3),
}
SLAB = {name: getattr(reference.GRECO_SLAB, name) for name in vars(reference.GRECO_SLAB)}

MADE = {
    "ContactModulus": ELASTIC,
    "DundursBeta": ELASTIC,
    "HertzLine": PAIR,
    "HertzPoint": PAIR,
    "CattaneoMindlin": {"hertz": LINE, **PARTIAL},
    "CattaneoMindlinPoint": {"hertz": POINT, **PARTIAL},
    "MindlinReversal": {"start": SLIDING["line"], "shear": 0.05},
    "MindlinPointReversal": {"start": SLIDING["point"], "shear": 0.05},
    "TwistPoint": {"hertz": POINT, "moment": 0.01, "friction": 0.3},
    "TwistReversal": {"start": SLIDING["twist"], "moment": 0.005},
    "SpenceLine": {"hertz": LINE, "friction": 0.2},
    "StickZone": {"beta": 0.1, "friction": 0.2},
    "ScalarSignorini": {"tip": 0.3},
    "ElasticSignorini": ELASTIC,
    "ElasticSignoriniDisc": ELASTIC,
    "FrictionSlab": SLAB,
}
# Valid arguments of methods, and the kind of each by its name.
TRIANGLE = [[0.0, 0.0], [0.1, 0.0], [0.0, 0.1]]
VALID = {
    "angle": 0.001,
    "approach": 0.1,
    "body": 1,
    "depth": 0.1,
    "displacement": SLAB["converged"],
    "friction": 0.3,
    "hertz": POINT,
    "moment": 0.005,
    "reference": "converged",
    "shear": 0.05,
    "shift": 0.001,
    "vertices": TRIANGLE,
    "x0": 0.0,
    "x1": 0.1,
} | dict.fromkeys("rtxyz", 0.1)
UNBOUNDED = ("radius1", "radius2", "young1", "young2")
SIGNED = ("angle", "moment", "shear", "shift", "side_pressure", "tip")
KIND = {
    "abscissae": "values",
    "beta": "number",
    "body": "body",
    "converged": "values",
    "displacement": "values",
    "friction": "nonnegative",
    "functions": "functions",
    "hertz": "state",
    "nu": "ratio",
    "nu1": "ratio",
    "nu2": "ratio",
    "published": "values",
    "reference": "word",
    "sqrt": "functions",
    "start": "state",
    "vertices": "values",
} | dict.fromkeys((*SIGNED, "open_end", "slip_end", "top_pressure"), "number")
ALSO = {name: {"inf"} for name in UNBOUNDED} | {
    "body": {"True"},
    "end": {"0"},
    "functions": {"function", "a class"},
    "sqrt": {"function", "a class"},
}
POINTS = ("x", "y", "z", "r", "t", "x0", "x1", "depth")


def Kind(name):
    return "arrays" if name in POINTS else KIND.get(name, "positive")


def Names(parameters):
    return " ".join(f"{p}:{Kind(p)}" for p in parameters if p not in ("sqrt", "functions"))


class Numbers(Target):
    """A target whose arguments are plain Python objects."""

    def Cases(self, every=False):
        for name, label, legal in super().Cases(every):
            if every or label in PLAIN:
                yield name, label, legal


def OfCallable(name, call, valid):
    """The target of one function, class or bound method."""
    parameters = list(inspect.signature(call).parameters)
    given = {p: v for p, v in valid.items() if p in parameters}
    return Numbers(
        f"reference.{name}",
        lambda w, **k: call(**k),
        lambda w: dict(given),
        Names(parameters),
        {p: ALSO[p] for p in parameters if p in ALSO},
    )


def OfClass(name, cls, made):
    yield OfCallable(name, cls, made)
    if not inspect.isclass(cls):
        return
    thing = cls(**made)
    for method in sorted(m for m in dir(cls) if m[0].isupper() and callable(getattr(thing, m))):
        valid = VALID | made if method.startswith("From") else VALID
        yield OfCallable(f"{name}.{method}", getattr(thing, method), valid)


REFERENCE_TARGETS = [
    target
    for name, made in MADE.items()
    for target in OfClass(name, getattr(reference, name), made)
]
