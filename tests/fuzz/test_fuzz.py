"""A sample of the fuzz command: no crash, no hang, nothing malformed accepted, arguments named."""

import json
import subprocess
import sys
from pathlib import Path

RUN = Path(__file__).with_name("run.py")


def test_sample(tmp_path):
    numbers = tmp_path / "numbers.json"
    command = [sys.executable, RUN, "--sample", "60", "--jobs", "1", "--json", numbers]
    done = subprocess.run(command, capture_output=True, text=True, cwd=tmp_path)
    found = json.loads(numbers.read_text())
    bad = {name: found[name] for name in ("crashes", "hangs", "silent", "unnamed")}
    assert not any(bad.values()), done.stdout
    assert done.returncode == 0
    assert found["cases"] == 60


def test_what_the_command_finds(tmp_path):
    """Outcomes of calls that do what they must not, each in a process of its own."""
    script = f"""
import os, sys, time
sys.path.insert(0, {str(RUN.parent)!r})
from fuzz_cases import Case
from fuzz_process import Processes

class World:
    folder = type("Folder", (), {{"name": {str(tmp_path)!r}}})

def Fail(error):
    raise error

cases = {{
    "crash": lambda w: os.abort(),
    "hang": lambda w: time.sleep(60),
    "silent": lambda w: None,
    "unnamed": lambda w: Fail(ValueError("something is wrong")),
    "unnamed too": lambda w: Fail(AttributeError("size")),
    "named": lambda w: Fail(ValueError("size = -1 must be positive")),
}}
made = [Case("target", name, run, ("size",), False) for name, run in cases.items()]
for case, outcome, _ in Processes(World(), 2, 1).Run(made):
    assert outcome == case.name.split()[0], (outcome, case.name)
"""
    subprocess.run([sys.executable, "-c", script], check=True)
