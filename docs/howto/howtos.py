"""Runs the scripts of the how-to pages; writes what they print into the pages, and their pictures.

The pictures of three-dimensional bodies need pyvista. Start it with::

    python docs/howto/howtos.py [page ...]
"""

import os
import re
import sys
import tempfile
from contextlib import redirect_stdout
from io import StringIO
from pathlib import Path

HERE = Path(__file__).parent
SCRIPT = re.compile(r"^```py\n(.*?)^```\n", re.MULTILINE | re.DOTALL)
OUTPUT = re.compile(r"(?<=^```\n)\n```text\n(.*?)^```\n", re.MULTILINE | re.DOTALL)


def Pages():
    """Names of the pages that have a script."""
    return sorted(page.stem for page in HERE.glob("*.md") if SCRIPT.search(page.read_text()))


def Script(page):
    """The only script of a page."""
    (script,) = SCRIPT.findall((HERE / f"{page}.md").read_text())
    return script


def Printed(page):
    """The printed result of the script, as the page shows it."""
    (printed,) = OUTPUT.findall((HERE / f"{page}.md").read_text())
    return printed


def Execute(page):
    """Run the script of a page in the present folder; the names it leaves, and what it prints."""
    names, printed = {"__name__": "__main__"}, StringIO()
    with redirect_stdout(printed):
        exec(compile(Script(page), f"{page}.md", "exec"), names)
    return names, printed.getvalue()


def WriteOutput(page, printed):
    """Put what was printed below the script of the page."""
    path = HERE / f"{page}.md"
    text = OUTPUT.sub("", path.read_text(), count=1)
    end = SCRIPT.search(text).end()
    path.write_text(f"{text[:end]}\n```text\n{printed}```\n{text[end:]}")


def main():
    from howtopictures import Show

    for page in sys.argv[1:] or Pages():
        os.chdir(tempfile.mkdtemp())  # for the files that scripts write
        names, printed = Execute(page)
        WriteOutput(page, printed)
        Show(page, names, HERE / "pictures" / f"{page}.png")
        print(page)


if __name__ == "__main__":
    main()
