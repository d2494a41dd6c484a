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

from dataclasses import dataclass, field

import numpy as np
from ngsolve import *

from ngslac import BubbleVectorH1, ContactSolver, LACContact, LACSpace, LoadStepper
from ngslac.materials import Stress
from ngslac.meshes import SphereOnBlock
from ngslac.reference import HertzPoint

OPEN, STICK, SLIP = 0, 1, 2
COPIES = {"quarter": 4, "half": 2, "full": 1}  # of the model, which make the whole


@dataclass(frozen=True, kw_only=True)
class Sphere:
    """What a push and a twist have in common; in mm and MPa."""

    model: str  # "quarter" for twists, "half" (y >= 0) for shifts along x, "full"
    elements: float  # edges along the contact radius
    order: int = 2  # of the displacement
    # Macro-elements are single triangles or, with "none", several (two for order 2).
    stabilize: str = "bubble"
    friction: float = 0.3  # Coulomb's coefficient
    young: float = 70e3  # of both bodies
    nu: float = 0.3
    radius: float = 50.0  # of the sphere, half width and height of the block
    contact: float = 1.0  # radius to aim at; since the bodies are finite it gets a bit larger
    zone: float = 1.25  # radius of the slave face over `contact`
    grading: float = 0.5  # of the elements away from there
    press: int = 2  # steps of the normal motion
    steps: int = 5  # of the tangential motion, after a first small one
    # Friction acts while the normal load grows, too. It should not matter much, since bodies of the
    # same material have no reason to slip then; what it leaves are small radial tractions, from the
    # curvature and from the discretization.
    rough: bool = True

    @property
    def approach(self):
        """Displacement of the top towards the block, at which Hertz' radius is `contact`."""
        return self.contact**2 / self.radius

    @property
    def shear_modulus(self):
        return self.young / (2 * (1 + self.nu))

    def Hertz(self, force):
        """Hertz' solution for a normal force."""
        elastic = dict(young1=self.young, nu1=self.nu, young2=self.young, nu2=self.nu)
        return HertzPoint(force=force, radius1=self.radius, **elastic)

    def Mesh(self):
        """The mesh of the model."""
        return SphereOnBlock(
            self.contact / self.elements,
            radius=self.radius,
            zone=self.zone * self.contact,
            width=self.radius,
            height=self.radius,
            model=self.model,
            grading=self.grading,
        )

    def Stress(self, u):
        """Stress of a displacement."""
        return Stress(Sym(Grad(u)), self.young, self.nu)


@dataclass(frozen=True)
class State:
    """A converged step. Arrays run over the macro-elements of the model.

    `force` and `moment` (about the z axis) act on the slave, and are those of the whole contact;
    `motion` has the approach, shift and angle of the top.
    """

    motion: dict
    force: np.ndarray
    moment: float
    area: np.ndarray
    pressure: np.ndarray
    traction: np.ndarray  # (n, 2), tangential, in the plane
    slip: np.ndarray  # (n, 2), of the last step
    status: np.ndarray
    iterations: int
    copies: int  # of the model in the whole
    vector: object  # of the solution

    def Radius(self, *status):
        """Radius of a disc with the area of all macro-elements of these statuses."""
        area = self.copies * self.area[np.isin(self.status, status)].sum()
        return float(np.sqrt(area / np.pi))


@dataclass
class Model:
    """The discrete problem, at rest.

    `states` are all converged steps.
    """

    problem: Sphere
    mesh: object = field(init=False)
    solution: GridFunction = field(init=False)
    contact: LACContact = field(init=False)
    states: list = field(default_factory=list)

    def __post_init__(self):
        self.mesh = self.problem.Mesh()
        V = self._Displacements()
        X = V * LACSpace(V, slave="slave")
        (u, lam), (v, _) = X.TnT()
        self.form = BilinearForm(X)
        self.form += InnerProduct(self.problem.Stress(u), Sym(Grad(v))) * dx
        self.solution = GridFunction(X)
        self.friction = Parameter(self.problem.friction)
        self.contact = LACContact(u, lam, master="master", friction=self.friction)
        self.motion = {name: Parameter(0.0) for name in ("approach", "shift", "angle")}
        self._SetModes(V)

    @property
    def displacement(self):
        return self.solution.components[0]

    def _Displacements(self, odd=False):
        """The displacement space; with `odd` the symmetry planes are those of a twist."""
        held = "top|bottom"
        fixed = {"dirichletx": "sym_x", "dirichlety": "sym_y", "dirichletz": ""}
        if odd:
            fixed = {"dirichletx": "sym_y", "dirichlety": "sym_x", "dirichletz": "sym_x|sym_y"}
        fixed = {name: f"{held}|{planes}" for name, planes in fixed.items()}
        options = {"order": self.problem.order, **fixed}
        if self.problem.stabilize == "bubble":
            return BubbleVectorH1(self.mesh, slave="slave", **options)
        return VectorH1(self.mesh, **options)

    def _SetModes(self, V):
        """The dofs of the top, and their values in each of its motions."""
        mode, top = GridFunction(V), self.mesh.Boundaries("top")
        held = np.fromiter(V.GetDofs(top), dtype=bool, count=V.ndof)
        self._top = np.flatnonzero(np.repeat(held, V.dim))
        self._modes = {}
        motions = {"approach": (0, 0, -1), "shift": (1, 0, 0), "angle": (-y, x, 0)}
        for name, value in motions.items():
            mode.Set(CF(value), definedon=top)
            self._modes[name] = mode.vec.FV().NumPy()[self._top].copy()

    def _Prescribe(self, gf):
        values = sum(load.Get() * self._modes[name] for name, load in self.motion.items())
        gf.components[0].vec.FV().NumPy()[self._top] = values

    def Press(self, callback=None):
        """Press the sphere on the block; the radius of the contact grows by equal parts."""
        stepper, n = self._Stepper("approach"), self.problem.press
        self.friction.Set(self.problem.friction if self.problem.rough else 0.0)
        for k in range(1, n + 1):
            self._Move(stepper, (k / n) ** 2 * self.problem.approach, callback)
        self.friction.Set(self.problem.friction)
        return self.states[-1]

    def Shift(self, *ends, callback=None):
        """Move the top along x to each of the displacements `ends`."""
        return self._Path("shift", ends, callback)

    def Turn(self, *ends, callback=None):
        """Turn the top about the z axis to each of the angles `ends`."""
        return self._Path("angle", ends, callback)

    def _Path(self, name, ends, callback):
        stepper = self._Stepper(name)
        for end in ends:
            self._Move(stepper, end, callback)
        return self.states[-len(ends) :]

    def _Stepper(self, name):
        options = {}
        if name == "angle" and self.problem.model == "quarter":
            space = self._Displacements(odd=True) * self.solution.space.components[1]
            options |= {"freedofs": space.FreeDofs(), "rhs": self._Reactions()}
        solver = ContactSolver(self.form, self.solution, self.contact, **options)
        return LoadStepper(solver, self.motion[name], prescribe=self._Prescribe)

    def _Reactions(self):
        """Forces that hold the present state, where it is not free."""
        forces, contact = (self.solution.vec.CreateVector() for _ in range(2))
        self.form.Apply(self.solution.vec, forces)
        self.contact.Apply(self.solution.vec, contact)
        forces.data += contact
        forces.FV().NumPy()[self.contact.form.MultiplierDofs()] = 0  # no forces, but lengths
        return forces

    def _Move(self, stepper, end, callback):
        def Record(step):
            self.states.append(self._State(step.iterations))
            if callback:
                callback(self.states[-1])

        with TaskManager():
            stepper.Integrate(end, steps=1, printing=False, callback=Record)

    def _State(self, iterations):
        table, copies = self.contact.Table(), COPIES[self.problem.model]
        tangential = table["traction"] + table["pressure"][:, None] * table["normal"]
        force = copies * np.asarray(self.contact.Force())
        return State(
            motion={name: load.Get() for name, load in self.motion.items()},
            force=force,
            moment=copies * float(self.contact.Moment((0, 0, 0))[2]),
            area=table["area"].copy(),
            pressure=table["pressure"].copy(),
            traction=tangential[:, :2].copy(),
            slip=table["slip"][:, :2].copy(),
            status=table["status"].copy(),
            iterations=iterations,
            copies=copies,
            vector=self.solution.vec.CreateVector(copy=True),
        )


def BulkCompliance(model):
    """Displacement of the top along x per force, beyond that of two half-spaces.

    What finite bodies add to the displacement of half-spaces depends on the force alone, not on
    how its tractions are distributed in the small contact (de Saint-Venant). So it is computed
    with known ones, without contact: sqrt(1 - r^2/b^2) on the slave face, of radius b, and the
    opposite on the master side. From the mean displacement, with these weights, that of
    half-spaces is taken, 3 Q (2 - nu)/(20 G b) on each side for a force Q (integrated from
    Johnson, Contact Mechanics, 1985, equation 3.91a).
    """
    problem, V = model.problem, model.solution.space.components[0]
    radius = problem.zone * problem.contact
    left = 1 - (x * x + y * y) / radius**2
    density = sqrt(0.5 * (left + sqrt(left * left)))  # zero outside
    u, v = V.TnT()
    a = BilinearForm(InnerProduct(problem.Stress(u), Sym(Grad(v))) * dx, symmetric=True)
    slave, master = (
        LinearForm(density * v[0] * ds(name, bonus_intorder=10)).Assemble().vec
        for name in ("slave", "master")
    )
    moved, unit = GridFunction(V), GridFunction(V)
    load = (slave - master).Evaluate()
    moved.vec.data = a.Assemble().mat.Inverse(V.FreeDofs(), inverse="sparsecholesky") * load
    unit.Set((1, 0, 0))
    copies = COPIES[problem.model]
    force = copies * unit.vec.InnerProduct(slave)
    mean = copies * moved.vec.InnerProduct(load) / force
    half_spaces = 2 * 3 * force * (2 - problem.nu) / (20 * problem.shear_modulus * radius)
    return float((mean - half_spaces) / force)
