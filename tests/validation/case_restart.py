"""Saved states, continued in another process."""

from __future__ import annotations

import subprocess
import sys
import tempfile
from pathlib import Path

import continued
import numpy as np
from report_bounds import Exact, Rounding
from report_case import Case, Outcome, Row
from report_pictures import BLUE, ORANGE, Figure

from ngslac import SaveState


def Restart(quick):
    rows, curves = [], {}
    kinds = ["linear"] if quick else list(continued.MAKE)
    with tempfile.TemporaryDirectory() as folder:
        steppers = {kind: continued.half(continued.MAKE[kind](), 1) for kind in continued.MAKE}
        for kind, stepper in steppers.items():
            SaveState(Path(folder) / kind, stepper)
        ends = {kind: continued.outcome(continued.half(s, 2)) for kind, s in steppers.items()}
        subprocess.run(
            [sys.executable, continued.__file__, folder],
            check=True,
            cwd=Path(continued.__file__).parent,
        )
        for kind in kinds:
            with np.load(Path(folder) / f"{kind}.npz") as found:
                worst = max(
                    float(np.abs(np.subtract(found[name], value, dtype=float)).max(initial=0))
                    for name, value in ends[kind].items()
                )
                curves[kind] = ends[kind]["pressure"], found["pressure"]
            accepted = Rounding() if kind == "bouncing" else Exact()
            text = f"{kind}: largest difference of {len(ends[kind])} arrays of end values"
            rows.append(Row(text, worst, 0, accepted))

    def Draw(ax):
        for k, both in enumerate(curves.values()):
            for style, values in zip("ox", both, strict=True):
                colour = ORANGE if style == "x" else BLUE
                ax.plot(k + np.linspace(-0.3, 0.3, len(values)), values, style, color=colour)
        ax.set_xticks(range(len(curves)), curves)
        ax.set_ylabel("pressure of the macro-elements")

    caption = "End pressures without interruption (circles) and saved and continued (crosses)."
    return Outcome(rows, Figure(Draw, size=(6, 3.2)), caption)


CASES = [
    Case(
        "restart",
        "Saved and continued",
        "Five computations (a load path with friction, the same with a linear bulk, with large "
        "sliding, with self-contact, and a block in flight) are saved half way and continued in "
        "another process. The end values agree to the last bit; for the flight to rounding, since "
        "the last digits of dense products depend on where arrays lie in memory.",
        "The computations without interruption.",
        "pytest tests/validation/test_cases.py -k restart",
        Restart,
    ),
]
