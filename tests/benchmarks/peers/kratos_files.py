"""Input of Kratos for the problems of the comparison: mesh file and parameters; NumPy only.

Kratos' mortar contact knows faces of first order only, and so do these functions.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
from boundary import BODIES, Lowered, PressureForces
from meshes import HELD
from metrics import LINE_FORCE, NU, PATCH_PRESSURE, SPHERE_LOAD, YOUNG

__all__ = ["Materials", "NodalForces", "Parameters", "WriteMesh"]

ELEMENT = {2: "SmallDisplacementElement2D3N", 3: "SmallDisplacementElement3D4N"}
FACE = {2: "LineCondition2D2N", 3: "SurfaceCondition3D3N"}
LOAD = {2: "PointLoadCondition2D1N", 3: "PointLoadCondition3D1N"}
LAW = {2: "LinearElasticPlaneStrain2DLaw", 3: "LinearElastic3DLaw"}
MOST_ITERATIONS = 40


def NodalForces(mesh):
    """Vertical forces (n,) at the corners of the mesh: the whole load."""
    if mesh.problem == "hertz":
        forces = np.zeros(mesh.nvertices)
        forces[mesh.load] = -LINE_FORCE / 2
        return forces
    return PressureForces(mesh, "top", SPHERE_LOAD if mesh.problem == "sphere" else PATCH_PRESSURE)


def WriteMesh(file, mesh):
    """Write the .mdpa file.

    Parameters
    ----------
    file : str or Path
    mesh : PeerMesh

    Notes
    -----
    Sub model parts: ``Body_<material>``, ``Contact_slave``, ``Contact_master``, ``Load`` (one
    condition for each loaded node) and ``Held_<boundary>``. Numbers start from 1.
    """
    with Path(file).open("w") as out:
        out.writelines(f"{line}\n" for line in Lines(mesh))


def Lines(mesh):
    """The lines of the .mdpa file."""
    points = np.zeros((mesh.nvertices, 3))
    points[:, : mesh.dim] = Lowered(mesh, 1)
    yield from Block("ModelPartData", [])
    for number in (0, 1, 2):
        yield from Block(f"Properties {number}", [])
    yield from Block("Nodes", Rows(np.arange(len(points)), points))
    parts = []
    for number, name in enumerate(BODIES[mesh.problem], 1):
        elements = np.flatnonzero(mesh.materials == name)
        nodes = mesh.Elements(1, name) + 1
        rows = Rows(elements, np.column_stack([np.full(len(nodes), number), nodes]))
        yield from Block(f"Elements {ELEMENT[mesh.dim]}", rows)
        parts.append((f"Body_{name}", mesh.MaterialNodes(1, name), elements, []))
    loaded = np.flatnonzero(NodalForces(mesh))
    conditions = [
        ("Contact_slave", FACE, mesh.Faces(1, "slave")),
        ("Contact_master", FACE, mesh.Faces(1, "master")),
        ("Load", LOAD, loaded[:, None]),
    ]
    first = 0
    for name, kind, nodes in conditions:
        numbers = np.arange(first, first + len(nodes))
        first += len(nodes)
        rows = Rows(numbers, np.column_stack([np.zeros(len(nodes), dtype=int), nodes + 1]))
        yield from Block(f"Conditions {kind[mesh.dim]}", rows)
        parts.append((name, np.unique(nodes), [], numbers))
    parts += [(f"Held_{name}", mesh.Nodes(1, name), [], []) for name in HELD[mesh.problem]]
    for part in parts:
        yield from SubModelPart(*part)


def Block(head, lines):
    """A block of an .mdpa file."""
    yield f"Begin {head}"
    yield from lines
    yield f"End {head.split()[0]}"


def Rows(numbers, values):
    """A line with a number (from 0) and its values for each entry."""
    for number, row in zip(np.asarray(numbers).tolist(), values.tolist(), strict=True):
        yield " ".join([str(number + 1), *(repr(value) for value in row)])


def SubModelPart(name, nodes, elements, conditions):
    """A sub model part with numbers from 0."""
    yield f"Begin SubModelPart {name}"
    for kind, numbers in (("Nodes", nodes), ("Elements", elements), ("Conditions", conditions)):
        yield from Block(f"SubModelPart{kind}", (str(number + 1) for number in numbers))
    yield "End SubModelPart"


def Materials(mesh, friction):
    """The materials as a dictionary (Kratos reads them from a JSON file)."""
    constants = {"POISSON_RATIO": NU, "DENSITY": 1.0, "FRICTION_COEFFICIENT": friction}
    if mesh.dim == 2:
        constants["THICKNESS"] = 1.0
    properties = [
        {
            "model_part_name": f"Structure.Body_{name}",
            "properties_id": number,
            "Material": {
                "constitutive_law": {"name": LAW[mesh.dim]},
                "Variables": {"YOUNG_MODULUS": YOUNG[name], **constants},
                "Tables": {},
            },
        }
        for number, name in enumerate(BODIES[mesh.problem], 1)
    ]
    return {"properties": properties}


def Parameters(mesh, job, *, friction=0.0, steps=1, linear_solver="amgcl"):
    """The parameters of the analysis as a dictionary.

    Parameters
    ----------
    mesh : PeerMesh
    job : Path
        The .mdpa file is ``job.mdpa``, the materials are in ``job.json``.
    friction : float
    steps : int
        Number of equal load steps.
    linear_solver : str

    Returns
    -------
    dict
    """
    kind = "Frictional" if friction else "Frictionless"
    processes = {
        "constraints_process_list": [Held(*held) for held in HELD[mesh.problem].items()],
        "loads_process_list": [],
        "contact_process_list": [Contact(mesh, kind, friction)],
    }
    return {
        "problem_data": {
            "problem_name": "job",
            "parallel_type": "OpenMP",
            "start_time": 0.0,
            "end_time": 1.0 - 1e-9,
            "echo_level": 0,
        },
        "solver_settings": Solver(mesh, job, kind, steps, linear_solver),
        "processes": processes,
        "output_processes": {},
    }


def Solver(mesh, job, kind, steps, linear_solver):
    """The settings of the solver."""
    patch = mesh.problem == "patch"
    return {
        "solver_type": "Static",
        "model_part_name": "Structure",
        "domain_size": mesh.dim,
        "echo_level": 0,
        "analysis_type": "non_linear",
        "model_import_settings": {"input_type": "mdpa", "input_filename": str(job)},
        "material_import_settings": {"materials_filename": f"{job}.json"},
        "contact_settings": {"mortar_type": f"ALMContact{kind}"},
        "convergence_criterion": "contact_residual_criterion",
        "residual_relative_tolerance": 1e-8 if patch else 1e-6,
        "residual_absolute_tolerance": 1e-9 if mesh.dim == 2 else 1e-12,
        "max_iteration": MOST_ITERATIONS,
        "time_stepping": {"time_step": 1.0 / steps},
        "buffer_size": 3,
        "linear_solver_settings": {"solver_type": linear_solver},
    }


def Contact(mesh, kind, friction):
    """The contact."""
    parameters = {
        "model_part_name": "Structure",
        "assume_master_slave": {"0": ["Contact_slave"]},
        "contact_model_part": {"0": ["Contact_slave", "Contact_master"]},
        "contact_type": kind,
        "friction_coefficients": {"0": friction},
    }
    if mesh.problem != "patch":  # with the default only a part of the curved surfaces is found
        parameters["search_parameters"] = {"type_search": "in_radius", "search_factor": 20.0}
    return {
        "python_module": "alm_contact_process",
        "kratos_module": "KratosMultiphysics.ContactStructuralMechanicsApplication",
        "process_name": "ALMContactProcess",
        "Parameters": parameters,
    }


def Held(name, component):
    """A support: one component of the displacement is zero."""
    return {
        "python_module": "assign_vector_variable_process",
        "kratos_module": "KratosMultiphysics",
        "process_name": "AssignVectorVariableProcess",
        "Parameters": {
            "model_part_name": f"Structure.Held_{name}",
            "variable_name": "DISPLACEMENT",
            "constrained": [k == component for k in range(3)],
            "value": [0.0 if k == component else None for k in range(3)],
            "interval": [0.0, "End"],
        },
    }
