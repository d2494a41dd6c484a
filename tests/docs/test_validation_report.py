"""The validation report: its page, its tables, its cases."""

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
from report_page import Compute, Page

DOCS = Path(__file__).parents[2] / "docs" / "validation"
VALIDATION = Path(__file__).parents[1] / "validation"
CHEAP = ["directions", "series", "sliding-block"]


@pytest.fixture(scope="module")
def page(tmp_path_factory):
    folder = tmp_path_factory.mktemp("report")
    results = report.Report(folder, names=CHEAP, quick=True)
    return folder, results, (folder / "index.md").read_text()


def Tables(text):
    """Rows of cells of each table of a markdown text."""
    blocks = re.findall(r"(?:^\|.*\|\n?)+", text, re.MULTILINE)
    return [[line.strip("| ").split(" | ") for line in block.splitlines()] for block in blocks]


def test_the_cases_hold(page):
    _, results, text = page
    assert [result.case.name for result in results] == CHEAP
    assert all(result.holds for result in results), text
    assert "**" not in text


def test_summary_and_one_table_for_each_case(page):
    _, results, text = page
    summary, *tables = Tables(text)
    assert len(summary) == 2 + len(CHEAP)
    assert len(tables) == len(CHEAP)
    for result, table, line in zip(results, tables, summary[2:], strict=True):
        rows = result.outcome.rows
        assert [row[0] for row in table[2:]] == [row.Cells()[0] for row in rows]
        assert all(len(row) == 6 for row in table)
        assert line[1] == Worst(rows).Cells()[0]
        assert line[4] == "holds"
    assert f"{len(CHEAP)} of {len(CHEAP)} cases hold" in text


def test_pictures_and_links(page):
    folder, _, text = page
    pictures = re.findall(r"!\[.*?\]\((pictures/.*?)\)", text)
    assert pictures == [f"pictures/{name}.png" for name in CHEAP]
    assert all((folder / name).stat().st_size > 3000 for name in pictures)
    links = re.findall(r"\[[^\]]*\]\(#validation-(.*?)\)", text)
    assert links == re.findall(r"^\(validation-(.*?)\)=$", text, re.MULTILINE) == CHEAP


def test_head_names_command_and_versions(page):
    text = page[2].split("## Summary")[0]
    assert report.COMMAND in text
    for name in ("ngslac", "ngsolve", "numpy", "scipy", "Python"):
        assert re.search(rf"{name} \d", text)


# ---------------------------------------------------------------- the cases


def test_each_function_is_registered_once():
    functions = [case.function for case in report.CASES.values()]
    assert len(set(functions)) == len(functions)
    assert sum(len(module.CASES) for module in MODULES) == len(report.CASES)
    for module in MODULES:
        taking = {
            f
            for _, f in inspect.getmembers(module, inspect.isfunction)
            if f.__module__ == module.__name__ and [*inspect.signature(f).parameters] == ["quick"]
        }
        assert taking == {case.function for case in module.CASES}
    modules = {path.stem for path in VALIDATION.glob("case*_*.py")}
    assert modules == {module.__name__ for module in MODULES}


@pytest.mark.parametrize("name", report.CASES)
def test_cases_are_described(name):
    case = report.CASES[name]
    assert re.fullmatch(r"[a-z0-9-]+", case.name)
    for text in (case.text, case.source):
        assert text.strip().endswith(".")
    assert not case.title.endswith(".")
    root = DOCS.parents[1]
    for file in re.findall(r"(?:tests|docs)/\S+\.py", f"{case.command} {case.source}"):
        assert (root / file).exists()


def test_examples_are_covered():
    """Each example appears in a command or is imported."""
    text = "\n".join(path.read_text() for path in VALIDATION.glob("case*_*.py"))
    scripts = (DOCS.parents[1] / "tutorials/examples").glob("*.py")
    examples = [path.stem for path in scripts if "def main(" in path.read_text()]
    assert [name for name in examples if not re.search(rf"\b{name}\b", text)] == []


# ---------------------------------------------------------------- rows


def Within(size, kind="relative"):
    return Bound(size, "exact", kind=kind)


def test_rows():
    assert Row("x", 1.02, 1.0, Within(0.03)).holds
    assert not Row("x", 1.04, 1.0, Within(0.03)).holds
    assert Row("x", -0.02, 0, Within(0.03, "absolute")).holds
    assert Row("rate", 5.0, 2.0, Within(0.1, "least")).holds
    assert not Row("rate", 1.8, 2.0, Within(0.1, "least")).holds
    assert not Row("x", math.nan, 1.0, Within(0.1)).holds
    assert not Row("x", math.inf, 1.0, Within(0.1, "least")).holds
    assert Row("x", 0.0, 0.0, Exact()).holds
    assert not Row("x", 1e-300, 0.0, Exact()).holds
    row = Row("force", 1.02, 1.0, Stated(0.03, "who"), "N")
    assert row.Cells() == ["force [N]", "1.02", "1", "+2 %", "±3 %", "stated: who"]
    assert "too large" in Row("force", 1.04, 1.0, Within(0.03)).Cells()[3]
    assert Worst([row, Row("y", 2, 1, Rate()), row]).quantity == "force"


def test_a_number_without_a_bound_is_shown_and_not_judged():
    row = Row("force", 7.0, 1.0, unit="N")
    assert row.holds
    assert not row.judged
    assert row.Cells() == ["force [N]", "7", "1", "+6e+02 %", "-", "not judged"]
    assert not Row("force", math.nan, 1.0).holds
    judged = Row("z", 1, 1, Exact())
    assert Worst([row, judged]) is judged


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


def test_the_page_explains_each_origin(page):
    text = page[2].split("## Summary")[0]
    assert all(f"*{name}*: {meaning}" in text for name, meaning in ORIGINS.items())


def test_a_case_that_fails_or_does_not_hold_is_seen(tmp_path, capsys):
    def Fails(quick):
        raise RuntimeError("no convergence | at all")

    def Wrong(quick):
        return Outcome(
            [Row("a|b", 2, 1, Rate()), Row("c", 1, 2, Exact())],
            lambda file: Blank(file),
            "Nothing.",
        )

    results = [
        Compute(
            Case(function.__name__.lower(), "Title", "Text.", "Source.", "true", function),
            True,
            tmp_path,
        )
        for function in (Fails, Wrong)
    ]
    assert not any(result.holds for result in results)
    text = Page(results, "command")
    assert "0 of 2 cases hold" in text
    assert "**failed**" in text
    assert "**does not hold**" in text
    assert "no convergence" in capsys.readouterr().err


def Blank(file):
    from matplotlib.figure import Figure

    Figure().savefig(file)


def test_subsets_need_a_folder(capsys):
    with pytest.raises(SystemExit):
        report.main(["--quick"])
    assert "--out" in capsys.readouterr().err
