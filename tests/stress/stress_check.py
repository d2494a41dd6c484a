"""Is a state that the solver calls converged an answer? Nothing of the solver is used here."""

import numpy as np
from ngsolve import CF, Det, Grad, GridFunction, Id, IntegrationRule, x, y
from ngsolve.fem import SEGM
from shapely import Point, Polygon

__all__ = ["Check", "CheckEnd", "WrongAnswerError"]

TOLERANCE = 1e-6  # of forces, relative to the largest; of gaps and slips, relative to the size


class WrongAnswerError(AssertionError):
    """A state was returned as converged that is no solution."""


def Require(value, bound, what):
    if not value <= bound:
        raise WrongAnswerError(f"{what}: {value:.2e} > {bound:.1e}")


def Check(problem):
    """Conditions of contact, friction and equilibrium of the state committed last."""
    for contact, law in zip(problem.contacts, problem.laws, strict=True):
        if not law.get("tied"):
            CheckContact(problem, contact)
    CheckEquilibrium(problem)
    CheckBodies(problem)


def CheckContact(problem, contact):
    table = contact.Table()
    paired = table["area"] > 0
    size = table["fullarea"] ** (1 / (problem.mesh.dim - 1))
    d = problem.mesh.dim
    traction = problem.gf.vec.FV().NumPy()[contact.form.MultiplierDofs()].reshape(-1, d)
    # Where nothing presses there is rounding only.
    noise = 1e-8 * max(problem.young.values())
    largest = problem.largest = max(problem.largest, np.abs(traction).max(initial=0.0), noise)
    traction = traction / largest
    Require(np.abs(traction[~paired]).max(initial=0), TOLERANCE, "traction without partner")
    normal, gap, slip = (table[k][paired] for k in ("normal", "gap", "slip"))
    gap, slip = gap / size[paired], slip / size[paired, None]
    traction = traction[paired]
    pressure = -np.sum(traction * normal, axis=1)
    shear = traction + pressure[:, None] * normal
    Require(-pressure.min(), TOLERANCE, "tension")
    Require(-gap.min(), TOLERANCE, "penetration")
    Require(np.minimum(pressure, gap).max(), TOLERANCE, "pressure across a gap")
    bound = np.maximum(table["friction"][paired], 0) * np.maximum(pressure, 0)
    Require((np.linalg.norm(shear, axis=1) - bound).max(), TOLERANCE, "friction beyond its limit")
    # Coulomb's law as a projection; any scale of the slip will do.
    trial = shear - slip / max(np.abs(slip).max(), TOLERANCE)
    length = np.linalg.norm(trial, axis=1)
    projected = trial * np.minimum(1, bound / np.maximum(length, 1e-300))[:, None]
    closed = pressure > TOLERANCE
    error = np.linalg.norm(projected - shear, axis=1)[closed]
    Require(error.max(initial=0), 10 * TOLERANCE, "slip and friction do not match")
    Require(np.abs(np.sum(slip * normal, axis=1)).max(), TOLERANCE, "slip along the normal")


def CheckEquilibrium(problem):
    gf = problem.gf
    residual = gf.vec.CreateVector()
    problem.a.Apply(gf.vec, residual)
    bulk = residual.FV().NumPy().copy()
    count = problem.X.components[0].ndof
    total = bulk[:count].copy()
    # Bodies that move without contact feel rounding only.
    work = max(problem.work, np.abs(bulk[:count]).max(), Noise(problem))
    for number, (contact, (_, other)) in enumerate(
        zip(problem.contacts, problem.pairs, strict=True)
    ):
        force = Forces(problem, contact, problem.laws[number])[:count]
        total += force
        work = max(work, np.abs(force).max())
        resultant = [motion @ force for motion in Translations(problem)]
        if isinstance(other, str):
            Require(np.abs(resultant).max() / work, TOLERANCE, "both sides feel different forces")
    problem.work = work
    free = np.array([bool(b) for b in problem.X.components[0].FreeDofs()])
    Require(np.abs(total[free]).max() / work, TOLERANCE, "equilibrium")


def Noise(problem):
    """Forces far below it are rounding."""
    return 1e-8 * max(problem.young.values()) * problem.extent ** (problem.mesh.dim - 1)


def Forces(problem, contact, law):
    """What contact does to the dofs: the tractions times the operators D and M."""
    if law.get("finite"):  # the direction of the pressure varies within a macro-element
        force = problem.gf.vec.CreateVector()
        contact.Apply(problem.gf.vec, force)
        return force.FV().NumPy()
    traction = problem.gf.vec.FV().NumPy()[contact.form.MultiplierDofs()]
    slave, master = (Transposed(operator, traction) for operator in contact.Mortar())
    return master - slave


def Transposed(operator, values):
    transposed = operator.CreateTranspose()
    vec, product = transposed.CreateRowVector(), transposed.CreateColVector()
    vec.FV().NumPy()[:] = values
    product.data = transposed * vec
    return product.FV().NumPy().copy()


def Translations(problem):
    """Unit motions of everything, as scalar values of the displacement."""
    field = GridFunction(problem.X.components[0])
    for direction in np.eye(problem.mesh.dim):
        field.Set(CF(tuple(direction)))
        yield field.vec.FV().NumPy().copy()


# --- geometry ---------------------------------------------------------------------------------


def CheckBodies(problem):
    """No element is turned inside out, no body folded, none in another one."""
    if problem.nonlinear:
        F = Id(problem.mesh.dim) + Grad(problem.gf.components[0])
        points = problem.mesh.MapToAllElements(
            {kind: IntegrationRule(kind, 3) for kind in Kinds(problem.mesh)},
            problem.mesh.Materials(".*"),
        )
        Require(-np.min(Det(F)(points)), 0, "an element is turned inside out")
    if problem.mesh.dim == 2 and problem.outlines:
        CheckOutlines(problem)


def Kinds(mesh):
    return {e.type for e in mesh.Elements()}


def Outline(problem, region, positions):
    """Deformed positions (edges, positions, 2) along boundary edges, in their order."""
    rule = IntegrationRule([(1 - p,) for p in positions], [1.0] * len(positions))
    points = problem.mesh.MapToAllElements({SEGM: rule}, problem.mesh.Boundaries(region))
    values = (CF((x, y)) + problem.gf.components[0])(points)
    return values.reshape(-1, len(positions), 2)


def CheckOutlines(problem):
    """On average over a slave edge there is no penetration, and nowhere much of it."""
    middles = [(k + 0.5) / 8 for k in range(8)]
    for slave, master in problem.pairs:
        if not isinstance(master, str):
            continue
        name = master.split("|")[0].rsplit("_", 1)[0]
        body = Polygon(Outline(problem, f"{name}_.*", [0.0, 0.25, 0.5, 0.75]).reshape(-1, 2))
        if not body.is_valid:
            raise WrongAnswerError(f"body {name} is folded")
        edges = Outline(problem, slave, middles)
        size = 8 / 7 * np.linalg.norm(edges[:, -1] - edges[:, 0], axis=1)
        points = [[Point(p) for p in edge] for edge in edges]
        depth = np.array(
            [[body.exterior.distance(p) if body.contains(p) else 0 for p in e] for e in points]
        )
        gap = np.array([[body.distance(p) for p in e] for e in points])
        Require(((depth - gap).mean(axis=1) / size).max(), 0.05, f"{slave} lies inside of {name}")
        Require((depth / size[:, None]).max(), 0.35, f"{slave} cuts into {name}")


def CheckEnd(problem):
    """The load has been reached, and an exact solution if there is one."""
    Require(abs(problem.load.Get() - problem.path[-1][0]), 1e-12, "the load was not reached")
    if problem.exact:
        problem.exact(problem)
