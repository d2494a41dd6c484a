"""The validation report: its page, its tables, its cases."""

import inspect
import math
import re
import sys
from pathlib import Path

import pytest

DOCS = Path(__file__).parents[2] / "docs" / "validation"
sys.path.insert(0, str(DOCS))

import report  # noqa: E402
from _report_case import Case, Outcome, Row, Worst  # noqa: E402
from _report_page import Compute, Page  # noqa: E402

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
        assert all(len(row) == 5 for row in table)
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
    assert sum(len(module.CASES) for module in report.MODULES) == len(report.CASES)
    for module in report.MODULES:
        taking = {
            f
            for _, f in inspect.getmembers(module, inspect.isfunction)
            if f.__module__ == module.__name__ and [*inspect.signature(f).parameters] == ["quick"]
        }
        assert taking == {case.function for case in module.CASES}
    modules = {path.stem for path in DOCS.glob("_cases_*.py")}
    assert modules == {module.__name__ for module in report.MODULES}


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


def test_demos_and_validation_tests_are_covered():
    """Each demo, and each file of tests/validation, appears in a command or is imported."""
    text = "\n".join(path.read_text() for path in DOCS.glob("_cases_*.py"))
    root = DOCS.parents[1]
    files = [path.stem for path in (root / "tests/validation").glob("test_*.py")]
    demos = [p.stem for p in (root / "ngslac/demos").glob("[a-z]*.py")]
    same = {"test_convergence": "signorini", "test_patch_overlap": "test_patch"}
    same |= {"test_patch3d": "patch3d", "test_patch3d_overlap": "patch3d"}
    same |= {"test_validation_twist": "twist", "test_validation_cattaneo3d": "cattaneo3d"}
    same |= {"test_validation_hertz": "test_validation_hertz.py"}
    same |= {"test_validation_mms_large": "problems_mms_large"}
    missing = [
        name for name in files + demos if not re.search(rf"\b{same.get(name, name)}\b", text)
    ]
    assert missing == []


# ---------------------------------------------------------------- rows


def test_rows():
    assert Row("x", 1.02, 1.0, 0.03).holds
    assert not Row("x", 1.04, 1.0, 0.03).holds
    assert Row("x", -0.02, 0, 0.03, "absolute").holds
    assert Row("rate", 5.0, 2.0, 0.1, "least").holds
    assert not Row("rate", 1.8, 2.0, 0.1, "least").holds
    assert not Row("x", math.nan, 1.0, 0.1).holds
    assert not Row("x", math.inf, 1.0, 0.1, "least").holds
    assert Row("x", 0.0, 0.0, 0, "absolute").holds
    assert not Row("x", 1e-300, 0.0, 0, "absolute").holds
    row = Row("force", 1.02, 1.0, 0.03, unit="N")
    assert row.Cells() == ["force [N]", "1.02", "1", "+2 %", "±3 %"]
    assert "too large" in Row("force", 1.04, 1.0, 0.03).Cells()[3]
    assert Worst([row, Row("y", 2, 1, 0.5), row]).quantity == "y"
    with pytest.raises(ValueError, match="kind"):
        Row("x", 1, 1, 1, "exact")
    with pytest.raises(ValueError, match="tolerance"):
        Row("x", 1, 1, -0.1)


def test_a_case_that_fails_or_does_not_hold_is_seen(tmp_path, capsys):
    def Fails(quick):
        raise RuntimeError("no convergence | at all")

    def Wrong(quick):
        return Outcome([Row("a|b", 2, 1, 0.1)], lambda file: Blank(file), "Nothing.")

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
