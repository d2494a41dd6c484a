# SPDX-License-Identifier: LGPL-2.1-or-later
"""Builds with the NGSolve that is installed, and writes its version into the dependencies.

A compiled add-on fits exactly one monthly release. Where pip builds in an environment of its own,
that of the environment which the package goes to is taken all the same.
"""

import re
import sysconfig
from importlib.metadata import distributions, version
from pathlib import Path

from scikit_build_core import build
from scikit_build_core.build import *  # noqa: F403  the hooks that stay as they are

# For who has none; and the first one that has all that is needed.
PIN, OLDEST = "6.2.2608", "6.2.2606"


def Installed():
    """The release where the package goes to, or None."""
    folders = list({sysconfig.get_path(name) for name in ("purelib", "platlib")})
    return next((d.version for d in distributions(name="ngsolve", path=folders)), None)


def Numbers(release):
    return [int(part) for part in release.split(".")[:3] if part.isdigit()]


def Missing():
    """Requirements to build with that are not there.

    Raises
    ------
    RuntimeError
        The installed release is too old.
    """
    release = Installed()
    if release and Numbers(release) < Numbers(OLDEST):
        raise RuntimeError(
            f"ngsolve {release} is installed, ngslac needs {OLDEST} or newer: run "
            f"pip install ngsolve=={PIN}"
        )
    return [] if release else [f"ngsolve=={PIN}"]


def get_requires_for_build_wheel(config_settings=None):
    return [*build.get_requires_for_build_wheel(config_settings), *Missing()]


def get_requires_for_build_editable(config_settings=None):
    return [*build.get_requires_for_build_editable(config_settings), *Missing()]


def dynamic_metadata(field, settings, project):
    """A field of pyproject.toml that is known when the package is built."""
    if field == "dependencies":
        return [f"ngsolve=={Installed() or version('ngsolve')}", *settings["others"]]
    return Readme(project["urls"]["Repository"])


# A link or picture in Markdown to a file of the sources.
LINK = re.compile(r"(!?)\[([^][]*)\]\((?!\w+:|#)([^)]*)\)")


def Readme(repository):
    """The README with absolute links, for a package index that lacks the files of the sources."""

    def Absolute(link):
        picture, text, file = link.groups()
        return f"{picture}[{text}]({repository}/{'raw' if picture else 'blob'}/main/{file})"

    text = LINK.sub(Absolute, Path("README.md").read_text(encoding="utf-8"))
    return {"content-type": "text/markdown", "text": text}
