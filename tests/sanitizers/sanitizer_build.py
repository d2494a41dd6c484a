"""Build the plugin, and a module with errors on purpose, in a folder of its own."""

import os
import subprocess
import sys
from dataclasses import dataclass, field
from pathlib import Path

__all__ = ["KINDS", "ROOT", "Build", "Environment"]

HERE = Path(__file__).resolve().parent
ROOT = HERE.parents[1]
COMMON = "-O1 -g1 -fno-omit-frame-pointer"
# The interpreter and the wheel leave memory to the end of the process, and share inline data.
MEMORY = "detect_leaks=0:detect_odr_violation=0:halt_on_error=0:detect_stack_use_after_return=1"


@dataclass(frozen=True)
class Kind:
    """One way to instrument."""

    flags: str  # of the compiler
    planted: str  # errors of planted.cpp that have to be found
    libraries: tuple = ()  # run-time libraries that have to come before all others
    options: dict = field(default_factory=dict)  # environment of those


KINDS = {
    "address": Kind(
        # The wheel keeps the types of its classes to itself: "vptr" would find none of them.
        f"{COMMON} -fsanitize=address,undefined -fno-sanitize=vptr"
        " -fsanitize-recover=address,undefined",
        "past_the_end after_the_end past_the_stack overflow shift",
        # The last one, for what the first two hold of exceptions on their way.
        ("libasan.so", "libubsan.so", "libstdc++.so.6"),
        {"ASAN_OPTIONS": MEMORY, "UBSAN_OPTIONS": "print_stacktrace=1"},
    ),
    "range": Kind(
        f"{COMMON} -D_GLIBCXX_ASSERTIONS",
        "standard_vector empty_optional netgen_array netgen_vector netgen_matrix",
    ),
}


def Build(kind, folder, jobs):
    """Compile what changed since the last time; the plugin. Planted errors lie beside it."""
    configure = ["cmake", "-S", ROOT / "cpp", "-B", folder, "-DCMAKE_BUILD_TYPE=None"]
    configure += [f"-DPython3_EXECUTABLE={sys.executable}", f"-DNGSLAC_CHECKS={kind}"]
    configure += [f"-DCMAKE_PROJECT_ngslac_INCLUDE={HERE / 'checks.cmake'}"]
    configure += [f"-DCMAKE_CXX_FLAGS={KINDS[kind].flags}"]
    subprocess.run(configure, check=True, stdout=subprocess.DEVNULL)
    subprocess.run(["cmake", "--build", folder, f"-j{jobs}"], check=True)
    (plugin,) = folder.glob("_ngslac.*.so")
    return plugin


def Environment(kind, plugin):
    """Of processes that import the instrumented plugin."""
    paths = [str(HERE / "startup"), os.environ.get("PYTHONPATH")]
    own = {"NGSLAC_PLUGIN": str(plugin), "PYTHONPATH": os.pathsep.join(filter(None, paths))}
    own |= {"OPENBLAS_NUM_THREADS": "1", **KINDS[kind].options}
    if KINDS[kind].libraries:
        own["LD_PRELOAD"] = " ".join(map(_Library, KINDS[kind].libraries))
    return os.environ | own


def _Library(name):
    """Where the compiler has it; a name only where it has not."""
    command = ["g++", f"-print-file-name={name}"]
    return subprocess.run(command, check=True, capture_output=True, text=True).stdout.strip()
