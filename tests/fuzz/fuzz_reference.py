"""The closed-form solutions: constructors and methods, found by their signatures."""

import inspect

from fuzz_kinds import Pairs
from fuzz_targets import Target

import ngslac.reference as reference

__all__ = ["REFERENCE_TARGETS"]

ELASTIC = {"young1": 1.0, "nu1": 0.3, "young2": 1.0, "nu2": 0.3}
PAIR = {"force": 1.0, "radius1": 10.0} | ELASTIC
LINE, POINT = reference.HertzLine(**PAIR), reference.HertzPoint(**PAIR)
PARTIAL = {"shear": 0.1, "friction": 0.3}

MADE = {
    "ContactModulus": ELASTIC,
    "DundursBeta": ELASTIC,
    "HertzLine": PAIR,
    "HertzPoint": PAIR,
    "CattaneoMindlin": {"hertz": LINE, **PARTIAL},
    "CattaneoMindlinPoint": {"hertz": POINT, **PARTIAL},
    "MindlinReversal": {
        "start": reference.CattaneoMindlin(hertz=LINE, **PARTIAL),
        "shear": 0.05,
    },
    "MindlinPointReversal": {
        "start": reference.CattaneoMindlinPoint(hertz=POINT, **PARTIAL),
        "shear": 0.05,
    },
}
# Valid arguments of methods, and the kind of each by its name.
VALID = {"angle": 0.001, "approach": 0.1, "body": 1, "depth": 0.1, "friction": 0.3, "hertz": POINT}
VALID |= {"moment": 0.005, "shear": 0.05, "shift": 0.001, "x0": 0.0}
VALID |= {"vertices": [[0.0, 0.0], [0.1, 0.0], [0.0, 0.1]]}
VALID |= dict.fromkeys(["x1", *"rtxyz"], 0.1)
KIND = Pairs("""
    beta:number body:body friction:nonnegative hertz:state nu:ratio nu1:ratio nu2:ratio start:state
    vertices:values angle:number moment:number shear:number shift:number x:arrays y:arrays
    r:arrays t:arrays x0:arrays x1:arrays depth:arrays
""")
ALSO = {name: {"inf"} for name in ("radius1", "radius2", "young1", "young2")}
ALSO |= {"body": {"True"}, "end": {"0"}}


def OfCallable(name, call, valid):
    """The target of one function, class or bound method."""
    names = list(inspect.signature(call).parameters)
    given = {p: v for p, v in valid.items() if p in names}
    words = " ".join(f"{p}:{KIND.get(p, 'positive')}" for p in names)
    run = lambda w, **k: call(**k)  # noqa: E731
    return Target(f"reference.{name}", run, words, lambda w: given, ALSO, plain=True)


def OfClass(name, cls, made):
    yield OfCallable(name, cls, made)
    thing = cls(**made)
    if inspect.isclass(cls):
        for method in sorted(m for m in dir(cls) if m[0].isupper() and callable(getattr(thing, m))):
            valid = VALID | made if method.startswith("From") else VALID
            yield OfCallable(f"{name}.{method}", getattr(thing, method), valid)


REFERENCE_TARGETS = [
    target
    for name, made in MADE.items()
    for target in OfClass(name, getattr(reference, name), made)
]
