"""Input of Kratos for the problems of the comparison: mesh file and parameters; NumPy only.

Kratos' mortar contact knows faces of first order only, and so do these functions.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
from decks import Bodies, Rows
from meshes import BODIES, HELD
from metrics import LINE_FORCE, NU, PRESSURE, YOUNG

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
    faces = mesh.Faces(1, "top")
    one, two = (mesh.points[faces[:, i]] - mesh.points[faces[:, 0]] for i in (1, 2))
    share = -PRESSURE[mesh.problem] * np.linalg.norm(np.cross(one, two), axis=1) / 6
    return np.bincount(faces.ravel(), np.repeat(share, 3), minlength=mesh.nvertices)


def WriteMesh(file, mesh):
    """Write the .mdpa file; numbers start from 1.

    Sub model parts: ``Body_<material>``, ``Contact_slave``, ``Contact_master``, ``Load`` (one
    condition for each loaded node) and ``Held_<boundary>``.
    """
    with Path(file).open("w") as out:
        out.writelines(f"{line}\n" for line in Lines(mesh))


def Lines(mesh):
    points = np.zeros((mesh.nvertices, 3))
    points[:, : mesh.dim] = mesh.Lowered(1)
    for head in ("ModelPartData", "Properties 0", "Properties 1", "Properties 2"):
        yield from Block(head, [])
    yield from Block("Nodes", Rows(range(len(points)), points))
    parts = []
    for number, (name, elements, nodes) in enumerate(Bodies(mesh, 1), 1):
        yield from Entities(f"Elements {ELEMENT[mesh.dim]}", elements, number, nodes)
        parts.append((f"Body_{name}", np.unique(nodes) - 1, elements, []))
    first, loaded = 0, np.flatnonzero(NodalForces(mesh))[:, None]
    faces = [(f"Contact_{name}", FACE, mesh.Faces(1, name)) for name in ("slave", "master")]
    for name, kind, nodes in [*faces, ("Load", LOAD, loaded)]:
        numbers = np.arange(first, first + len(nodes))
        first += len(nodes)
        yield from Entities(f"Conditions {kind[mesh.dim]}", numbers, 0, nodes + 1)
        parts.append((name, np.unique(nodes), [], numbers))
    parts += [(f"Held_{name}", mesh.Nodes(1, name), [], []) for name in HELD[mesh.problem]]
    for part in parts:
        yield from SubModelPart(*part)


def Block(head, lines):
    yield f"Begin {head}"
    yield from lines
    yield f"End {head.split()[0]}"


def Entities(head, numbers, properties, nodes):
    return Block(head, Rows(numbers, np.insert(nodes, 0, properties, axis=1)))


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
    """The parameters of the analysis as a dictionary, for so many equal load steps.

    The .mdpa file is ``job.mdpa``, the materials are in ``job.json``.
    """
    kind = "Frictional" if friction else "Frictionless"
    problem = {"problem_name": "job", "parallel_type": "OpenMP", "echo_level": 0}
    return {
        "problem_data": problem | {"start_time": 0.0, "end_time": 1.0 - 1e-9},
        "solver_settings": Solver(mesh, job, kind, steps, linear_solver),
        "processes": {
            "constraints_process_list": [Support(*held) for held in HELD[mesh.problem].items()],
            "loads_process_list": [],
            "contact_process_list": [Contact(mesh, kind, friction)],
        },
        "output_processes": {},
    }


def Solver(mesh, job, kind, steps, linear_solver):
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
        "residual_relative_tolerance": 1e-8 if mesh.problem == "patch" else 1e-6,
        "residual_absolute_tolerance": 1e-9 if mesh.dim == 2 else 1e-12,
        "max_iteration": MOST_ITERATIONS,
        "time_stepping": {"time_step": 1.0 / steps},
        "buffer_size": 3,
        "linear_solver_settings": {"solver_type": linear_solver},
    }


def Process(module, package, name, **parameters):
    return {
        "python_module": module,
        "kratos_module": "KratosMultiphysics" + package,
        "process_name": name,
        "Parameters": parameters,
    }


def Contact(mesh, kind, friction):
    search = {"search_parameters": {"type_search": "in_radius", "search_factor": 20.0}}
    return Process(
        "alm_contact_process",
        ".ContactStructuralMechanicsApplication",
        "ALMContactProcess",
        model_part_name="Structure",
        assume_master_slave={"0": ["Contact_slave"]},
        contact_model_part={"0": ["Contact_slave", "Contact_master"]},
        contact_type=kind,
        friction_coefficients={"0": friction},
        # With the default only a part of the curved surfaces is found.
        **({} if mesh.problem == "patch" else search),
    )


def Support(name, component):
    """One component of the displacement is zero."""
    return Process(
        "assign_vector_variable_process",
        "",
        "AssignVectorVariableProcess",
        model_part_name=f"Structure.Held_{name}",
        variable_name="DISPLACEMENT",
        constrained=[k == component for k in range(3)],
        value=[0.0 if k == component else None for k in range(3)],
        interval=[0.0, "End"],
    )
