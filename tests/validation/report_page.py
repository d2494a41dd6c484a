"""The pages of the validation report, as MyST markdown, and their pictures."""

from __future__ import annotations

import os
import platform
import re
import time
import traceback
from contextlib import redirect_stdout
from dataclasses import dataclass
from importlib.metadata import version
from pathlib import Path

from report_bounds import ORIGINS
from report_case import Outcome, Worst

from ngslac.linear.factor import LU

__all__ = ["CasePage", "Compute", "Page", "Shrink", "Versions"]

HEAD = """# Validation

What `ngslac` computes, beside what others computed, published or proved. This page and those of
the cases are written by

```bash
{command}
```

with {versions}.

Numbers and pictures come from that run. `--cases NAME ... --out FOLDER` computes some of the cases,
`--quick` small ones. The pytest commands need the package's extra `test`.

A row holds if the difference is within what is accepted: relative to the reference in percent, or
absolute. No bound was made from the difference that it judges; each row names the origin of its
own:

{origins}

Where no such source is at hand, the number stands without a bound ("not judged"), and without a
verdict. The summary shows one row of each case, the one nearest to its bound.
"""


@dataclass(frozen=True)
class Result:
    """A case, and its outcome or the error that it ended with."""

    case: object
    outcome: Outcome | None
    error: str
    seconds: float

    @property
    def holds(self):
        return self.outcome is not None and all(row.holds for row in self.outcome.rows)


def Compute(case, quick, folder):
    """Compute a case and draw its picture to ``folder/pictures``; errors become part of it."""
    start = time.process_time()
    outcome, error = None, ""
    file = Path(folder) / "pictures" / f"{case.name}.png"
    file.parent.mkdir(parents=True, exist_ok=True)
    try:
        with open(os.devnull, "w") as nowhere, redirect_stdout(nowhere):  # examples print
            outcome = case.function(quick)
            outcome.picture(file)
        Shrink(file)
    except Exception as failure:
        traceback.print_exc()
        outcome, error = None, f"{type(failure).__name__}: {failure}"
    return Result(case, outcome, error, time.process_time() - start)


def Shrink(file, *, width=1100, colours=96):
    """Few colours and pixels: the pictures are part of the repository."""
    from PIL import Image

    picture = Image.open(file).convert("RGB")
    if picture.width > width:
        size = width, round(picture.height * width / picture.width)
        picture = picture.resize(size, Image.Resampling.LANCZOS)
    picture.quantize(colours, dither=Image.Dither.NONE).save(file, optimize=True)


def Versions():
    """Of everything that numbers may depend on."""
    project = (Path(__file__).parents[2] / "pyproject.toml").read_text()
    ours = re.search(r'^version = "(.*)"', project, re.MULTILINE)[1]
    parts = [f"ngslac {ours}"]
    parts += [f"{name} {version(name)}" for name in ("ngsolve", "numpy", "scipy")]
    return ", ".join(parts) + f", Python {platform.python_version()}, the direct solver {LU()}"


def Page(results, command):
    """The summary as markdown text."""
    origins = "\n".join(f"- *{name}*: {text};" for name, text in ORIGINS.items())
    head = HEAD.format(command=command, versions=Versions(), origins=f"{origins[:-1]}.")
    parts = [head, "## Summary\n"]
    rows = [_SummaryRow(result) for result in results]
    head = ("case", "row nearest to its bound", "difference", "accepted", "")
    parts += [_Table(head, rows, "llrrl"), ""]
    count = sum(result.holds for result in results)
    numbers = [row.judged for result in results if result.outcome for row in result.outcome.rows]
    parts.append(
        f"{count} of {len(results)} cases hold. Of {len(numbers)} numbers {sum(numbers)} are "
        "judged by a bound.\n"
    )
    names = [result.case.name for result in results]
    return "\n".join([*parts, "```{toctree}", ":hidden:", "", *names, "```", ""])


def _SummaryRow(result):
    link = f"[{result.case.title}]({result.case.name}.md)"
    if result.outcome is None:
        return [link, result.error.splitlines()[0], "-", "-", "**failed**"]
    quantity, _, _, difference, accepted, _ = Worst(result.outcome.rows).Cells()
    state = "holds" if result.holds else "**does not hold**"
    judged = any(row.judged for row in result.outcome.rows)
    return [link, quantity, difference, accepted, state if judged else "not judged"]


def CasePage(result):
    """A case as markdown text."""
    case = result.case
    parts = [f"# {case.title}\n", case.text.strip(), ""]
    parts += [f"Reference: {case.source.strip()}\n", f"```bash\n{case.command}\n```\n"]
    if result.outcome is None:
        return "\n".join([*parts, f"**Failed**: {result.error}\n"])
    head = ("quantity", "ours", "reference", "difference", "accepted", "where it comes from")
    parts.append(_Table(head, [row.Cells() for row in result.outcome.rows], "lrrrrl"))
    picture = f"![{case.title}](pictures/{case.name}.png)"
    return "\n".join([*parts, "", picture, "", f"*{result.outcome.caption}*\n"])


def _Table(head, rows, alignment):
    lines = [head, [{"l": "---", "r": "--:"}[letter] for letter in alignment], *rows]
    return "\n".join("| " + " | ".join(str(c).replace("|", "\\|") for c in r) + " |" for r in lines)
