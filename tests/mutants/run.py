"""Do tests notice a bug? Plants the mutants of table.txt in a copy of the sources, one at a time.

python tests/mutants/run.py [--only PATTERN] [--json FILE] [--folder FOLDER]
"""

import argparse
import importlib.util
import json
import os
import re
import shutil
import subprocess
import sys
import time
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

__all__ = ["Copy", "Main", "Mutant", "Read"]

HERE = Path(__file__).resolve().parent
ROOT = HERE.parents[1]
LONGEST = 1200  # seconds that tests may take
# An editable installation brings an import hook, which comes before all paths.
STARTUP = """import sys
sys.meta_path[:] = [f for f in sys.meta_path if "editable" not in type(f).__module__]
"""
CCACHE = {"CCACHE_NOHASHDIR": "1", "CCACHE_SLOPPINESS": "pch_defines,time_macros"}


@dataclass(frozen=True)
class Mutant:
    """One wrong line: where, the tests that should fail by it, and what it breaks."""

    file: str
    tests: tuple
    why: str
    old: str
    new: str

    def __str__(self):
        return f"{self.file}: {self.why}"


def Read(text):
    """Mutants of a table: ``file | tests | why``, then lines with "-" and with "+" in front."""
    found = []
    for block in re.split(r"\n(?=\S+ \| )", "\n" + text)[1:]:
        head, *lines = block.rstrip("\n").split("\n")
        file, tests, why = head.split(" | ")
        old, new = ("\n".join(x[1:] for x in lines if x[:1] == sign) for sign in "-+")
        found.append(Mutant(file, tuple(f"tests/{t}.py" for t in tests.split()), why, old, new))
    return found


class Copy:
    """Package, plugin and C++ sources of `root` in a folder where they may be spoilt."""

    def __init__(self, root, folder):
        self.root, self.folder, self.plugin = root, folder, None
        for name in ("ngslac", "cpp"):
            shutil.rmtree(folder / name, ignore_errors=True)
            if (root / name).is_dir():
                ignored = shutil.ignore_patterns("__pycache__", "*.so")
                shutil.copytree(root / name, folder / name, ignore=ignored)
        (folder / "sitecustomize.py").write_text(STARTUP)
        if (folder / "cpp").is_dir():
            original = Path(importlib.util.find_spec("ngslac._ngslac").origin)
            self.plugin = folder / "ngslac" / original.name
            self.original = shutil.copy(original, folder)
            shutil.copy(original, self.plugin)
        modules = "ngslac" if self.plugin is None else "ngsolve, ngslac, ngslac._ngslac"
        code = f"import {modules}, sys; print(sys.modules[{modules.split(', ')[-1]!r}].__file__)"
        found = self._Python("-c", code, check=True, capture_output=True, text=True).stdout
        if not Path(found.strip()).is_relative_to(folder):
            raise RuntimeError(f"tests would import {found.strip()}, not the copy in {folder}")

    def _Python(self, *args, **options):
        environment = {"PYTHONPATH": str(self.folder), "PYTHONDONTWRITEBYTECODE": "1"}
        environment |= {"NGS_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1"}
        given = {"cwd": self.folder, "env": os.environ | environment, **options}
        return subprocess.run([sys.executable, *args], **given)

    def _Fail(self, tests, *options):
        """Does a test fail, or the process crash or hang?"""
        command = ["-m", "pytest", "-x", "-q", "-o", f"cache_dir={self.folder / 'cache'}"]
        command += [*options, *(str(self.root / test) for test in tests)]
        with (self.folder / "log.txt").open("w") as log:
            given = {"stdout": log, "stderr": log, "timeout": LONGEST}
            try:
                code = self._Python(*command, **given).returncode
            except subprocess.TimeoutExpired:
                return True
        if code in (3, 4, 5):
            raise RuntimeError(f"pytest could not run {' '.join(tests)}")
        return code != 0

    @contextmanager
    def _Planted(self, mutant):
        path = self.folder / mutant.file
        text = path.read_text()
        if (count := text.count(mutant.old)) != 1:
            raise ValueError(f"the original text is there {count} times")
        path.write_text(text.replace(mutant.old, mutant.new))
        try:
            if path.suffix == ".py":
                compile(path.read_text(), mutant.file, "exec")
            else:
                shutil.copy(self._Build(), self.plugin)
            yield
        finally:
            path.write_text(text)
            if path.suffix != ".py":
                shutil.copy(self.original, self.plugin)

    def _Build(self):
        build, quiet = self.folder / "build", {"check": True, "stdout": subprocess.DEVNULL}
        options = ["-DCMAKE_BUILD_TYPE=Release", f"-DPython3_EXECUTABLE={sys.executable}"]
        options.append("-DCMAKE_UNITY_BUILD=OFF")  # a mutant is one file
        if shutil.which("ccache"):
            options.append("-DCMAKE_CXX_COMPILER_LAUNCHER=ccache")
        environment = {"env": os.environ | CCACHE | {"CCACHE_BASEDIR": str(self.folder)}}
        configure = ["cmake", "-S", self.folder / "cpp", "-B", build, *options]
        subprocess.run(configure, **quiet, **environment)
        subprocess.run(["cmake", "--build", build, "-j2"], **quiet, **environment)
        return next(build.glob("_ngslac.*.so"))

    def Judge(self, mutant):
        """ "killed", "survived", or what is wrong with the mutant or its tests."""
        try:
            with self._Planted(mutant):
                if not self._Fail(mutant.tests, "--cache-clear"):
                    return "survived"
            if self._Fail(mutant.tests, "--lf"):  # what failed: passes it otherwise?
                return "error: its tests fail without it, too"
        except (OSError, RuntimeError, SyntaxError, ValueError) as error:
            return f"error: {error}"
        except subprocess.CalledProcessError:
            return "error: it does not compile"
        return "killed"


def Main(arguments=None, *, root=ROOT, table=HERE / "table.txt"):
    """Number of mutants that were not killed."""
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--only", default="", metavar="PATTERN", help="of file and reason")
    parser.add_argument("--json", type=Path, help="where to write the result")
    parser.add_argument("--folder", type=Path, default=root / "build" / "mutants")
    given = parser.parse_args(arguments)
    given.folder.mkdir(parents=True, exist_ok=True)
    copy, rows = Copy(root, given.folder.resolve()), []
    for mutant in Read(table.read_text()):
        if re.search(given.only, str(mutant)):
            start = time.monotonic()
            verdict = copy.Judge(mutant)
            seconds = round(time.monotonic() - start, 1)
            rows.append({"mutant": str(mutant), "verdict": verdict, "seconds": seconds})
            print(f"{verdict:10} {seconds:7.1f} s  {mutant}", flush=True)
            if given.json:
                given.json.write_text(json.dumps(rows, indent=1) + "\n")
    alive = sum(row["verdict"] != "killed" for row in rows)
    print(f"{len(rows) - alive} of {len(rows)} mutants killed")
    return alive


if __name__ == "__main__":
    sys.exit(min(Main(), 1))
