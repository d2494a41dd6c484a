"""Is a state that the solver calls converged an answer? Nothing of the solver is used here."""

import numpy as np
import shapely
from ngsolve import CF, GridFunction, IntegrationRule, x, y
from ngsolve.fem import SEGM

TOLERANCE = 1e-6  # of forces, relative to the largest; of gaps and slips, relative to the size


class WrongAnswerError(AssertionError):
    """A state was returned as converged that is no solution."""


def Require(value, bound, what):
    if not value <= bound:
        raise WrongAnswerError(f"{what}: {value:.2e} > {bound:.1e}")


def Check(problem):
    """Conditions of contact, friction and equilibrium of the state committed last."""
    for contact, law in zip(problem.contacts, problem.laws, strict=True):
        if not (law.get("tied") or "law" in law):
            CheckContact(problem, contact)
    CheckEquilibrium(problem)
    if problem.heat:
        CheckHeat(problem)
    overlaps = problem.twin and not problem.twin.friction  # is a surface no longer where it was?
    if problem.mesh.dim == 2 and not overlaps:
        CheckOutlines(problem)


def CheckContact(problem, contact):
    table = contact.Table()
    paired, d = table["area"] > 0, problem.mesh.dim
    size = table["fullarea"] ** (1 / (d - 1))
    traction = problem.gf.vec.FV().NumPy()[contact.form.MultiplierDofs()].reshape(-1, d)
    # Where nothing presses there is rounding only.
    noise = 1e-8 * max(problem.young.values())
    largest = problem.largest = max(problem.largest, np.abs(traction).max(initial=0.0), noise)
    traction = traction / largest
    Require(np.abs(traction[~paired]).max(initial=0), TOLERANCE, "traction without partner")
    normal, gap, slip = (table[k][paired] for k in ("normal", "gap", "slip"))
    gap, slip, traction = gap / size[paired], slip / size[paired, None], traction[paired]
    pressure = -np.sum(traction * normal, axis=1)
    shear = traction + pressure[:, None] * normal
    Require(-pressure.min(initial=0), TOLERANCE, "tension")
    Require(-gap.min(initial=0), TOLERANCE, "penetration")
    Require(np.minimum(pressure, gap).max(initial=0), TOLERANCE, "pressure across a gap")
    bound = np.maximum(table["friction"][paired], 0) * np.maximum(pressure, 0)
    Require(
        (np.linalg.norm(shear, axis=1) - bound).max(initial=0),
        TOLERANCE,
        "friction beyond its limit",
    )
    # Coulomb's law as a projection; any scale of the slip will do.
    trial = shear - slip / max(np.abs(slip).max(initial=0), TOLERANCE)
    length = np.linalg.norm(trial, axis=1)
    projected = trial * np.minimum(1, bound / np.maximum(length, 1e-300))[:, None]
    error = np.linalg.norm(projected - shear, axis=1)[pressure > TOLERANCE]
    Require(error.max(initial=0), 10 * TOLERANCE, "slip and friction do not match")
    Require(
        np.abs(np.sum(slip * normal, axis=1)).max(initial=0), TOLERANCE, "slip along the normal"
    )


def CheckEquilibrium(problem):
    gf, space = problem.gf, problem.X.components[0]
    residual = gf.vec.CreateVector()
    problem.a.Apply(gf.vec, residual)
    total = residual.FV().NumPy()[: space.ndof].copy()
    # Bodies that move without contact feel rounding only.
    noise = 1e-8 * max(problem.young.values()) * problem.extent ** (problem.mesh.dim - 1)
    work = max(problem.work, np.abs(total).max(), noise)
    for contact, law, (_, other) in zip(problem.contacts, problem.laws, problem.pairs, strict=True):
        force = Forces(problem, contact, law)[: space.ndof]
        total += force
        work = max(work, np.abs(force).max())
        resultant = [motion @ force for motion in Translations(space)]
        if isinstance(other, str):
            Require(np.abs(resultant).max() / work, TOLERANCE, "both sides feel different forces")
    problem.work = work
    free = np.array([bool(b) for b in space.FreeDofs()])
    Require(np.abs(total[free]).max() / work, problem.rough, "equilibrium")


def CheckHeat(problem):
    """What flows is what the law says of both sides, and heat balances in the bodies."""
    heat, (contact,) = problem.heat, problem.contacts
    table, step = contact.Table(), max(contact.dt.Get(), 1e-300)
    V, W, temperature = problem.X.components[0], problem.X.components[-1], problem.gf.components[-1]
    values, d, paired = temperature.vec.FV().NumPy(), problem.mesh.dim, table["area"] > 0
    sides = []
    for operator in contact.Mortar():  # VectorH1 numbers its first component like H1
        entries = GridFunction(V)
        entries.components[0].vec.FV().NumPy()[:] = values
        product = operator.CreateColVector()
        product.data = operator * entries.vec
        sides.append(product.FV().NumPy()[::d][paired] / table["area"][paired])
    pressure, gap = table["pressure"][paired], table["gap"][paired]
    if heat.friction:
        error = np.abs(table["friction"][paired] - heat.friction(*sides))
        Require(error.max(initial=0), TOLERANCE, "friction by the temperature")
    flow = heat.twin(pressure, gap, *sides)
    aside = table["traction"] + table["pressure"][:, None] * table["normal"]
    power = -np.sum(aside * table["slip"], axis=1)[paired] / step * heat.rubs
    expected = np.stack([flow - heat.share * power, flow + (1 - heat.share) * power])
    found = np.stack([table["flux_out"], table["flux_in"]])[:, paired]
    size = max(np.abs(expected).max(initial=0), 1e-6)
    Require(np.abs(found - expected).max(initial=0) / size, TOLERANCE, "flux and its law")
    rows = problem.gf.vec.CreateVector()
    problem.a.Apply(problem.gf.vec, rows)
    hats = rows.FV().NumPy()[-W.ndof :][: problem.mesh.nv]
    ends = ~np.array([bool(b) for b in W.FreeDofs()])[: problem.mesh.nv]
    out, into = contact.Flow()
    works = max(np.abs(hats).sum(), 1e-6)
    Require(abs(hats.sum() + out - into - hats[ends].sum()) / works, TOLERANCE, "heat balance")


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


def Translations(space):
    """Unit motions of everything, as scalar values of the displacement."""
    field = GridFunction(space)
    for direction in np.eye(space.mesh.dim):
        field.Set(CF(tuple(direction)))
        yield field.vec.FV().NumPy().copy()


# --- geometry ---------------------------------------------------------------------------------


def Outline(problem, region, places, moved=1):
    """Deformed positions (edges, places, 2) along boundary edges, in their order."""
    rule = IntegrationRule([(1 - place,) for place in places], [1.0] * len(places))
    points = problem.mesh.MapToAllElements({SEGM: rule}, problem.mesh.Boundaries(region))
    values = (CF((x, y)) + moved * problem.gf.components[0])(points)
    return values.reshape(-1, len(places), 2)


def CheckOutlines(problem):
    """No body is folded, and no slave edge on average in another body, and nowhere deep in it.

    For bodies whose boundary is one chain of edges in their order, as `Grids` makes it.
    """
    middles = [(k + 0.5) / 8 for k in range(8)]
    for slave, master in problem.pairs:
        if not isinstance(master, str):
            continue
        name = master.split("|")[0].rsplit("_", 1)[0]
        ends = Outline(problem, f"{name}_.*", [0.0, 1.0], moved=0)
        if np.abs(ends[:, 1] - np.roll(ends[:, 0], -1, axis=0)).max() > 1e-9 * problem.extent:
            continue
        body = shapely.Polygon(
            Outline(problem, f"{name}_.*", [0.0, 0.25, 0.5, 0.75]).reshape(-1, 2)
        )
        if not body.is_valid:
            raise WrongAnswerError(f"body {name} is folded")
        edges = Outline(problem, slave, middles)
        size = 8 / 7 * np.linalg.norm(edges[:, -1] - edges[:, 0], axis=1)
        points = shapely.points(edges)
        depth = shapely.contains(body, points) * shapely.distance(body.exterior, points)
        gap = shapely.distance(body, points)
        Require(((depth - gap).mean(axis=1) / size).max(), 0.05, f"{slave} lies inside of {name}")
        Require((depth / size[:, None]).max(), 0.35, f"{slave} cuts into {name}")


def CheckEnd(problem):
    """The load has been reached, and the force of the first contact if it is known."""
    Require(abs(problem.load.Get() - problem.path[-1][0]), 1e-12, "the load was not reached")
    if problem.resultant:
        error = np.abs(problem.contacts[0].Force() - np.array(problem.resultant)).max()
        Require(error / np.abs(problem.resultant).max(), 1e-6, "resultant")
    for what, measure, value, error in problem.expected:
        found = measure(problem)
        Require(abs(found - value), error, f"{what}: {found:.6g} and not {value:.6g}")
