"""Every public name says what it takes, gives, raises, and where its formulas come from."""

import ast
import re

import pytest
from docstrings import COMPILED, RESULTS, STUB_CLASSES, Entries, Name, PublicNames

NAMES = {name.name: name for name in PublicNames()}
MAIN = {n: name for n, name in NAMES.items() if name.kind in ("class", "function")}


def Documented(name):
    """The sections of a name, or those of the other one to which it refers by "see `...`"."""
    sections = dict(name.sections)
    for other in re.findall(r"(?:see|As|as in) `([\w.]+)`", name.sections[""], re.IGNORECASE):
        if other in NAMES and other != name.name:
            there = Documented(NAMES[other])
            parts = [part.get("Parameters", "") for part in (there, sections)]
            sections = there | sections | {"Parameters": "\n".join(filter(None, parts))}
    return sections


def Missing(name):
    """What the docstring lacks."""
    if not name.doc:
        return ["docstring"]
    sections, missing = Documented(name), []
    if not re.match(r"[^\n]+[.?]( |\n|$)|[^\n]+\n[^\n]+[.?:]", name.doc):
        missing.append("a sentence at the start")
    if name.kind == "property":
        return missing
    described = Entries(sections.get("Parameters", ""))
    if name.thing in RESULTS:  # nobody makes these: their attributes matter
        described = set(name.parameters) if "Attributes" in sections else set()
    missing += [f"parameter {p}" for p in name.parameters if p not in described]
    unknown = Entries(name.sections.get("Parameters", "")) - set(name.parameters)
    missing += [f"no such parameter: {p}" for p in sorted(unknown)]
    if name.kind != "class" and name.parameters and name.returns and "Returns" not in sections:
        missing.append("Returns")
    raised = sections.get("Raises", "")
    missing += [f"Raises {error}" for error in sorted(name.raises) if error not in raised]
    return missing


@pytest.mark.parametrize("name", NAMES)
def test_nothing_is_missing(name):
    assert not Missing(NAMES[name])


@pytest.mark.parametrize("name", MAIN)
def test_classes_and_functions_have_examples_and_formulas_a_source(name):
    name = MAIN[name]
    assert name.thing in RESULTS or ">>>" in name.sections.get("Examples", "")
    if name.thing.__module__.startswith("ngslac.reference"):
        assert re.search(r"Sources?( of [^.]*)?:\s|Checked by hand:\s", name.doc)


def test_stubs_have_the_public_compiled_classes():
    """With their public members, and no others."""
    assert STUB_CLASSES.keys() == {cls.__name__ for cls in COMPILED}
    for cls in COMPILED:
        body = STUB_CLASSES[cls.__name__].body
        inside = {n.name for n in body if isinstance(n, ast.FunctionDef)} - {"__init__"}
        assert inside == {n for n in vars(cls) if n[0] != "_"}, cls


def test_the_check_sees_what_is_missing():
    def Described(x, y=1):
        """Take two numbers.

        Parameters
        ----------
        x, z : float
        """
        if x < 0:
            raise ValueError(x)
        return x + y

    found = Missing(Name("Described", Described, "function"))
    assert found == ["parameter y", "no such parameter: z", "Returns", "Raises ValueError"]
    assert Entries("a, b : int\n    Two.\n*c\n") == {"a", "b", "c"}
