"""Every public name says what it takes, gives, raises, and where its formulas come from."""

import re

import pytest
from docstrings import RESULTS, CompiledNames, Entries, Name, PublicNames, Sections, StubNames

NAMES = {name.name: name for name in PublicNames()}
MAIN = [
    n.name for n in NAMES.values() if n.kind in ("class", "function") and n.thing not in RESULTS
]
FORMULAS = [
    name
    for name in NAMES.values()
    if name.kind in ("class", "function") and name.thing.__module__.startswith("ngslac.reference")
]


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
def test_every_class_and_function_has_an_example(name):
    assert ">>>" in NAMES[name].sections.get("Examples", "")


@pytest.mark.parametrize("name", [name.name for name in FORMULAS])
def test_formulas_have_a_source(name):
    assert re.search(r"Sources?( of [^.]*)?:\s|Checked by hand:\s", NAMES[name].doc)


def test_stubs_have_all_compiled_names():
    stubs = StubNames()
    for owner, names in CompiledNames().items():
        assert names - stubs[owner] == set(), owner


def test_stubs_have_no_other_names():
    compiled = CompiledNames()
    assert StubNames()[""] == compiled[""]
    for owner, names in StubNames().items():
        public = {name for name in names if not name.startswith("_")}
        assert public - compiled[owner] == set(), owner


# ---------------------------------------------------------------- the check itself


def Described(x, y=1):
    """Take two numbers.

    Parameters
    ----------
    x, z : float
    """
    if x < 0:
        raise ValueError(x)
    return x + y


def test_the_check_sees_what_is_missing():
    found = Missing(Name("Described", Described, "function"))
    assert found == ["parameter y", "no such parameter: z", "Returns", "Raises ValueError"]


def test_sections():
    sections = Sections(
        "One.\n\nParameters\n----------\na, b : int\n    Two.\n*c\n\nRaises\n---\nX"
    )
    assert list(sections) == ["", "Parameters", "Raises"]
    assert Entries(sections["Parameters"]) == {"a", "b", "c"}
