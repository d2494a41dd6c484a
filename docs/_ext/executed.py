"""Runs the notebooks of the tutorials, each in a kernel of its own, and keeps the results."""

import hashlib
import os
import tempfile
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import nbformat
from nbclient import NotebookClient

import ngslac

__all__ = ["Executed"]


def _Stamp(path):
    """A number that changes with the notebook and with every file of the package."""
    total = hashlib.sha256(path.read_bytes())
    package = Path(ngslac.__file__).parent
    for source in sorted(file for file in package.rglob("*") if file.suffix in (".py", ".so")):
        total.update(source.read_bytes())
    return total.hexdigest()


def _Run(path, cache):
    stamp, kept = _Stamp(path), cache / path.name
    if kept.exists():
        notebook = nbformat.read(kept, as_version=4)
        if notebook.metadata.get("stamp") == stamp:
            return notebook
    notebook = nbformat.read(path, as_version=4)
    with tempfile.TemporaryDirectory() as folder:
        client = NotebookClient(
            notebook, kernel_name="python3", timeout=600, resources={"metadata": {"path": folder}}
        )
        client.execute()
    notebook.metadata["stamp"] = stamp
    cache.mkdir(parents=True, exist_ok=True)
    nbformat.write(notebook, kept)
    return notebook


def Executed(paths, cache):
    """The notebooks with outputs, by name; from the folder `cache` where nothing has changed."""
    paths = list(paths)
    # As many kernels as cores, with one thread each.
    os.environ |= {"NGS_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1"}
    os.environ.pop("MPLBACKEND", None)
    with ThreadPoolExecutor(os.cpu_count()) as pool:
        return dict(zip((p.stem for p in paths), pool.map(lambda p: _Run(p, cache), paths)))
