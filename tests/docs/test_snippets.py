"""The Python snippets of the README and of the documentation run, and its commands are accepted."""

import argparse
import importlib
import re
import shlex
import textwrap
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
README = ROOT / "README.md"
PAGES = (p.relative_to(ROOT) for p in (ROOT / "docs").rglob("*.md"))
FILES = [README, *sorted(ROOT / p for p in PAGES if not any(part[0] == "_" for part in p.parts))]
KINDS = {"python", "{code-cell}"}
FENCE = re.compile(r"^([ ]*)```(\S*)[^\n]*\n(.*?)^\1```", re.MULTILINE | re.DOTALL)
SCRIPT = r"-m ngslac\.\S+|(?:tests|docs|tutorials)/\S+\.py"
OURS = re.compile(rf"^(?:\$ )?((?:\w+=\S+ )*)python ({SCRIPT})(.*)$")


def Fences(file, kinds):
    """Text and first line of the fenced blocks of some kinds."""
    text = Path(file).read_text()
    for match in FENCE.finditer(text):
        if match[2] in kinds:
            yield match[3], text[: match.start(3)].count("\n") + 1


def RunSnippets(file, folder, names=None):
    """Execute the Python blocks of a file in order, with `folder` as directory; their names.

    They share one namespace, that of `names` at the start. A block with prompts (``>>>``) shows
    output and belongs to doctest: it is refused here.
    """
    names = {"__name__": "__main__"} | (names or {})
    with pytest.MonkeyPatch.context() as patch:
        patch.chdir(folder)
        patch.setenv("MPLBACKEND", "agg")
        for code, line in Fences(file, KINDS):
            assert ">>>" not in code
            code = re.sub(r"^:.*$", "", textwrap.dedent(code), flags=re.MULTILINE)  # of a cell
            exec(compile("\n" * (line - 1) + code, str(file), "exec"), names)
    return names


def Commands(file):
    """The commands of a file that start a script or a module of ours: (target, arguments)."""
    shells = Fences(file, {"", "bash", "sh", "console"})
    lines = [part for code, _ in shells for line in code.splitlines() for part in line.split("&& ")]
    lines += re.findall(r"`(python [^`]+)`", Path(file).read_text())
    found = (OURS.match(line.strip()) for line in lines)
    return sorted({(match[2].removeprefix("-m "), match[3].strip()) for match in found if match})


def Parse(target, arguments, monkeypatch):
    """Run a command's parser alone: its ``main`` ends where the arguments are parsed."""

    class Parsed(Exception):  # noqa: N818
        pass

    def Stop(self, *args, **options):
        original(self, *args, **options)
        raise Parsed

    original = argparse.ArgumentParser.parse_args
    monkeypatch.setattr(argparse.ArgumentParser, "parse_args", Stop)
    if target.endswith(".py"):
        monkeypatch.syspath_prepend(str((ROOT / target).parent))
        target = Path(target).stem
    words = [word for word in shlex.split(arguments) if word not in ("H", "F", "DIR", "FOLDER")]
    with pytest.raises(Parsed):
        importlib.import_module(target).main(words)


@pytest.fixture(scope="module")
def example(tmp_path_factory):
    """The names of the README's example, which other pages may use, and where it wrote files."""
    folder = tmp_path_factory.mktemp("readme")
    return RunSnippets(README, folder), folder


def test_example_of_the_readme_is_right(example):
    names, folder = example
    # The traction on the top edge of length 1 is carried by contact alone.
    assert names["contact"].Force() == pytest.approx([20, 100], rel=1e-10)
    assert (folder / "blocks.vtu").exists()


OTHERS = [file for file in FILES if file != README and any(Fences(file, KINDS))]


@pytest.mark.parametrize("file", OTHERS, ids=lambda file: str(file.relative_to(ROOT)))
def test_snippets_of_pages(file, example, tmp_path):
    RunSnippets(file, tmp_path, example[0])


COMMANDS = [(file, *command) for file in FILES for command in Commands(file)]


@pytest.mark.parametrize(("file", "target", "arguments"), COMMANDS)
def test_commands_exist_and_take_their_options(file, target, arguments, monkeypatch):
    if target.endswith(".py"):
        assert (ROOT / target).exists()
        if not re.search(r"^def main\(argv", (ROOT / target).read_text(), re.MULTILINE):
            return
    Parse(target, re.sub(r"--(h|friction) [HF]\b", r"--\1 0.5", arguments), monkeypatch)


PAGE = """one

```python
x = 1
```
- item

  ```python
  x += 1
  ```
```bash
cd x && python tutorials/examples/hertz.py --out results
pip install x
```
and `python tests/benchmarks/scaling.py`
```{code-cell} ipython3
:tags: [hide-input]
1 / (x - 2)
```
"""


def test_snippets_share_their_names_and_commands_are_found(tmp_path, monkeypatch, capsys):
    file, hertz = tmp_path / "page.md", "tutorials/examples/hertz.py"
    file.write_text(PAGE)
    with pytest.raises(ZeroDivisionError) as error:  # since x is 2 by then
        RunSnippets(file, tmp_path)
    assert PAGE.splitlines()[error.traceback[-1].lineno].startswith("1 / ")  # counted from 0
    assert Commands(file) == [("tests/benchmarks/scaling.py", ""), (hertz, "--out results")]
    Parse(hertz, "--out results", monkeypatch)
    with pytest.raises(SystemExit):
        Parse(hertz, "--no-such-option", monkeypatch)
    assert "unrecognized" in capsys.readouterr().err
