"""Contact forms between two small blocks in 3D, at states in which every status occurs."""

from blocks import matrix, mixed_state, random_state, residual, statuses, vector
from ngsolve import CF, H1, GridFunction, VectorH1, VectorValued

from ngslac import BubbleVectorH1, LACContact, LACSpace
from ngslac.meshes.blocks3d import TwoBlocks3D

__all__ = [
    "ROTATION",
    "SPACES",
    "C",
    "block_mesh",
    "contact_form",
    "matrix",
    "mixed_state",
    "moved",
    "random_state",
    "residual",
    "statuses",
    "vector",
    "with_traction",
]

SPACES = {
    "VectorH1": lambda mesh: VectorH1(mesh, order=2),
    "order 1": lambda mesh: VectorH1(mesh, order=1),
    "order 3": lambda mesh: VectorH1(mesh, order=3),
    "H1(dim=3)": lambda mesh: H1(mesh, order=2, dim=3),
    "VectorValued": lambda mesh: VectorValued(H1(mesh, order=2), 3),
    "bubble": lambda mesh: BubbleVectorH1(mesh, order=1, slave="slave"),
}
C = 3.0  # the scale of the complementarity functions
ROTATION = ((1.0, 2.0, 0.5), 37.0)


def block_mesh(upper="hex", lower="tet", n_slave=3, n_master=2, **flags):
    """An inclined interface in general position; the master is smaller than the slave."""
    options = {"shape": "oblique", "rotation": ROTATION, "overhang": -0.1, "aligned": False}
    return TwoBlocks3D(upper, lower, n_slave, n_master, **(options | flags))


def contact_form(mesh, space="VectorH1", *, master="master", before=(), **law):
    """A paired contact with a fixed scale, so that no bulk is needed.

    `before` are spaces in front of the displacement in the product.
    """
    V = SPACES[space](mesh)
    parts = [make(mesh) for make in before] + [V, LACSpace(V, slave="slave")]
    X = parts[0]
    for part in parts[1:]:
        X = X * part
    *_, u, lam = X.TrialFunction()
    contact = LACContact(u, lam, master=None if "obstacle" in law else master, **law)
    contact.Update()
    contact.form.SetConstant(C)
    return contact


def moved(contact, upper=(0, 0, 0), lower=(0, 0, 0)):
    """A GridFunction with a rigid translation of both blocks."""
    gf = GridFunction(contact.form.fes)
    gf.components[-2].Set(contact.mesh.MaterialCF({"upper": CF(upper), "lower": CF(lower)}))
    return gf


def with_traction(contact, gf, traction):
    """The same with a traction (n, 3) or (3,) on the macro-elements."""
    dofs = contact.form.MultiplierDofs().reshape(-1, 3)
    gf.vec.FV().NumPy()[dofs] = traction
    return gf
