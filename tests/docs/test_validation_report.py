"""The validation report: its page, its tables, its cases, its bounds."""

import inspect
import math
import re
from pathlib import Path

import numpy as np
import pytest
import report
from cases import MODULES
from report_bounds import (
    ORIGINS,
    Bound,
    Exact,
    Extrapolated,
    HalfDigit,
    Meshes,
    MeshSpread,
    Rate,
    Spread,
    Stated,
)
from report_case import Case, Outcome, Row, Worst
from report_page import CasePage, Compute, Page

ROOT = Path(__file__).parents[2]
VALIDATION = ROOT / "tests" / "validation"
CHEAP = ["directions", "series", "sliding-block"]


@pytest.fixture(scope="module")
def page(tmp_path_factory):
    folder = tmp_path_factory.mktemp("report")
    results = report.Report(folder, names=CHEAP, quick=True)
    pages = ("index", *CHEAP)
    return folder, results, "\n".join((folder / f"{page}.md").read_text() for page in pages)


def Tables(text):
    """Rows of cells of each table of a markdown text."""
    blocks = re.findall(r"(?:^\|.*\|\n?)+", text, re.MULTILINE)
    return [[line.strip("| ").split(" | ") for line in block.splitlines()] for block in blocks]


def test_summary_and_one_table_for_each_case(page):
    _, results, text = page
    assert [result.case.name for result in results] == CHEAP
    assert all(result.holds for result in results)
    assert "**" not in text
    summary, *tables = Tables(text)
    for result, table, line in zip(results, tables, summary[2:], strict=True):
        rows = result.outcome.rows
        assert [row[0] for row in table[2:]] == [row.Cells()[0] for row in rows]
        assert all(len(row) == 6 for row in table)
        assert line[1] == Worst(rows).Cells()[0]
        assert line[4] == "holds"
    assert f"{len(CHEAP)} of {len(CHEAP)} cases hold" in text


def test_head_pictures_and_links(page):
    folder, _, text = page
    pictures = re.findall(r"!\[.*?\]\((pictures/.*?)\)", text)
    assert pictures == [f"pictures/{name}.png" for name in CHEAP]
    assert all((folder / name).stat().st_size > 3000 for name in pictures)
    assert re.findall(r"^\| \[[^\]]*\]\((.*?)\.md\)", text, re.MULTILINE) == CHEAP
    head = text.split("## Summary")[0]
    assert report.COMMAND in head
    for name in ("ngslac", "ngsolve", "numpy", "scipy", "Python"):
        assert re.search(rf"{name} \d", head)
    assert all(f"*{name}*: {meaning}" in head for name, meaning in ORIGINS.items())


def test_each_case_is_registered_once_and_each_example_is_one():
    functions = [case.function for case in report.CASES.values()]
    assert len(set(functions)) == len(functions)
    for module in MODULES:
        taking = {
            f
            for _, f in inspect.getmembers(module, inspect.isfunction)
            if f.__module__ == module.__name__ and [*inspect.signature(f).parameters] == ["quick"]
        }
        assert taking == {case.function for case in module.CASES}
    files = [*VALIDATION.glob("case*_*.py")]
    assert {path.stem for path in files} == {module.__name__ for module in MODULES}
    text = "\n".join(path.read_text() for path in files)
    scripts = (ROOT / "tutorials/examples").glob("*.py")
    examples = [path.stem for path in scripts if "\nmain = " in path.read_text()]
    assert len(examples) >= 12
    assert [name for name in examples if not re.search(rf"\b{name}\b", text)] == []


@pytest.mark.parametrize("case", report.CASES.values(), ids=report.CASES)
def test_cases_are_described(case):
    assert re.fullmatch(r"[a-z0-9-]+", case.name)
    assert case.text.strip()[-1] == case.source.strip()[-1] == "."
    assert not case.title.endswith(".")
    for file in re.findall(r"(?:tests|docs)/\S+\.py", f"{case.command} {case.source}"):
        assert (ROOT / file).exists()


# ---------------------------------------------------------------- rows and bounds


def Within(size, kind="relative"):
    return Bound(size, "exact", kind=kind)


@pytest.mark.parametrize(
    ("numbers", "bound", "holds"),
    [
        ((1.02, 1.0), Within(0.03), True),
        ((1.04, 1.0), Within(0.03), False),
        ((-0.02, 0), Within(0.03, "absolute"), True),
        ((5.0, 2.0), Within(0.1, "least"), True),
        ((1.8, 2.0), Within(0.1, "least"), False),
        ((math.nan, 1.0), Within(0.1), False),
        ((math.inf, 1.0), Within(0.1, "least"), False),
        ((0.0, 0.0), Exact(), True),
        ((1e-300, 0.0), Exact(), False),
        ((7.0, 1.0), None, True),
        ((math.nan, 1.0), None, False),
    ],
)
def test_a_row_holds_within_its_bound(numbers, bound, holds):
    row = Row("x", *numbers, bound)
    assert row.holds == holds
    assert ("too large" in row.Cells()[3]) != holds


def test_rows_are_shown_and_the_worst_is_found():
    judged = Row("force", 1.02, 1.0, Stated(0.03, "who"), "N")
    assert judged.Cells() == ["force [N]", "1.02", "1", "+2 %", "±3 %", "stated: who"]
    shown = Row("force", 7.0, 1.0, unit="N")
    assert shown.Cells() == ["force [N]", "7", "1", "+6e+02 %", "-", "not judged"]
    assert Worst([judged, Row("y", 2, 1, Rate()), judged]) is judged
    assert Worst([shown, Row("z", 1, 1, Exact())]).quantity == "z"


def test_a_bound_says_where_it_comes_from():
    with pytest.raises(TypeError, match="where it is from"):
        Row("x", 1, 1, 1e-3)
    with pytest.raises(ValueError, match="kind"):
        Bound(1, "exact", kind="nearly")
    with pytest.raises(ValueError, match="origin"):
        Bound(1, "experience")
    for size in (-0.1, math.nan, math.inf):
        with pytest.raises(ValueError, match="size"):
            Bound(size, "exact")


def test_bounds_are_made_of_what_they_name():
    assert Spread(2.0, [1.9, 2.2], "two").size == pytest.approx(0.1)
    assert Meshes(1.0, 1.1, 2).size == pytest.approx(0.3)
    assert Meshes(1.0, 1.1, 1.5).size == pytest.approx(0.6)
    assert HalfDigit(1e-3).size == pytest.approx(5e-4)
    assert Extrapolated(1.0, 0.98).size == pytest.approx(0.02)
    start, end = np.array([0.0, 2.0]), np.array([2.0, 3.0])
    exact = math.sqrt((4 / 12 + 1 / 12) / 2)  # of x: the length over the root of 12
    assert MeshSpread(lambda x: x, start, end) == pytest.approx(exact, rel=1e-4)


def test_a_case_that_fails_or_does_not_hold_is_seen(tmp_path, capsys):
    def Fails(quick):
        raise RuntimeError("no convergence | at all")

    def Blank(file):
        from matplotlib.figure import Figure

        Figure().savefig(file)

    def Wrong(quick):
        return Outcome([Row("a|b", 2, 1, Rate()), Row("c", 1, 2, Exact())], Blank, "Nothing.")

    cases = [
        Case(f.__name__.lower(), "Title", "Text.", "Source.", "true", f) for f in (Fails, Wrong)
    ]
    results = [Compute(case, True, tmp_path) for case in cases]
    assert not any(result.holds for result in results)
    text = "\n".join([Page(results, "command"), *map(CasePage, results)])
    assert all(t in text for t in ("0 of 2 cases hold", "**failed**", "**does not hold**", r"a\|b"))
    assert "no convergence" in capsys.readouterr().err


def test_subsets_need_a_folder(capsys):
    with pytest.raises(SystemExit):
        report.main(["--quick"])
    assert "--out" in capsys.readouterr().err
