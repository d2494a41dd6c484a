"""Wrong input to LACSpace, LACContact and the mesh tools in 2D and 3D: errors that say what."""

import re
from contextlib import nullcontext

import pytest
from bricks import glued
from ngsolve import (
    H1,
    BilinearForm,
    Grad,
    GridFunction,
    InnerProduct,
    Parameter,
    TaskManager,
    VectorH1,
    dx,
    sqrt,
    x,
)
from refused import calls, check_refused

from ngslac import ContactSolver, LACContact, LACSpace, TimeStepper
from ngslac.meshes import TwoBlocks, TwoBlocks3D

MESHES = {2: lambda: TwoBlocks(0.34, structured=True), 3: lambda: TwoBlocks3D("hex", "tet", 3, 2)}


class Mute:
    """What cannot even be shown."""

    def __repr__(self):
        raise RuntimeError("no text")


class Parts:
    """The parts of a problem, which the calls below name."""

    def __init__(self, mesh, slave="slave", **flags):
        self.mesh, self.dim = mesh, mesh.dim
        self.V = VectorH1(mesh, order=2, dirichlet="bottom|top")
        self.X = self.V * LACSpace(self.V, slave=slave, **flags)
        (self.u, self.lam), (self.v, self.mu) = self.X.TnT()
        self.gf, self.wrong = GridFunction(self.X), GridFunction(self.V)
        self.vec, self.a = self.gf.vec, BilinearForm(InnerProduct(Grad(self.u), Grad(self.v)) * dx)

    def contact(self, **flags):
        return LACContact(self.u, self.lam, **({"master": "master"} | flags))

    def paired(self, **flags):
        contact = self.contact(**flags)
        contact.Update()
        return contact

    def solver(self, contacts=None):
        return ContactSolver(self.a, self.gf, contacts or self.contact())

    def stepper(self, density=1, **flags):
        return TimeStepper(self.solver(), density, dt=0.1, **flags)

    def names(self):
        parts = {name: getattr(self, name) for name in dir(self) if not name.startswith("_")}
        return parts | {"Parts": Parts, "Mute": Mute, "other": MESHES[self.dim]}


@pytest.fixture(scope="module", params=[2, 3])
def parts(request):
    return Parts(MESHES[request.param]())


NOWHERE = "matches no boundary face; the boundaries are: .*top"
PATTERN = "master = .* must be a pattern of boundary names"
EITHER = "either master= or obstacle=, not both and not none"
NOTRIAL, PRODUCTS = "must be a trial function", "u and lam belong to different product spaces"
SLIDE, VALUES = "tied surfaces do not slide: drop friction and tresca", "holds a trial or test func"
KEEP = "tied surfaces keep their distance: drop offset and bilateral"
OUT = ("NAN", "INF")
REFUSED = [
    # regions
    ("contact(master='nowhere')", f"master='nowhere' {NOWHERE}", ValueError),
    ("contact(master=mesh.Boundaries('nowhere'))", "matches no boundary face", ValueError),
    ("contact(master=mesh.Materials('lower'))", PATTERN, ValueError),
    ("contact(master=mesh.BBoundaries('.*'))", "boundary region", ValueError),
    ("contact(master=3)", PATTERN, TypeError),
    ("contact(master=other().Boundaries('master'))", "another mesh"),
    ("contact(master='slave|master')", "boundaries slave are both slave and master", ValueError),
    ("paired(master='bottom', maxdist=0.1)", "slave and master never meet.*maxdist"),
    ("paired(master='left_lower', maxdist=0.1)", "never meet"),  # at right angles
    ("paired(master='left_upper', maxdist=0.1)", "never meet"),
    # coefficients
    *(
        (f"contact({name}={v})", f"{name} = {re.escape(v.lower())} must be a {what}", ValueError)
        for names, values, what in (
            (("friction", "tresca"), ("-0.1", "NAN", "INF"), "finite number >= 0"),
            (("adjust", "maxdist", "penetration"), ("0", "-1.0", "NAN", "INF"), "positive length"),
            (("stiffness",), ("0", "-1.0", "NAN", "9e-07", "1e+300"), "positive factor from 1e-06"),
        )
        for name in names
        for v in values
    ),
    ("paired(master=None, obstacle=sqrt(x - 0.5))", r"gap to the obstacle is -?nan at \("),
    ("contact(obstacle=CF(0.1))", EITHER, ValueError),
    ("contact(master=None)", EITHER, ValueError),
    ("contact(tied=True, friction=0.3)", SLIDE, ValueError),
    ("contact(tied=True, tresca=0.3)", SLIDE, ValueError),
    ("contact(tied=True, offset=0.3)", KEEP, ValueError),
    ("contact(tied=True, bilateral=True)", KEEP, ValueError),
    (
        "contact(tied=True, adjust=0.1)",
        "tied surfaces keep their distance: drop adjust",
        ValueError,
    ),
    ("contact(bilateral=2)", "bilateral = 2 must be True or False", TypeError),
    *(
        (f"contact(master='slave', finite=True, {law}=True)", "both slave and master: what touc")
        for law in ("tied", "bilateral")
    ),
    ("contact(offset=CF((1, 2)))", "offset has 2 components", ValueError),
    *((f"contact(offset={v})", f"offset = {v.lower()} must be a finite", ValueError) for v in OUT),
    # fields
    ("LACContact(*(V * V).TrialFunction(), master='master')", "lam must belong to a LACSpace, no"),
    ("Parts(mesh, components=1).contact()", "needs as many components as u"),
    ("LACContact(v, lam, master='master')", f"u .*{NOTRIAL}"),
    ("LACContact(u, mu, master='master')", f"lam .*{NOTRIAL}"),
    ("LACContact(2 * u, lam, master='master')", NOTRIAL),
    ("LACContact(gf.components[0], lam, master='master')", NOTRIAL),
    ("LACContact(u, Parts(mesh).lam, master='master')", PRODUCTS),
    ("LACContact(V.TrialFunction(), lam, master='master')", PRODUCTS),
    # states
    ("paired().Evaluate(wrong)", "gf lives on another space than u and lam.* in place of"),
    ("paired().Apply(vec, vec)", "the scale c is not set; call SetStiffness"),
    ("contact(friction=GridFunction(H1(other())))", "friction lives on another mesh", ValueError),
    ("contact(friction=Mute())", "friction = <Mute> must be a finite number >= 0", TypeError),
    ("contact(master=Mute())", "master = <Mute> must be a pattern of boundary names", TypeError),
    ("contact(maxdist=10**400)", "maxdist = 10+.* must be a positive length", ValueError),
    ("paired().Moment(([0], [0, 0]))", "must be a point with . coordinates", TypeError),
    ("paired().Moment('ab')", "must be a point with . coordinates", TypeError),
    ("paired().Plot(axes=3)", "axes = 3 must be axes of matplotlib, or None", TypeError),
    ("stepper().Integrate(end=1e12)", r"1e\+13 steps of dt = 0.1 away: take fewer", ValueError),
    # functions without values, iterables without an end
    ("contact(friction=0.1 + u[1] * x)", f"^friction.* {VALUES}", ValueError),
    ("contact(tresca=lam[0])", f"^tresca.* {VALUES}", ValueError),
    ("contact(master=None, obstacle=v[1])", f"^obstacle.* {VALUES}", ValueError),
    ("contact().Draw(background=u, show=False)", f"^background.* {VALUES}", ValueError),
    ("contact().Draw(deformation=2 * v, show=False)", f"^deformation.* {VALUES}", ValueError),
    ("contact().WriteVTU('none', displacement=u)", f"^displacement.* {VALUES}", ValueError),
    ("stepper(1 + u[1])", f"^density.* {VALUES}", ValueError),
    ("stepper(prescribe={'top': u})", f"^prescribe.* {VALUES}", ValueError),
    ("LACSpace(V, slave='slave', macros=repeat(0))", r"macros = repeat\(0\) has more entr"),
    ("LACSpace(V, slave='slave', macros=mesh)", "macros = .*Mesh.* must be a list", TypeError),
    ("solver(repeat(contact()))", "contacts: two contacts share one lam", ValueError),
    ("solver(count())", "contacts = 0 must be a LACContact", TypeError),
]


@calls(REFUSED)
def test_refused(parts, row):
    check_refused(row, **parts.names())


@pytest.mark.parametrize("threads", [nullcontext, TaskManager])
@pytest.mark.parametrize(
    ("value", "text"), [(0.5 - x, "-0"), (sqrt(x - 0.5), "nan"), (Parameter(-0.1), "-0.1")]
)
def test_wrong_functions(parts, value, text, threads):
    """Found where they are wrong: position and boundary are named."""
    point = ", ".join([r"[^,)]+"] * parts.dim)
    expected = rf"friction is -?{text}.* at \({point}\) on boundary 'slave'; it must be a number >="
    with pytest.raises(Exception, match=expected), threads():
        parts.paired(friction=value)


@pytest.mark.parametrize("dim", [2, 3])
def test_glued_bodies(dim):
    """Bodies that share nodes have no surfaces that could separate."""
    with pytest.raises(Exception, match=r"'interface' has material on both sides.*share no nodes"):
        Parts(glued(dim, 0.6), slave="interface").paired(master="end")


def test_each_body_with_a_space_of_its_own():
    """The master would count as a body at rest, and nothing would tell."""
    mesh = TwoBlocks(0.5)
    upper = VectorH1(mesh, order=2, definedon="upper")
    lower = VectorH1(mesh, order=2, definedon="lower", dirichlet="bottom")
    u, *_, lam = (upper * lower * LACSpace(upper, slave="slave")).TrialFunction()
    with pytest.raises(ValueError, match="master = 'master' has no degrees of freedom of u"):
        LACContact(u[0] if isinstance(u, (list, tuple)) else u, lam, master="master")


@pytest.mark.parametrize("finite", [False, True])
def test_a_master_without_unknowns_is_a_rigid_body(finite):
    mesh = TwoBlocks(0.5)
    V = VectorH1(mesh, order=2, definedon="upper")
    X = V * H1(mesh) * LACSpace(V, slave="slave")  # a temperature is no displacement
    u, _, lam = X.TrialFunction()
    LACContact(u, lam, master="master", finite=finite).Update()


def test_a_refined_space_needs_a_new_solver():
    parts = Parts(TwoBlocks(0.5))
    solver = parts.solver()
    parts.mesh.Refine()
    for space in (parts.V, parts.X.components[1], parts.X, parts.gf):
        space.Update()
    with pytest.raises(ValueError, match="the space was refined: make a new ContactSolver"):
        TimeStepper(solver, 1.0, dt=0.1)
