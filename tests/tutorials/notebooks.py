"""Runs the notebooks of the tutorials in a kernel that they share, and gets values out of it."""

import atexit
import json
import os
import sys
from functools import cache
from pathlib import Path
from types import SimpleNamespace

import nbformat
import numpy as np
import pytest
from jupyter_client import KernelManager
from nbclient import NotebookClient

import ngslac

ROOT = Path(__file__).parents[2]
FOLDER = ROOT / "tutorials"
sys.path.insert(0, str(ROOT / "docs" / "_ext"))

from executed import Keep  # noqa: E402

CONTACT, HERTZ, SPACE = "01_contact_in_twenty_lines", "02_hertz", "03_three_dimensions"

PRINT = """
import json

print(json.dumps(VALUES, default=lambda value: value.tolist()))
"""
# As in a kernel of its own: no names, cells counted from 1, no open figures, an empty folder.
FRESH = """
import os
import sys

os.chdir({folder!r})
if "matplotlib.pyplot" in sys.modules:
    sys.modules["matplotlib.pyplot"].close("all")
get_ipython().reset()
"""


@cache
def Kernel():
    """The kernel of this process, which imports once what all notebooks need."""
    kernel = KernelManager(kernel_name="python3")
    with pytest.MonkeyPatch.context() as patch:
        # The kernel takes the package from where the tests have it, and shows its pictures.
        paths = [str(Path(ngslac.__file__).parents[1]), os.environ.get("PYTHONPATH")]
        patch.setenv("PYTHONPATH", os.pathsep.join(filter(None, paths)))
        patch.delenv("MPLBACKEND", raising=False)
        kernel.start_kernel()
    atexit.register(kernel.shutdown_kernel, now=True)
    return kernel


def Execute(name, values, folder, replace=None, keep=True):
    """Run a notebook in a fresh session; the `VALUES` of extra cells, and all outputs.

    `keep` is False where `replace` changes what the site would show.
    """
    path = FOLDER / f"{name}.ipynb"
    notebook = nbformat.read(path, as_version=4)
    sources = [cell.source for cell in notebook.cells]
    for old, new in (replace or {}).items():
        (cell,) = (cell for cell in notebook.cells if old in cell.source)
        cell.source = cell.source.replace(old, new)
    notebook.cells += map(nbformat.v4.new_code_cell, (values, PRINT))
    fresh = nbformat.v4.new_notebook(
        cells=[nbformat.v4.new_code_cell(FRESH.format(folder=str(folder)))]
    )
    for book in (fresh, notebook):
        NotebookClient(book, km=Kernel(), timeout=500).execute()
    outputs = [output for cell in notebook.cells for output in cell.get("outputs", [])]
    text = "".join(cell.text for cell in notebook.cells[-1].outputs if "text" in cell)
    notebook.cells = notebook.cells[: len(sources)]
    for cell, source in zip(notebook.cells, sources, strict=True):
        cell.source = source
    if keep:  # the site need not run it
        Keep(notebook, path, ROOT / "docs" / "_generated" / "executed")
    return json.loads(text, object_hook=Arrays), outputs


def Tutorial(name, values, pictures, replace=None, keep=True):
    """A fixture: the values of a notebook, which shows so many pictures and no errors.

    Beside the `VALUES` it has the `text` that is printed, the `outputs`, and the `folder`.
    """

    @pytest.fixture(scope="module")
    def values_of(tmp_path_factory):
        folder = tmp_path_factory.mktemp(name)
        found, outputs = Execute(name, values, folder, replace, keep)
        assert not [o for o in outputs if o.output_type == "error" or o.get("name") == "stderr"]
        assert sum("image/png" in output.get("data", {}) for output in outputs) == pictures
        text = "".join(output.text for output in outputs if output.output_type == "stream")
        return SimpleNamespace(text=text, outputs=outputs, folder=folder, **found)

    return values_of


def Files(folder, pattern="*"):
    """Names of the files, all of which hold something."""
    sizes = {path.name: path.stat().st_size for path in Path(folder).glob(pattern)}
    assert min(sizes.values()) > 5000
    return sorted(sizes)


def Arrays(values):
    return {k: np.array(v) if isinstance(v, list) else v for k, v in values.items()}
