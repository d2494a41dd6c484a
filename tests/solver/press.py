"""One block pressed on another one and pushed aside: a small complete problem for the solver."""

from dataclasses import dataclass

from ngsolve import (
    CF,
    BilinearForm,
    Grad,
    GridFunction,
    Id,
    IfPos,
    InnerProduct,
    Parameter,
    Sym,
    Trace,
    Variation,
    VectorH1,
    ds,
    dx,
    log,
    x,
)

from ngslac import ContactSolver, LACContact, LACSpace
from ngslac.meshes import TwoBlocks

MU, LAME = 40.0, 60.0


@dataclass
class Press:
    """The parts of a problem; `load` scales the motion of the spring-held top."""

    mesh: object
    X: object
    a: object
    gf: object
    contact: object
    load: object

    def solver(self, **flags):
        return ContactSolver(self.a, self.gf, self.contact, **flags)


def linear(u, v, dx=dx):
    strain = Sym(Grad(u))
    stress = 2 * MU * strain + LAME * Trace(strain) * Id(2)
    return InnerProduct(stress, Sym(Grad(v))) * dx


def neo_hooke(u, dx=dx):
    F = Id(2) + Grad(u)
    det = F[0, 0] * F[1, 1] - F[0, 1] * F[1, 0]
    energy = MU / 2 * (InnerProduct(F, F) - 2) - MU * log(det) + LAME / 2 * log(det) ** 2
    return Variation(energy.Compile() * dx)


def press(
    *,
    order=2,
    push=(0.02, -0.02),
    h=0.25,
    nonlinear=False,
    spring=1000.0,
    condense=False,
    space=VectorH1,
    mesh_flags=None,
    flags=None,
    master="master",
    **law,
):
    """Block "upper", its top held by springs that move by load * push, on a clamped block "lower".

    `mesh_flags` go to TwoBlocks, `flags` to the displacement space, the rest to LACContact.
    """
    options = {"overhang": 0.2, "aligned": False, "structured": True} | (mesh_flags or {})
    mesh = TwoBlocks(h, **options)
    V = space(mesh, order=order, **({"dirichlet": "bottom"} | (flags or {})))
    X = V * LACSpace(V, slave="slave")
    (u, lam), (v, _) = X.TnT()
    load = Parameter(1.0)
    a = BilinearForm(X, condense=condense)
    a += neo_hooke(u) if nonlinear else linear(u, v)
    if spring:
        a += spring * InnerProduct(u - load * CF(push), v) * ds("top")
    contact = LACContact(u, lam, master=master, **law)
    return Press(mesh, X, a, GridFunction(X), contact, load)


def mixed_press(**flags):
    """Stick, slip and open at once: the top is turned, and friction is high on one side only."""
    size = 4 if flags.get("nonlinear") else 1
    push = (0.005 * size, (-0.02 + 0.025 * x) * size)
    return press(**{"push": push, "h": 0.15, "friction": IfPos(x - 0.3, 0.1, 2.0)} | flags)


def numpy(vec):
    """A copy of the entries of a vector or GridFunction."""
    return getattr(vec, "vec", vec).FV().NumPy().copy()
