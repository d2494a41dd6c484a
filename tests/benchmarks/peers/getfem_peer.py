"""GetFEM in the comparison: augmented Lagrangian contact for large sliding, by ray tracing.

    python tests/benchmarks/peers/getfem_peer.py sphere sphere.npz --order 2 --json row.json

The displacements are of the given order, the multipliers (a vector at each corner of the slave
faces) linear. `--augmentation` is the parameter of the augmented Lagrangian times h over Young's
modulus of the softer body. Supports are penalised, GetFEM's way to hold single components.

Debian's package `python3-getfem++` belongs to the system's Python; under another one the script
starts itself again with that.
"""

from __future__ import annotations

import os
import subprocess
import sys

import numpy as np
from meshes import BODIES, HELD, SHIFT
from metrics import LINE_FORCE, NU, PRESSURE, RADIUS, YOUNG, Errors
from peercommand import Main, NotInstalledError

try:
    import getfem
except ModuleNotFoundError:
    getfem = None

__all__ = ["Options", "Solve"]

SYSTEM_PYTHON = "/usr/bin/python3"

RELEASE = {"hertz": 5.0, "sphere": 5.0, "patch": 0.3}  # no contact beyond this distance
SUPPORT = 1e7  # penalty of the supports over Young's modulus of the softer body

# Nodes of a second-order simplex in GetFEM's order: layer by layer, from the corners and mid nodes.
LATTICE = {2: [0, 3, 1, 5, 4, 2], 3: [0, 4, 1, 6, 5, 2, 7, 8, 9, 3]}

HELD_REGION, CONTACT_REGION, LOAD_REGION = 10, 2, 3


def Solve(mesh, arguments, watch):
    """Solve a problem; see `peercommand.Main`."""
    if getfem is None:
        raise NotInstalledError("no module getfem: apt-get install python3-getfem++")
    getfem.util_trace_level(1)
    getfem.util_warning_level(0)
    bodies = [Body(mesh, arguments.order, side) for side in (0, 1)]
    with watch.Running():
        # GetFEM's model does not keep alive what it was made of.
        model, forms, *_kept = Model(mesh, bodies, arguments)
        iterations = Steps(mesh, model, forms, arguments)
    return {
        "version": Version(),
        "dofs": sum(form.nbdof() for form in forms),
        "unknowns": model.nbdof(),
        "iterations": iterations,
        "settings": f"large sliding ALM, r = {arguments.augmentation:g} E/h, "
        f"P{arguments.order}/P1, MUMPS",
        **Errors(
            mesh,
            1,
            lambda: Displacement(mesh, model, forms, arguments.order),
            lambda: Pressure(mesh, bodies[0], model),
        ),
    }


def Version():
    """Version of the package, which the module does not know."""
    query = ["dpkg-query", "--show", "--showformat=${Version}", "python3-getfem"]
    found = subprocess.run(query, capture_output=True, text=True)
    return found.stdout.split("+")[0] if found.returncode == 0 else "unknown"


def Body(mesh, order, side):
    """GetFEM's mesh of a body with its regions: supports, contact, load."""
    name = BODIES[mesh.problem][side]
    geometry = 1 if mesh.problem == "patch" else order  # straight
    nodes = mesh.Elements(geometry, name)
    if geometry == 2:
        nodes = nodes[:, LATTICE[mesh.dim]]
    # Curved slaves start lower by a displacement; on planes a gap makes pairing unambiguous.
    points = (mesh.Lowered(2) if mesh.problem == "patch" else mesh.points)[nodes]
    body = getfem.Mesh("empty", mesh.dim)
    kind = getfem.GeoTrans(f"GT_PK({mesh.dim},{geometry})")
    numbers = body.add_convex(kind, np.ascontiguousarray(points.transpose(2, 1, 0)))
    convex = np.full(len(mesh.elements), -1)
    convex[mesh.materials == name] = numbers
    contact = {("slave", "master")[side]: CONTACT_REGION, "top": LOAD_REGION}
    held = {boundary: HELD_REGION + k for boundary, k in HELD[mesh.problem].items()}
    for boundary, region in (contact | held).items():
        elements, faces = mesh.Opposite(boundary)  # GetFEM's face i is opposite to corner i
        here = convex[elements] >= 0
        if here.any() and not (boundary == "top" and mesh.problem == "hertz"):
            body.set_region(region, np.stack([convex[elements[here]], faces[here]]))
    return body


def Model(mesh, bodies, arguments):
    """GetFEM's model of the problem without hertz' point load, and the displacement spaces."""
    model, dim, names = getfem.Model("real"), mesh.dim, BODIES[mesh.problem]
    softer = min(YOUNG[name] for name in names)
    forms, rules = [], []
    model.add_initialized_data("zero", np.zeros(dim))
    for k in range(dim):
        model.add_initialized_data(f"H{k}", np.diag(np.eye(dim)[k]))
    for side, (body, name) in enumerate(zip(bodies, names, strict=True)):
        form, rule = getfem.MeshFem(body, dim), getfem.MeshIm(body, arguments.intorder)
        form.set_classical_fem(arguments.order)
        model.add_fem_variable(f"u{side}", form)
        young = YOUNG[name]
        model.add_initialized_data(f"lame{side}", young * NU / (1 + NU) / (1 - 2 * NU))
        model.add_initialized_data(f"shear{side}", young / 2 / (1 + NU))
        model.add_isotropic_linearized_elasticity_brick(
            rule, f"u{side}", f"lame{side}", f"shear{side}"
        )
        for k in sorted(set(HELD[mesh.problem].values())):
            if HELD_REGION + k in body.regions():
                model.add_generalized_Dirichlet_condition_with_penalization(
                    rule, f"u{side}", SUPPORT * softer, HELD_REGION + k, "zero", f"H{k}"
                )
        forms.append(form)
        rules.append(rule)
    if mesh.problem != "hertz":
        model.add_initialized_data("pressure", [0.0] * (dim - 1) + [-PRESSURE[mesh.problem]])
        model.add_source_term_brick(rules[0], "u0", "pressure", LOAD_REGION)
    contact = AddContact(mesh, model, bodies[0], forms, rules, arguments, softer)
    return model, forms, rules, contact


def AddContact(mesh, model, slave, forms, rules, arguments, softer):
    """The multipliers, and the contact with or without friction."""
    linear = getfem.MeshFem(slave, mesh.dim)
    linear.set_classical_fem(1)
    multipliers = getfem.MeshFem("partial", linear, linear.basic_dof_on_region(CONTACT_REGION))
    model.add_fem_variable("traction", multipliers)
    model.add_initialized_data("r", arguments.augmentation * softer / mesh.h)
    model.add_initialized_data("friction", arguments.friction)
    previous = []
    if arguments.friction:
        previous = ["previous0", "previous1"]
        for name, form in zip(previous, forms, strict=True):
            model.add_fem_data(name, form)
    brick = model.add_integral_large_sliding_contact_brick_raytracing(
        "r", RELEASE[mesh.problem], "friction" if arguments.friction else "0"
    )
    model.add_slave_contact_boundary_to_large_sliding_contact_brick(
        brick, rules[0], CONTACT_REGION, "u0", "traction", *previous[:1]
    )
    model.add_master_contact_boundary_to_large_sliding_contact_brick(
        brick, rules[1], CONTACT_REGION, "u1", *previous[1:]
    )
    return linear, multipliers


def Steps(mesh, model, forms, arguments):
    """Solve all load steps; returns the number of Newton iterations."""
    start = np.zeros(forms[0].nbdof())
    start[mesh.dim - 1 :: mesh.dim] = -SHIFT[mesh.problem]
    model.set_variable("u0", start)
    force = np.zeros(forms[0].nbdof())
    if mesh.problem == "hertz":
        force[NodeDofs(forms[0], mesh.points[[mesh.load]])[0, 1]] = -LINE_FORCE / 2
        brick = model.add_explicit_rhs("u0", force)
    elif arguments.steps > 1:
        raise ValueError("several load steps are there for hertz only")
    most, iterations = 100, 0
    options = ["max_res", 1e-9 if mesh.problem == "patch" else 1e-7, "max_iter", most]
    options += ["lsearch", "simplest", "alpha min", 0.8, "lsolver", "mumps"]
    for step in range(1, arguments.steps + 1):
        if mesh.problem == "hertz":
            model.set_private_rhs(brick, force * step / arguments.steps)
        used, converged = (int(value) for value in model.solve(*options)[:2])
        if not converged:
            raise RuntimeError(f"no convergence in step {step} after {used} iterations")
        iterations += used
        if arguments.friction:
            for side in (0, 1):
                model.set_variable(f"previous{side}", model.variable(f"u{side}"))
    return iterations


# ---------------------------------------------------------------- results


def NodeDofs(form, wanted):
    """The dofs (n, dim) of a vector-valued Lagrange space at the points `wanted`."""
    dim = wanted.shape[1]
    places = form.basic_dof_nodes()[:, ::dim].T
    found = {tuple(row): i for i, row in enumerate(np.round(places, 6).tolist())}
    first = [found[tuple(row)] for row in np.round(wanted, 6).tolist()]
    return np.array(first)[:, None] * dim + np.arange(dim)


def Displacement(mesh, model, forms, order):
    """At the nodes, from where the upper body was not lowered yet."""
    points = mesh.Lowered(order)
    values = points - mesh.Points(order)
    for side, form in enumerate(forms):
        nodes = mesh.MaterialNodes(order, BODIES["patch"][side])
        values[nodes] += model.variable(f"u{side}")[NodeDofs(form, points[nodes])]
    return values


def Pressure(mesh, body, model):
    """At all nodes; the multipliers are linear."""
    slave, linear = mesh.Nodes(1, "slave"), getfem.MeshFem(body, mesh.dim)
    linear.set_classical_fem(1)
    traction, pressure = np.zeros(linear.nbdof()), np.zeros(len(mesh.points))
    traction[linear.basic_dof_on_region(CONTACT_REGION)] = model.variable("traction")
    normal = (mesh.points[slave] - np.append(np.zeros(mesh.dim - 1), RADIUS)) / RADIUS
    pressure[slave] = -(traction[NodeDofs(linear, mesh.points[slave])] * normal).sum(axis=1)
    return pressure


def Options(parser):
    parser.add_argument("--augmentation", type=float, default=1.0, help="over E/h")
    parser.add_argument("--intorder", type=int, default=6, help="order of integration")


def SystemPythonHasIt():
    """Whether the system's Python can import GetFEM."""
    command = [SYSTEM_PYTHON, "-E", "-c", "import getfem"]
    try:
        return subprocess.run(command, capture_output=True).returncode == 0
    except FileNotFoundError:
        return False


if __name__ == "__main__":
    if getfem is None and SystemPythonHasIt():
        os.execv(SYSTEM_PYTHON, [SYSTEM_PYTHON, "-E", *sys.argv])
    sys.exit(Main(Solve, peer="GetFEM", options=Options))
