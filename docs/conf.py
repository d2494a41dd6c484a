"""Configuration of the site: `python -m sphinx -W docs site`."""

import sys
from importlib.util import find_spec
from pathlib import Path

HERE = Path(__file__).parent
sys.path.insert(0, str(HERE / "_ext"))

import ngslac  # noqa: E402

project = "ngslac"
author = "the ngslac developers"
copyright = f"2026, {author}"
release = version = ngslac.__version__

extensions = [
    "myst_nb",
    "sphinx.ext.autodoc",
    "sphinx.ext.napoleon",
    "sphinx-mathjax-offline",
    "sphinx_design",
    "sources",
]
exclude_patterns = ["_ext", "_generated"]

myst_enable_extensions = ["amsmath", "colon_fence", "deflist", "dollarmath"]
myst_heading_anchors = 3
nb_execution_mode = "off"  # the extension `sources` runs them
nb_merge_streams = True  # what is printed in several calls is one text

autodoc_member_order = "bysource"
napoleon_use_rtype = False

html_theme = "furo"
html_title = "ngslac"
html_favicon = "_static/favicon.svg"
html_static_path = ["_static", "_generated/static"]
html_js_files = ["webgui.js", "scenes.js"]
html_css_files = ["scenes.css", "pages.css"]

# The webgui's own script, from the package that brings it to Jupyter.
webgui_script = str(Path(find_spec("webgui_jupyter_widgets").origin).parent / "js" / "webgui.js")


def _EscapeBars(app, what, name, thing, options, lines):
    """|x| is an absolute value in our docstrings, not a substitution."""
    for i, line in enumerate(lines):
        parts = line.split("``")
        parts[::2] = [part.replace("|", r"\|") for part in parts[::2]]
        lines[i] = "``".join(parts)


def _CloseBranches(app, pagename, templatename, context, doctree):
    """The sidebar has all pages, but below the branches that a page is not in: only their heads.

    With all 140 of them in the sidebar of each, these trees were half of the time of a build.
    """
    if whole := context.get("toctree"):
        context["toctree"] = lambda collapse, **options: whole(collapse=True, **options)


def setup(app):
    app.connect("autodoc-process-docstring", _EscapeBars)
    app.connect("html-page-context", _CloseBranches, priority=400)  # before the theme
