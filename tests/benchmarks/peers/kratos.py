"""Kratos Multiphysics in the comparison: dual mortar contact by augmented Lagrange multipliers.

    python tests/benchmarks/peers/kratos.py sphere sphere.npz --order 1 --json row.json

First order only: the mortar conditions know straight edges and flat triangles. The time contains
that of reading the mesh file. Needs the packages of PyPI that `INSTALL` names; if another Python
has them, name it by the environment variable KRATOS_PYTHON.
"""

from __future__ import annotations

import json
import os
import sys
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
from kratos_files import Materials, NodalForces, Parameters, WriteMesh
from metrics import Errors
from peercommand import Main, NotInstalledError

try:
    import KratosMultiphysics as Kratos
    from KratosMultiphysics import ContactStructuralMechanicsApplication as ContactApplication
    from KratosMultiphysics import LinearSolversApplication  # noqa: F401 (registers sparse_lu)
    from KratosMultiphysics import StructuralMechanicsApplication as StructuralApplication
    from KratosMultiphysics.ContactStructuralMechanicsApplication import (
        contact_structural_mechanics_static_solver as static_solver,
    )
    from KratosMultiphysics.StructuralMechanicsApplication.structural_mechanics_analysis import (
        StructuralMechanicsAnalysis,
    )
except ModuleNotFoundError as error:
    MISSING = error
    StructuralMechanicsAnalysis = object
else:
    MISSING = None

__all__ = ["Options", "Solve"]

APPLICATIONS = ("StructuralMechanics", "ContactStructuralMechanics", "LinearSolvers")
INSTALL = " ".join(["KratosMultiphysics", *(f"Kratos{name}Application" for name in APPLICATIONS)])


def Solve(mesh, arguments, watch):
    """Solve a problem; see `peercommand.Main`."""
    if MISSING:
        raise NotInstalledError(f"{MISSING}: pip install {INSTALL}")
    if arguments.order != 1:
        raise ValueError("Kratos' mortar contact has no faces of second order: use --order 1")
    Kratos.Logger.GetDefaultOutput().SetSeverity(Kratos.Logger.Severity.WARNING)
    default = "amgcl" if mesh.dim == 3 else "LinearSolversApplication.sparse_lu"
    linear_solver = arguments.linear_solver or default
    options = {"steps": arguments.steps, "linear_solver": linear_solver}
    with TemporaryDirectory() as folder:
        job = Path(folder) / "job"
        WriteMesh(job.with_suffix(".mdpa"), mesh)
        job.with_suffix(".json").write_text(json.dumps(Materials(mesh, arguments.friction)))
        parameters = Parameters(mesh, job, friction=arguments.friction, **options)
        with watch.Running():
            analysis = Analysis(Kratos.Model(), Kratos.Parameters(json.dumps(parameters)))
            iterations = analysis.Solve(NodalForces(mesh))
    return {
        "version": Kratos.KratosGlobals.Kernel.Version().replace('"', "").split("-")[0],
        "dofs": mesh.Points(1).size,
        "iterations": iterations,
        "settings": f"dual mortar ALM, {linear_solver.split('.')[-1]}",
        **Errors(
            mesh,
            1,
            lambda: Displacement(mesh, analysis.model),
            lambda: Pressure(mesh, analysis.model),
        ),
    }


class Analysis(StructuralMechanicsAnalysis):
    """Kratos' analysis with contact and nodal forces, which looks whether it converged."""

    def _CreateSolver(self):
        return static_solver.CreateSolver(self.model, self.project_parameters["solver_settings"])

    def Solve(self, forces):
        """Run all steps with vertical forces at the nodes; returns the number of iterations."""
        self.Initialize()
        solver, iterations, step = self._GetSolver(), 0, 0
        solid = self.project_parameters["solver_settings"]["domain_size"].GetInt() == 3
        while self.KeepAdvancingSolutionLoop():
            step += 1
            self.time = self._AdvanceTime()
            for condition in self.model["Structure.Load"].Conditions:
                force = min(1.0, self.time) * float(forces[condition.GetNodes()[0].Id - 1])
                vector = Kratos.Array3([0.0, 0.0, force] if solid else [0.0, force, 0.0])
                condition.SetValue(StructuralApplication.POINT_LOAD, vector)
            self.InitializeSolutionStep()
            solver.Predict()
            converged = solver.SolveSolutionStep()
            self.FinalizeSolutionStep()
            used = int(solver.GetComputingModelPart().ProcessInfo[Kratos.NL_ITERATION_NUMBER])
            iterations += used
            if not converged:
                raise RuntimeError(f"no convergence in step {step} after {used} iterations")
        self.Finalize()
        return iterations


def Displacement(mesh, model):
    """At the corners, from where the upper body was not lowered yet."""
    values = np.zeros((mesh.nvertices, 3))
    for node in model["Structure"].Nodes:
        if node.Id <= mesh.nvertices:
            values[node.Id - 1] = list(node.GetSolutionStepValue(Kratos.DISPLACEMENT))
    return values + mesh.Lowered(1) - mesh.Points(1)


def Pressure(mesh, model):
    """At all nodes."""
    pressure = np.zeros(len(mesh.points))
    for node in model["Structure.Contact_slave"].Nodes:
        if node.Is(Kratos.ACTIVE):
            value = node.GetValue(ContactApplication.AUGMENTED_NORMAL_CONTACT_PRESSURE)
            pressure[node.Id - 1] = -value
    if not np.all(np.isfinite(pressure)):
        raise RuntimeError("the pressures are not finite")
    return pressure


def Options(parser):
    text = "Kratos' name; default: amgcl in 3D, sparse_lu in 2D"
    parser.add_argument("--linear-solver", help=text)


if __name__ == "__main__":
    if MISSING and (python := os.environ.pop("KRATOS_PYTHON", None)):
        os.execv(python, [python, *sys.argv])
    code = Main(Solve, peer="Kratos", options=Options)
    sys.stdout.flush()
    os._exit(code)  # without the lines that Kratos prints when it is unloaded
