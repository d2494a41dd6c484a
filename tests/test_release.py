"""What a release consists of: metadata, the archive of sources, facts that stand in two files."""

import importlib
import re
import tarfile
from email import message_from_string
from pathlib import Path

import pytest
import yaml

import ngslac
from ngslac.__main__ import CHECK

ROOT = Path(__file__).parents[1]
LEFT_BEHIND = (
    *("build/editable/_ngslac.so", "dist/old.whl", "venv/pyvenv.cfg", "site/index.html"),
    *("jupyter_execute/a.ipynb", "docs/jupyter_execute/a.ipynb", "results/hertz.png"),
    *("docs/_generated/a.ipynb", "docs/tutorials/a.md", "ngslac/__pycache__/a.pyc"),
    *("ngslac/_ngslac.so", "field.vtu", "shared/notes.md"),
)
KEPT = ("ngslac/__init__.py", "cpp/backend.py", "tests/test_release.py", "docs/index.md")


@pytest.fixture
def backend(monkeypatch):
    monkeypatch.syspath_prepend(str(ROOT / "cpp"))
    pytest.importorskip("scikit_build_core", reason="it is there while the package is built")
    return importlib.import_module("backend")


@pytest.mark.parametrize("ignored", [True, False], ids=["gitignore", "alone"])
def test_the_archive_holds_sources_and_no_products(backend, tmp_path, monkeypatch, ignored):
    for name in ("pyproject.toml", "README.md", "LICENSE", *[".gitignore"] * ignored):
        (tmp_path / name).write_text((ROOT / name).read_text())
    for name in (*LEFT_BEHIND, *KEPT):
        (tmp_path / name).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / name).write_text("")
    monkeypatch.chdir(tmp_path)
    with tarfile.open(Path("dist", backend.build_sdist("dist"))) as archive:
        names = {name.partition("/")[2] for name in archive.getnames()}
        facts = archive.extractfile(f"ngslac-{ngslac.__version__}/PKG-INFO").read().decode()
    assert names & {*LEFT_BEHIND} == set()
    assert names >= {*KEPT, "pyproject.toml", "LICENSE"}
    assert f"\nVersion: {ngslac.__version__}\n" in facts
    assert "\nLicense-Expression: LGPL-2.1-or-later\n" in facts


LINK = re.compile(r"!?\[[^][]*\]\(([^)]*)\)")
OUTSIDE = ["https://ngsolve.org"]


def test_links_of_the_readme_lead_to_files():
    links = LINK.findall((ROOT / "README.md").read_text())
    assert [link for link in links if "://" in link] == OUTSIDE
    assert len(links) > 8
    assert [link for link in links if link not in OUTSIDE and not (ROOT / link).exists()] == []


def test_links_of_the_package_lead_to_where_it_is_published(backend, tmp_path, monkeypatch):
    monkeypatch.chdir(ROOT)
    folder = tmp_path / backend.prepare_metadata_for_build_wheel(tmp_path)
    facts = message_from_string((folder / "METADATA").read_text())
    urls = dict(url.split(", ") for url in facts.get_all("Project-URL"))
    home, links = urls["Repository"], LINK.findall(facts.get_payload())
    readme = LINK.findall((ROOT / "README.md").read_text())
    assert [re.sub(rf"^{home}/(blob|raw)/main/", "", link) for link in links] == readme
    assert [link for link in links if "://" not in link] == []
    assert f"]({home}/raw/main/tutorials/pictures/" in facts.get_payload()  # a file, not its page
    assert facts["Description-Content-Type"] == "text/markdown"


def test_the_readme_is_short():
    text = (ROOT / "README.md").read_text()
    assert len(text.split()) <= 600
    assert "pip install ngslac\n" in text


SOURCES = [file for end in ("py", "pyi", "cpp", "hpp") for file in ROOT.glob(f"[nc]*/**/*.{end}")]


def test_every_source_names_the_licence():
    lines = {str(file): file.read_text().partition("\n")[0] for file in SOURCES}
    assert len(lines) > 250
    mark = "SPDX-License-Identifier: LGPL-2.1-or-later"
    assert [file for file, line in lines.items() if line not in (f"# {mark}", f"// {mark}")] == []


def test_where_it_is_published_is_the_same_everywhere():
    facts = (ROOT / "pyproject.toml").read_text()
    cited = yaml.safe_load((ROOT / "CITATION.cff").read_text())
    assert f'Repository = "{cited["repository-code"]}"' in facts
    assert [f'{{ name = "{author["name"]}" }}' in facts for author in cited["authors"]] == [True]
    assert f'license = "{cited["license"]}"' in facts


def test_commits_are_checked_by_the_linters_that_count():
    hooks = yaml.safe_load((ROOT / ".pre-commit-config.yaml").read_text())["repos"][0]["hooks"]
    linters = (ROOT / ".ci" / "linters.txt").read_text().split()
    assert sorted({pin for hook in hooks for pin in hook["additional_dependencies"]}) == sorted(
        linters
    )
    for hook in hooks:
        program = hook["entry"].split()[0]
        assert [pin.split("==")[0] for pin in hook["additional_dependencies"]] == [program]


WORKFLOWS = sorted((ROOT / ".github" / "workflows").glob("*.yml"))


def Steps(file):
    jobs = yaml.safe_load(file.read_text())["jobs"]
    return [step for job in jobs.values() for step in job.get("steps", ())]


def Runs(name):
    return [step.get("run") for step in Steps(ROOT / ".github" / "workflows" / f"{name}.yml")]


def test_workflows_are_complete():
    assert [f.stem for f in WORKFLOWS] == ["docs", "release", "tests", "weekly", "wheels"]
    for step in (step for file in WORKFLOWS for step in Steps(file)):
        assert ("run" in step) != ("uses" in step)
        assert "run" in step or "@" in step["uses"]


def test_workflows_run_the_commands_that_people_run():
    guide, readme = ((ROOT / name).read_text() for name in ("CONTRIBUTING.md", "README.md"))
    assert "bash .ci/run" in Runs("tests")
    assert [run for run in Runs("docs") if run and run in guide]
    assert "python tutorials/examples/hertz.py --out results" in Runs("wheels")
    assert "python tutorials/examples/hertz.py --out results" in readme
    assert CHECK in Runs("weekly")
    assert any('pytest -n 2 --dist loadfile -m ""' in run for run in Runs("weekly") if run)
    assert "bash .ci/run" in Runs("weekly")
    steps = Steps(ROOT / ".github" / "workflows" / "weekly.yml")
    assert {"PYTEST_ADDOPTS": "-m ''"} in [step.get("env") for step in steps]
    assert CHECK in Runs("wheels")
    assert f'test-command = "{CHECK}"' in (ROOT / "pyproject.toml").read_text()
