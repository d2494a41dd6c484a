"""A sample of the fuzz command: no crash, no hang, nothing malformed accepted, arguments named."""

import inspect
import json
import subprocess
import sys
from pathlib import Path

import pytest
from fuzz_targets import TARGETS

import ngslac

RUN = Path(__file__).with_name("run.py")
BAD = ("crashes", "hangs", "silent", "unnamed")


def test_sample(tmp_path):
    numbers = tmp_path / "numbers.json"
    command = [sys.executable, RUN, "--sample", "60", "--jobs", "1", "--json", numbers]
    done = subprocess.run(command, capture_output=True, text=True, cwd=tmp_path)
    found = json.loads(numbers.read_text())
    assert not any(found[name] for name in BAD), done.stdout
    assert (done.returncode, found["cases"]) == (0, 60)


def test_what_the_command_finds(tmp_path):
    """Outcomes of calls that do what they must not, each in a process of its own."""
    script = f"""
import os, sys, time
sys.path.insert(0, {str(RUN.parent)!r})
from fuzz_cases import Case
from fuzz_process import RunAll

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
outcomes = [(case.name.split()[0], outcome) for case, outcome, _ in RunAll(made, World(), 2, 1)]
assert len(outcomes) == len(cases), outcomes
assert all(wanted == outcome for wanted, outcome in outcomes), outcomes
"""
    subprocess.run([sys.executable, "-c", script], check=True)


def Public():
    """(name of a target, callable) of all that is public, of Python, and takes arguments."""
    for name in ngslac.__all__:
        thing = getattr(ngslac, name)
        if not callable(thing) or thing.__module__ in ("ngslac._ngslac", "ngslac.errors"):
            continue
        yield name, thing
        for method in dir(thing) if inspect.isclass(thing) else ():
            found = getattr(thing, method)
            module = getattr(found, "__module__", None) or ""
            if method[0].isupper() and module.startswith("ngslac."):
                yield f"{name}.{method}", found


@pytest.mark.parametrize(("name", "thing"), [pytest.param(*p, id=p[0]) for p in Public()])
def test_every_public_argument_has_cases(name, thing):
    parameters = inspect.signature(thing).parameters.values()
    wanted = {p.name for p in parameters if p.kind != p.VAR_KEYWORD} - {"self"}
    kind, _, method = name.partition(".")  # a method is inherited as it is
    names = (
        {f"{base.__name__}.{method}" for base in getattr(ngslac, kind).__mro__}
        if method
        else {kind}
    )
    targets = [target for target in TARGETS if target.name.split(" with ")[0] in names]
    varied = {entry.partition(":")[0] for t in targets for entry in t.names.split()}
    assert wanted <= varied
