"""Runs the notebooks of the tutorials, each in a kernel of its own, and keeps the results."""

import hashlib
import os
import tempfile
from concurrent.futures import ThreadPoolExecutor
from functools import lru_cache
from pathlib import Path

import nbformat
from nbclient import NotebookClient

import ngslac

__all__ = ["Executed", "Keep"]


@lru_cache
def _Package():
    """A hash that changes with every file of the package."""
    total, package = hashlib.sha256(), Path(ngslac.__file__).parent
    for source in sorted(
        file for file in package.rglob("*") if file.suffix in (".py", ".so", ".js")
    ):
        total.update(source.read_bytes())
    return total.hexdigest()


def _Stamp(path):
    """A text that changes with the notebook and with the package."""
    return hashlib.sha256(path.read_bytes()).hexdigest() + _Package()


def Keep(notebook, path, cache):
    """Put the executed `notebook` of the file `path` into the folder `cache`."""
    notebook.metadata["stamp"] = _Stamp(path)
    cache.mkdir(parents=True, exist_ok=True)
    with tempfile.NamedTemporaryFile("w", dir=cache, delete=False) as file:
        nbformat.write(notebook, file)
    os.replace(file.name, cache / path.name)  # at once: others may be reading


def _Run(path, cache):
    kept = cache / path.name
    if kept.exists():
        notebook = nbformat.read(kept, as_version=4)
        if notebook.metadata.get("stamp") == _Stamp(path):
            return notebook
    notebook = nbformat.read(path, as_version=4)
    with tempfile.TemporaryDirectory() as folder:
        client = NotebookClient(
            notebook, kernel_name="python3", timeout=600, resources={"metadata": {"path": folder}}
        )
        client.execute()
    Keep(notebook, path, cache)
    return notebook


def Executed(paths, cache):
    """The notebooks with outputs, by name; from the folder `cache` where nothing has changed."""
    paths = list(paths)
    # As many kernels as cores, with one thread each.
    os.environ |= {"NGS_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1"}
    os.environ.pop("MPLBACKEND", None)
    with ThreadPoolExecutor(os.cpu_count()) as pool:
        notebooks = pool.map(lambda path: _Run(path, cache), paths)
        return {path.stem: notebook for path, notebook in zip(paths, notebooks, strict=True)}
