"""Contact forms between two small blocks, at states in which every status occurs."""

import numpy as np
from ngsolve import CF, H1, GridFunction, VectorH1

from ngslac import BubbleVectorH1, LACContact, LACSpace
from ngslac.meshes import TwoBlocks

SPACES = {
    "P1": lambda mesh: VectorH1(mesh, order=1),
    "P2": lambda mesh: VectorH1(mesh, order=2),
    "P3": lambda mesh: VectorH1(mesh, order=3),
    "block": lambda mesh: H1(mesh, order=2, dim=2),
    "bubble": lambda mesh: BubbleVectorH1(mesh, order=1, slave="slave"),
}
C = 3.0  # the scale of the complementarity functions


def block_mesh(angle=20.0, h=0.1, **flags):
    return TwoBlocks(h, height=0.5, structured=True, angle=angle, overhang=-0.2, aligned=False,
                     **flags)  # fmt: skip


def contact_form(mesh, space="P2", *, master="master", **flags):
    """A paired contact with a fixed scale, so that no bulk is needed."""
    V = SPACES[space](mesh)
    X = V * LACSpace(V, slave="slave")
    u, lam = X.TrialFunction()
    if "obstacle" in flags:
        master = None
    contact = LACContact(u, lam, master=master, **flags)
    contact.Update()
    contact.form.SetConstant(C)
    return contact


def vector(contact, values=0.0):
    """A vector on the product space with given scalar values."""
    vec = contact.form.mat.CreateColVector()
    vec.FV().NumPy()[:] = values
    return vec


def random_state(contact, seed=0):
    """Displacements and tractions of one order of magnitude: about half of the macros are open."""
    rng = np.random.default_rng(seed)
    return rng.normal(size=contact.nscalars)


def mixed_state(contact, expected, seed=0):
    """The first random state in which exactly the expected statuses occur."""
    for s in range(seed, seed + 20):
        state = random_state(contact, s)
        if set(statuses(contact, state)) == set(expected):
            return state
    raise AssertionError(f"no state with the statuses {expected}")


def residual(contact, state):
    x, y = vector(contact, state), vector(contact)
    contact.Apply(x, y)
    return y.FV().NumPy().copy()


def matrix(contact, state):
    contact.AssembleLinearization(vector(contact, state))
    return contact.mat.ToDense().NumPy().copy()


def statuses(contact, state):
    contact.form.Evaluate(vector(contact, state))
    return contact.Table()["status"]


def moved(contact, upper=(0, 0), lower=(0, 0)):
    """Scalar values of a rigid translation of both blocks."""
    gf = GridFunction(contact.form.fes)
    gf.components[0].Set(contact.mesh.MaterialCF({"upper": CF(upper), "lower": CF(lower)}))
    return gf


def with_traction(contact, gf, traction):
    """The same with a traction (n, 2) or (2,) on the macro-elements."""
    dofs = contact.form.MultiplierDofs().reshape(-1, 2)
    gf.vec.FV().NumPy()[dofs] = traction
    return gf
