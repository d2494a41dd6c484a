"""Contact forms between two small blocks, at states in which every status occurs."""

from functools import reduce
from operator import mul

import numpy as np
from ngsolve import CF, H1, GridFunction, VectorH1, VectorValued

from ngslac import BubbleVectorH1, LACContact, LACSpace
from ngslac.meshes import TwoBlocks
from ngslac.meshes.blocks3d import TwoBlocks3D

SPACES = {
    "order 1": lambda mesh: VectorH1(mesh, order=1),
    "order 2": lambda mesh: VectorH1(mesh, order=2),
    "order 3": lambda mesh: VectorH1(mesh, order=3),
    "H1(dim)": lambda mesh: H1(mesh, order=2, dim=mesh.dim),
    "VectorValued": lambda mesh: VectorValued(H1(mesh, order=2), mesh.dim),
    "prescribed": lambda mesh: VectorH1(mesh, order=mesh.dim, dirichletx="slave"),
    "bubble": lambda mesh: BubbleVectorH1(mesh, order=1, slave="slave"),
}
C = 3.0  # the scale of the complementarity functions
ROTATION = ((1.0, 2.0, 0.5), 37.0)


def block_mesh(dim, *sizes, **flags):
    """An inclined interface; one side ends before the other, so that some faces are alone."""
    if dim == 2:
        options = {"height": 0.5, "structured": True, "angle": 20.0, "overhang": -0.2}
        return TwoBlocks(*(sizes or (0.1,)), **({"aligned": False} | options | flags))
    options = {"shape": "oblique", "rotation": ROTATION, "overhang": -0.1, "aligned": False}
    return TwoBlocks3D(*(sizes or ("hex", "tet", 3, 2)), **(options | flags))


def contact_form(mesh, space="order 2", *, master="master", before=(), **law):
    """A paired contact with a fixed scale, so that no bulk is needed.

    `before` are spaces in front of the displacement in the product.
    """
    V = SPACES[space](mesh)
    X = reduce(mul, [*(make(mesh) for make in before), V, LACSpace(V, slave="slave")])
    *_, u, lam = X.TrialFunction()
    contact = LACContact(u, lam, master=None if "obstacle" in law else master, **law)
    contact.Update()
    contact.form.SetConstant(C)
    return contact


def macro_dofs(contact):
    """Scalar numbers of the multipliers, (nmacros, dim)."""
    return contact.form.MultiplierDofs().reshape(-1, contact.mesh.dim)


def vector(contact, values=0.0):
    """A vector on the product space with given scalar values."""
    vec = GridFunction(contact.form.fes).vec.CreateVector()
    vec.FV().NumPy()[:] = values
    return vec


def random_state(contact, seed=0):
    """Displacements and tractions of one order of magnitude: about half of the macros are open."""
    return np.random.default_rng(seed).normal(size=contact.nscalars)


def mixed_state(contact, expected=None):
    """The first random state in which exactly the expected statuses occur, or at least two."""
    for seed in range(20):
        state = random_state(contact, seed)
        found = set(statuses(contact, state))
        if found == expected or (expected is None and len(found) > 1):
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


def moved(contact, upper=None, lower=None):
    """A GridFunction with displacements of both blocks, by default none."""
    gf, none = GridFunction(contact.form.fes), (0,) * contact.mesh.dim
    fields = {"upper": none if upper is None else upper, "lower": none if lower is None else lower}
    fields = {body: CF(tuple(field)) for body, field in fields.items()}
    gf.components[-2].Set(contact.mesh.MaterialCF(fields))
    return gf


def with_traction(contact, gf, traction):
    """The same with a traction (n, dim) or (dim,) on the macro-elements."""
    gf.vec.FV().NumPy()[macro_dofs(contact)] = traction
    return gf
