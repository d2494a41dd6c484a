"""Sphinx extension: puts among the sources of the site what lies elsewhere.

That is the executed tutorials and the pages about benchmarks.
"""

import shutil
from pathlib import Path

import nbformat
from executed import Executed
from scenes import Script, TakeScenes

__all__ = ["setup"]

# At the same place below the site's sources, so that links to them hold here and there.
PAGES = ("tests/benchmarks/README.md", "tests/benchmarks/peers/README.md")


def _Write(path, text):
    """Write if that changes something, so that Sphinx reads again only what it has to."""
    path.parent.mkdir(parents=True, exist_ok=True)
    if not path.exists() or path.read_text() != text:
        path.write_text(text)


def _Prepare(app):
    source = Path(app.srcdir)
    generated = source / "_generated"
    static = generated / "static"
    static.mkdir(parents=True, exist_ok=True)
    shutil.copy(app.config.webgui_script, static / "webgui.js")
    paths = sorted((source.parent / "tutorials").glob("*.ipynb"))
    for name, notebook in Executed(paths, generated / "executed").items():
        for key, scene in TakeScenes(notebook, name).items():
            _Write(static / "scenes" / f"{key}.js", Script(key, scene))
        _Write(source / "tutorials" / f"{name}.ipynb", nbformat.writes(notebook) + "\n")
    for page in PAGES:
        _Write(source / page, (source.parent / page).read_text())


def setup(app):
    app.add_config_value("webgui_script", "", "env", [str])
    app.connect("config-inited", lambda app, config: _Prepare(app))
    return {"parallel_read_safe": True}
