"""A sphere on a block of the same material, pressed and then moved tangentially: the model.

The flat upper side of the half sphere is moved as a rigid body: down, sideways, and about the z
axis. The block is fixed at its bottom. Both are large against the contact.

*The quarter model of a twist.* Pressing is symmetric about the planes x = 0 and y = 0; a twist is
antisymmetric, points of these planes move across them only. Bodies of revolution respond to the
twist without a change of the pressure, so the two do not mix, and the quarter is pressed with the
one and twisted with the other conditions. That neglects how slip releases the radial tractions
that pressing leaves (they are small, of the order contact radius over radius). The full model
neglects nothing.
"""

import re
from dataclasses import dataclass
from types import SimpleNamespace

import numpy as np
from ngsolve import *
from pictures import Curves, Show
from scipy.optimize import minimize_scalar
from slavefaces import SlaveFaces

from ngslac import *
from ngslac.materials import Stress
from ngslac.meshes import SphereOnBlock
from ngslac.reference import HertzPoint

OPEN, STICK, SLIP = 0, 1, 2
COPIES = {"quarter": 4, "half": 2, "full": 1}  # of the model, which make the whole
CONTACT, ZONE = 1.0, 1.25  # radius to aim at (finite bodies have a larger one); of the slave face
FIRST = 0.01  # of the load that makes all slip: a first step, which tells the stiffness before slip


@dataclass(kw_only=True)
class Sphere:
    """The discrete problem, at rest, in mm and MPa; `states` are all converged steps.

    Their arrays run over the macro-elements of the model, with `traction` (tangential) and `slip`
    (of the step) in the plane. `force` and `moment` (about the z axis) act on the slave and are
    those of the whole contact; `motion` has the approach, shift and angle of the top.
    """

    model: str  # "quarter" for twists, "half" (y >= 0) for shifts along x, "full"
    elements: float  # edges along the contact radius
    friction: float = 0.3  # Coulomb's coefficient
    young: float = 70e3  # of both bodies
    nu: float = 0.3
    radius: float = 50.0  # of the sphere, half width and height of the block
    grading: float = 0.5  # of the elements away from there
    press: int = 2  # steps of the normal motion
    # Friction acts while the normal load grows, too, unless it is smooth. It should not matter
    # much, since bodies of the same material have no reason to slip then; what it leaves are small
    # radial tractions, from the curvature and from the discretization.
    smooth: bool = False

    def __post_init__(self):
        sizes = dict.fromkeys(("radius", "width", "height"), self.radius)
        how = {"zone": ZONE, "model": self.model, "grading": self.grading}
        self.mesh, self.states = SphereOnBlock(CONTACT / self.elements, **sizes, **how), []
        V = self._Displacements()
        X = V * LACSpace(V, slave="slave")
        (u, lam), (v, _) = X.TnT()
        self.a, self.solution = BilinearForm(X), GridFunction(X)
        self.a += InnerProduct(self.Stress(u), Sym(Grad(v))) * dx
        self.rubs = Parameter(0.0 if self.smooth else self.friction)
        self.contact = LACContact(u, lam, master="master", friction=self.rubs)
        self.motion = {name: Parameter(0.0) for name in ("approach", "shift", "angle")}
        move, turn = (self.motion[name] for name in ("shift", "angle"))
        self.top = {"top": CF((move - y * turn, x * turn, -self.motion["approach"]))}
        self.faces = SlaveFaces(self.mesh, self.contact.space.macros)

    @property
    def displacement(self):
        return self.solution.components[0]

    @property
    def shear_modulus(self):
        return self.young / (2 * (1 + self.nu))

    def Hertz(self, force):
        """Hertz' solution for a normal force."""
        elastic = dict(young1=self.young, nu1=self.nu, young2=self.young, nu2=self.nu)
        return HertzPoint(force=force, radius1=self.radius, **elastic)

    def Stress(self, u):
        """Stress of a displacement."""
        return Stress(Sym(Grad(u)), self.young, self.nu)

    def _Displacements(self, odd=False):
        """The displacement space; with `odd` the symmetry planes are those of a twist."""
        planes = ("sym_y", "sym_x", "sym_.*") if odd else ("sym_x", "sym_y", "none")
        names, fixed = self.mesh.GetBoundaries(), {}
        for axis, plane in zip("xyz", planes, strict=True):
            here = {name for name in names if re.fullmatch(plane, name)}
            fixed[f"dirichlet{axis}"] = "|".join(["top", "bottom", *sorted(here)])
        return BubbleVectorH1(self.mesh, slave="slave", order=2, **fixed)

    def Press(self):
        """Press the sphere on the block; the radius of the contact grows by equal parts."""
        approach = CONTACT**2 / self.radius
        parts = np.arange(1, self.press + 1) / self.press
        pressed = self.Move("approach", *approach * parts**2)
        self.rubs.Set(self.friction)
        return pressed[-1]

    def Move(self, name, *ends):
        """Bring the "shift" along x or the "angle" about z of the top to each of these values."""
        options = {}
        if name == "angle" and self.model == "quarter":
            space = self._Displacements(odd=True) * self.solution.space.components[1]
            options |= {"freedofs": space.FreeDofs(), "rhs": self._Reactions()}
        solver = ContactSolver(self.a, self.solution, self.contact, **options)
        stepper = LoadStepper(solver, self.motion[name], prescribe=self.top)
        for end in ends:
            with TaskManager():
                stepper.Integrate(end, steps=1, printing=False, callback=self._Note)
        return self.states[-len(ends) :]

    def _Reactions(self):
        """Forces that hold the present state, where it is not free."""
        forces = self.solution.vec.CreateVector()
        self.a.Apply(self.solution.vec, forces)
        self.contact.AddApply(self.solution.vec, forces)
        forces.FV().NumPy()[self.contact.form.MultiplierDofs()] = 0  # no forces, but lengths
        return forces

    def _Note(self, step):
        table, copies = self.contact.Table(), COPIES[self.model]
        tangential = table["traction"] + table["pressure"][:, None] * table["normal"]
        state = SimpleNamespace(
            motion={name: load.Get() for name, load in self.motion.items()},
            force=copies * np.asarray(self.contact.Force()),
            moment=copies * float(self.contact.Moment((0, 0, 0))[2]),
            iterations=step.iterations,
            traction=tangential[:, :2].copy(),
            slip=table["slip"][:, :2].copy(),
            **{name: table[name].copy() for name in ("area", "pressure", "status")},
        )
        self.states.append(state)

    def Radius(self, state, *status):
        """Radius of a disc with the area of all macro-elements of these statuses."""
        area = COPIES[self.model] * state.area[np.isin(state.status, status)].sum()
        return float(np.sqrt(area / np.pi))

    @property
    def moved(self):
        """The states of the tangential load, without the first small step."""
        return self.states[self.press + 1 :]

    # --- against exact solutions -------------------------------------------------------------

    def Means(self, exact):
        """Exact tractions (m, 2), along x or with both components, over the macro-elements."""
        values = np.asarray(exact.MeanTraction(self.faces.corners))
        if values.ndim == 1:
            values = np.column_stack([values, np.zeros_like(values)])
        return self.faces.Means(values)

    def Misfit(self, state, exact):
        """Distance of the tractions to the exact means in L2, relative to the latter."""
        means, w = self.Means(exact), state.area[:, None]
        return float(np.sqrt((w * (state.traction - means) ** 2).sum() / (w * means**2).sum()))

    def FittedRatio(self, state, Exact):
        """Stick ratio of the solution that fits the tractions best.

        ``Exact(part)`` is the solution at a part (0, 1) of the load that makes all slip.
        """

        def Distance(part):
            difference = state.traction - self.Means(Exact(part))
            return (state.area[:, None] * difference**2).sum()

        best = minimize_scalar(Distance, bounds=(0, 1), method="bounded", options={"xatol": 1e-3})
        return Exact(best.x).ratio

    def Row(self, state, exact, Exact=None):
        """Stick zone and tractions of a step against the exact solution; `Exact`: of a fit."""
        a = self.Hertz(state.force[2]).contact_radius
        return {
            "stick_ratio": self.Radius(state, STICK) / a,
            "stick_ratio_fit": self.FittedRatio(state, Exact) if Exact else None,
            "stick_ratio_exact": exact.ratio,
            "contact_ratio": self.Radius(state, STICK, SLIP) / a,
            "traction_misfit": self.Misfit(state, exact),
            "open": int(np.sum(state.status == OPEN)),
            "stick": int(np.sum(state.status == STICK)),
            "slip": int(np.sum(state.status == SLIP)),
        }

    def Summary(self, rows):
        """Numbers of all steps."""
        loading = [row for row in rows if row["stick_ratio_fit"] is not None]

        def Largest(name):
            return max(abs(row[name] - row["stick_ratio_exact"]) for row in loading)

        return {
            "stick_error": Largest("stick_ratio"),
            "stick_fit_error": Largest("stick_ratio_fit"),
            "newton_max": max(state.iterations for state in self.states),
            "macros": self.contact.space.nmacros,
            "steps": rows,
        }

    def Tell(self, figures, columns, *names):
        """Print figures of the steps, then those of all."""
        print("  ".join(f"{name:>9}" for name in columns))
        for row in figures["steps"]:
            texts = (f"{np.nan if row[n] is None else row[n]:.4g}" for n in columns)
            print("  ".join(t.rjust(max(9, len(n))) for t, n in zip(texts, columns, strict=True)))
        for name in (*names, "stiffness_ratio", "stick_error", "stick_fit_error"):
            print(f"{name:<20}{figures[name]:.4f}")

    def Show(self, out, name, rows, curve, exact):
        """The curve, of which both are names of figures, stick, tractions; files for ParaView."""
        columns = {
            key: [np.nan if row[key] is None else row[key] for row in rows] for key in rows[0]
        }
        curves = {
            label: (*([0, *columns[key]] for key in keys), style)
            for label, keys, style in (("exact", exact, "k-"), ("computed", curve, "o"))
        }
        number = range(1, 1 + len(rows))
        styles = {"stick_ratio_exact": "k_", "stick_ratio": "o", "stick_ratio_fit": "x"}
        stick = {key: (number, columns[key], style) for key, style in styles.items()}
        hertz = self.Hertz(self.states[-1].force[2])
        r = np.linspace(0, 1.2 * hertz.contact_radius, 300)
        bound = {"friction times Hertz' pressure": (r, self.friction * hertz.Pressure(r), "k")}
        distance = np.linalg.norm(self.faces.middle, axis=1)
        bound["computed"] = distance, np.linalg.norm(self.states[-1].traction, axis=1), "."
        Show(out, name, self.displacement, Curves(*curve, **curves),
             Curves("step", "radius of stick / contact radius", **stick),
             Curves("distance from the middle [mm]", "traction [MPa]", **bound),
             contact=self.contact)  # fmt: skip
        if out:
            fields = [self.displacement, self.Stress(self.displacement)]
            names, files = ["displacement", "stress"], str(out / name)
            VTKOutput(self.mesh, fields, names, files, subdivision=1).Do()


def BulkCompliance(sphere):
    """Displacement of the top along x per force, beyond that of two half-spaces.

    What finite bodies add to the displacement of half-spaces depends on the force alone, not on
    how its tractions are distributed in the small contact (de Saint-Venant). So it is computed
    with known ones, without contact: sqrt(1 - r^2/b^2) on the slave face, of radius b, and the
    opposite on the master side. From the mean displacement, with these weights, that of
    half-spaces is taken, 3 Q (2 - nu)/(20 G b) on each side for a force Q (integrated from
    Johnson, Contact Mechanics, 1985, equation 3.91a).
    """
    V, radius = sphere.displacement.space, ZONE
    left = 1 - (x * x + y * y) / radius**2
    density = sqrt(0.5 * (left + sqrt(left * left)))  # zero outside
    u, v = V.TnT()
    a = BilinearForm(InnerProduct(sphere.Stress(u), Sym(Grad(v))) * dx, symmetric=True)
    slave, master = (
        LinearForm(density * v[0] * ds(name, bonus_intorder=10)).Assemble().vec
        for name in ("slave", "master")
    )
    moved, unit = GridFunction(V), GridFunction(V)
    load = (slave - master).Evaluate()
    moved.vec.data = a.Assemble().mat.Inverse(V.FreeDofs(), inverse="sparsecholesky") * load
    unit.Set((1, 0, 0))
    copies = COPIES[sphere.model]
    force = copies * unit.vec.InnerProduct(slave)
    mean = copies * moved.vec.InnerProduct(load) / force
    half_spaces = 2 * 3 * force * (2 - sphere.nu) / (20 * sphere.shear_modulus * radius)
    return float((mean - half_spaces) / force)
