"""The runner of the mutants tells which of them the tests of a tiny package notice."""

import importlib.util
import json
from pathlib import Path

import pytest

HERE = Path(__file__).parent
SPEC = importlib.util.spec_from_file_location("mutants_run", HERE / "run.py")
mutants = importlib.util.module_from_spec(SPEC)
SPEC.loader.exec_module(mutants)

TABLE = """
ngslac/law.py | test_law | wrong sign
-    return -x
+    return x
ngslac/law.py | test_law | a number nothing depends on
-SPARE = 1
+SPARE = 2
ngslac/law.py | test_law | no longer there
-    return 3 * x
+    return x
ngslac/law.py | test_red | tests that fail anyway
-SPARE = 1
+SPARE = 3
"""


@pytest.mark.full
def test_kills_survivors_and_errors_are_told_apart(tmp_path, monkeypatch):
    monkeypatch.setenv("PYTEST_DISABLE_PLUGIN_AUTOLOAD", "1")  # they would only take time
    files = {
        "ngslac/__init__.py": "",
        "ngslac/law.py": "SPARE = 1\n\n\ndef Opposite(x):\n    return -x\n",
        "tests/test_law.py": "from ngslac.law import Opposite\n\n\n"
        "def test_sign():\n    assert Opposite(1) == -1\n",
        "tests/test_red.py": "def test_red():\n    assert False\n",
        "table.txt": TABLE,
    }
    for name, text in files.items():
        (tmp_path / name).parent.mkdir(exist_ok=True)
        (tmp_path / name).write_text(text)
    result = tmp_path / "result.json"
    alive = mutants.Main(
        ["--json", str(result), "--folder", str(tmp_path / "copy")],
        root=tmp_path,
        table=tmp_path / "table.txt",
    )
    verdicts = [row["verdict"] for row in json.loads(result.read_text())]
    assert alive == 3
    assert verdicts[:2] == ["killed", "survived"]
    assert "there 0 times" in verdicts[2]
    assert "fail without" in verdicts[3]
    assert (tmp_path / "ngslac" / "law.py").read_text() == files["ngslac/law.py"]


def test_each_mutant_of_the_table_fits_the_sources():
    table = mutants.Read((HERE / "table.txt").read_text())
    for mutant in table:
        text = (mutants.ROOT / mutant.file).read_text()
        assert text.count(mutant.old) == 1, f"{mutant}: {mutant.old!r}"
        assert mutant.new != mutant.old
        assert mutant.tests
        assert all((mutants.ROOT / test).is_file() for test in mutant.tests)
    assert len(table) == len({(m.file, m.old, m.new) for m in table})


@pytest.mark.parametrize("text", ["", "just words\n"])
def test_a_table_without_mutants_is_empty(text):
    assert mutants.Read(text) == []
