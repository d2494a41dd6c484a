"""Patch tests: small strains in 2D and 3D, large strains."""

from __future__ import annotations

import numpy as np
import patch3d
from elasticity import NAMES, Displacements, Material, Pair
from largepatch_problem import MATERIALS, SPRING
from ngsolve import CF
from patch3d_pictures import InterfacePicture
from report_bounds import CONDITION, Rounding
from report_case import Case, Outcome, Row
from report_pictures import Bodies, Figure, Strip
from test_large_patch import CELLS, patch
from test_patch import HELD, LAWS, MESHES, Patch, Stress

from ngslac.meshes import TwoBlocks
from ngslac.meshes.blocks3d import TwoBlocks3D

CONDITION_3D = 1e4  # scaled by the diagonal, of order 3 on split tetrahedra: 9.8e3
CODE_ASTER = "code_aster, test SSNP170 (manual V6.03.170)"


def Solved2D(kind, options, law):
    """A patch test in 2D: the pair, and the largest errors of stress and multipliers."""
    flags, shear, slip = LAWS[law]
    mesh = TwoBlocks(**{"h_slave": 0.25, **options})
    pair = Pair(Displacements(mesh, kind, dirichlet=HELD), Material(), **flags)
    return pair, Patch(pair, options, Stress(options, shear=shear), slip=slip)


def Published():
    """Pressures of the case of code_aster, with order 2 on quadrilaterals."""
    V = Displacements(TwoBlocks(0.25, quads=True), "P2", dirichletx="left.*", dirichlety="bottom")
    pair = Pair(V, Material())
    pair.Load(CF((0.0, -25.0)), "top")
    pair.Solve(tol=1e-13)
    return pair.contact.Table()["pressure"]


def Patch2D(quick):
    kinds = ["P1", "P2"] if quick else NAMES
    meshes = ["flat", "oblique"] if quick else MESHES
    errors = {
        kind: np.array([Solved2D(kind, MESHES[m], law)[1] for m in meshes for law in LAWS])
        for kind in kinds
    }
    rows = []
    for kind, values in errors.items():
        for name, column in zip(("stress", "multipliers"), values.T, strict=True):
            text = f"{NAMES[kind]}: {name}, largest error of {len(values)} problems"
            rows.append(Row(text, column.max(), 0, Rounding()))
    pressure = Published()
    farthest = pressure[np.abs(pressure - 25).argmax()]
    rows.append(
        Row("pressure in the problem of code_aster", farthest, 25, Rounding(kind="relative"))
    )

    def Draw(left, right):
        maxima = {NAMES[k]: v.max(axis=1) for k, v in errors.items()}
        Strip(left, maxima, tolerance=Rounding().size)
        pair, _ = Solved2D("P2", MESHES["oblique"], "slip")
        Bodies(right, pair.mesh, pair.displacement, factor=8, n=4)

    caption = (
        "Left: the errors of all problems. Right: one of them, an oblique interface that slips; "
        "displacements eight times as large."
    )
    return Outcome(rows, Figure(Draw, columns=2), caption)


def Patch3D(quick):
    cases = [patch3d.Case("hex", 1), patch3d.Case("tet", 2, oblique=True)] if quick else None
    rows = patch3d.Run(cases=cases)["cases"]
    shapes = dict.fromkeys(row["name"].split()[1] for row in rows)
    table = []
    for shape in shapes:
        mine = [row for row in rows if row["name"].split()[1] == shape]
        for key in ("stress", "multiplier"):
            worst = max(row[f"{key}_error"] for row in mine)
            text = f"{shape}: {key}, largest error of {len(mine)} cases"
            table.append(Row(text, worst, 0, Rounding(condition=CONDITION_3D)))

    oblique = [patch3d.Case(shape, oblique=True) for shape in shapes]
    caption = "Interfaces of oblique cases: slave faces, master faces, and their segments."
    return Outcome(table, lambda file: InterfacePicture(oblique, file), caption)


def PatchLarge(quick):
    kinds = ["P2"] if quick else list(NAMES)
    cells = CELLS[:1] if quick else CELLS
    rows, last = [], None
    stiff = max(2 * mu + lame for mu, lame in MATERIALS.values())
    condition = CONDITION * max(1.0, SPRING / stiff)
    bounds = {
        "displacement": Rounding(condition=condition),
        "pressure": Rounding(condition=condition, scale=stiff),
        "gap": Rounding(condition=condition),
    }
    for law in ("frictionless", "stick"):
        flat = {kind: patch(law, kind, TwoBlocks, h_slave=0.25) for kind in kinds}
        solid = [
            patch(law, kind, lambda _c=(up, low), _k=kind, **o: Boxes(*_c, _k, **o), dim=3)
            for up, low, kind in cells
        ]
        for dim, problems in (("2D", flat.values()), ("3D", solid)):
            errors = [problem.Errors() for problem in problems]
            for key in ("displacement", "pressure", "gap"):
                text = f"{dim}, {law}: {key}, largest error of {len(errors)} problems"
                worst = max(error[key] for error in errors)
                rows.append(Row(text, worst, 0, bounds[key]))
        last = last or flat["P2"]

    def Draw(left, right):
        Bodies(left, last.mesh, last.gf.components[0], factor=0)
        Bodies(right, last.mesh, last.gf.components[0])
        left.set_title("reference")
        right.set_title("compressed by 30 %, frictionless")

    caption = "The surfaces slide over each other until both blocks are equally wide."
    return Outcome(rows, Figure(Draw, columns=2, sharex=True, sharey=True), caption)


def Boxes(upper, lower, kind, **options):
    n = (2, 1) if kind == "P2" else (4, 3)
    return TwoBlocks3D(upper, lower, *n, **options)


CASES = [
    Case(
        "patch2d",
        "Patch test in 2D",
        "Two blocks with meshes that do not match, under a constant stress with a pressure of 25. "
        "Flat and oblique interfaces, the slave coarse, fine, narrow and wide, triangles and "
        "quadrilaterals, and the laws frictionless, stick, slip to both sides, Tresca and tied. "
        "The exact solution is in the discrete spaces: what is left must be rounding.",
        f"The constant stress; {CODE_ASTER}, modellings a to j.",
        "pytest tests/validation/test_patch.py",
        Patch2D,
    ),
    Case(
        "patch3d",
        "Patch test in 3D",
        "The same in 3D for every combination of element, order and partition of the slave side, "
        "each with a flat interface and an oblique one between different elements, irregular and "
        "rotated. Errors are relative to the largest stress.",
        f"The constant stress; {CODE_ASTER}, modellings k to z.",
        "python tutorials/examples/patch3d.py --out results",
        Patch3D,
    ),
    Case(
        "patch-large",
        "Patch test with large strains",
        "Two neo-Hookean blocks, compressed by 30 % with one deformation gradient in each. "
        "Without friction the stretches along the interface differ, and the surfaces slide over "
        "each other by a tenth of their length; with friction both are stretched and sheared "
        "alike and stick.",
        "The homogeneous deformation, from two equations for the forces on the interface.",
        "pytest tests/validation/test_large_patch.py",
        PatchLarge,
    ),
]
