"""Bodies and the rigid motions that nothing prevents."""

import numpy as np
from scipy.linalg import qr
from scipy.sparse import bsr_matrix, csr_matrix, vstack
from scipy.sparse.csgraph import connected_components

from ngslac._ngslac import Side
from ngslac.arrays import AsBits
from ngslac.bodies.names import BodyNames
from ngslac.bodies.rigidmotions import RigidMotions

__all__ = [
    "Bodies",
    "CloseNearest",
    "FloatingMessage",
    "JumpRows",
    "LostMessage",
    "OverloadMessage",
    "SlidingMessage",
]

TOLERANCE = 1e-8
# Forces against a rigid motion, relative to those against others: more is a spring, if a weak one.
RESISTS = 1e-12
# How far a body goes, relative to the size of the mesh, when nothing holds it.
FAR = 1.0


class Bodies:
    """The connected parts of the bulk matrix with their free rigid motions.

    Parameters
    ----------
    mat : BaseMatrix
        Assembled bulk matrix on the product space.
    contact : LACContact
        Any contact on the space: tells the displacement.
    free : (n,) bool
        Free scalar dofs.
    """

    def __init__(self, mat, contact, free):
        form = contact.form
        self.space, block = form.component, form.fes.dim
        space = self.space
        self.first, self.count = form.offset * block, space.ndof * block
        self.motions, self.names, self.size = RigidMotions(space)
        # Coordinates far from the origin hold rounding errors.
        far = np.abs(np.asarray(space.mesh.ngmesh.Coordinates())).max() / self.size
        self.resists = min(TOLERANCE, RESISTS * max(1.0, far))
        forces = Forces(mat, self.first, self.count)
        values = np.random.default_rng(0).standard_normal(self.count)
        pushed = forces(values)
        sizes = np.abs(pushed)
        self.part = LikelyParts(mat, form.offset, space.ndof).repeat(block)
        if not AreApart(self.part, forces, values, pushed):
            self.part = ConnectedParts(mat, form.offset, space.ndof).repeat(block)
        allowed = self._Allowed(sizes > 0, free[self.first : self.first + self.count])
        self.floating = [  # (part, combinations of motions as columns)
            (self.part[dofs[0]], combinations)
            for dofs, combinations in self._WithoutForces(allowed, forces, sizes)
        ]
        self.name = BodyNames(space, self.part, sizes > 0, self.motions)

    def _Allowed(self, used, free):
        """Parts that their constrained dofs let move: dofs, combinations of motions as columns."""
        dofs = np.flatnonzero(used)
        dofs = dofs[np.argsort(self.part[dofs], kind="stable")]
        ends = np.flatnonzero(np.diff(self.part[dofs], append=-1))
        allowed = []
        for own in np.split(dofs, 1 + ends[:-1])[: len(ends)]:
            combinations = NullSpace(self.motions[own[~free[own]]])
            if combinations.shape[1]:
                allowed.append((own, combinations))
        return allowed

    def _WithoutForces(self, parts, forces, sizes):
        """Reduce the combinations of each part to those that nothing resists.

        All parts move at once: no two of them are connected.
        """
        random = np.random.default_rng(1).standard_normal(len(self.names))
        moved = self._Moved(parts, forces, random)
        scales = [sizes[dofs].mean() * Norm(self.motions[dofs]) for dofs, _ in parts]
        # Mostly constraints hold a part, or nothing does, which a random motion tells.
        held = [
            not np.linalg.norm(moved[dofs]) <= self.resists * scale
            for (dofs, _), scale in zip(parts, scales, strict=True)
        ]
        resisted = [part for part, yes in zip(parts, held, strict=True) if yes]
        most = max((motions.shape[1] for _, motions in resisted), default=0)
        columns = [self._Moved(resisted, forces, weights) for weights in np.eye(most)]
        for (dofs, motions), scale, yes in zip(parts, scales, held, strict=True):
            if yes:
                moved = np.stack([c[dofs] for c in columns[: motions.shape[1]]], axis=1)
                motions = motions @ NullSpace(moved / scale, self.resists)
            if motions.shape[1]:
                yield dofs, motions

    def _Moved(self, parts, forces, weights):
        """The forces where each part moves by its combinations, weighted."""
        values = np.zeros(self.count)
        for dofs, motions in parts:
            values[dofs] = self.motions[dofs] @ (motions @ weights[: motions.shape[1]])
        return forces(values) if parts else values

    def Floating(self, contacts, holds="now"):
        """Descriptions of the free rigid motions that contact leaves, see `ActiveRows`."""
        if not self.floating:
            return []
        left = self._Left(contacts, holds)
        # Any basis is as good as another: name the motions that a pivoted elimination finds.
        place = self._Places()
        coordinates = np.zeros((len(self.floating), len(self.names), len(place)))
        together = np.concatenate([motions for _, motions in self.floating], axis=1)
        coordinates[place, :, np.arange(len(place))] = together.T
        wanted = coordinates.reshape(-1, len(place)) @ left
        # Of two that are as good, as where bodies float together, the first and not what rounds up.
        wanted *= 1 - 1e-6 * np.arange(len(wanted))[:, None]
        *_, pivots = qr(wanted.T, pivoting=True)
        chosen = [divmod(k, len(self.names)) for k in sorted(pivots[: left.shape[1]])]
        return [
            f"body {self.name(self.floating[body][0])} floats ({self.names[k]})"
            for body, k in chosen
        ]

    def AreIdle(self, contacts, holds, forces, least):
        """Do no forces push along the motions that contact leaves? Then bodies may stay.

        Parameters
        ----------
        contacts, holds :
            As in `Floating`.
        forces : ((n,), (n,))
            Scaled, and what they have to be multiplied with.
        least : float
            Norm of scaled forces that are none.
        """
        if not self.floating:
            return False  # what is held, if only just, may not stay anywhere else
        own = slice(self.first, self.first + self.count)
        scaled, factors = (values[own] for values in forces)
        left = self._Left(contacts, holds)
        weights, at = np.zeros((self.count, left.shape[1])), 0
        for part, combinations in self.floating:
            inside, count = np.flatnonzero(self.part == part), combinations.shape[1]
            moved = self.motions[inside] @ (combinations @ left[at : at + count])
            weights[inside], at = moved * factors[inside, None], at + count
        works, gross = np.abs(scaled @ weights), np.abs(scaled) @ np.abs(weights)
        none = least * np.linalg.norm(weights, axis=0)
        return bool(np.all(works <= np.maximum(1e-8 * gross, none)))

    def _Left(self, contacts, holds):
        """The motions that contact leaves, as columns of weights of all `combinations`."""
        rows = vstack([ActiveRows(contact, holds) for contact in contacts]).tocsr()
        prevented = [self._Jump(rows, part) @ motions for part, motions in self.floating]
        return NullSpace(np.concatenate(prevented, axis=1))

    def _Places(self):
        """Which of the floating bodies each of all combinations belongs to."""
        counts = [motions.shape[1] for _, motions in self.floating]
        return np.repeat(np.arange(len(counts)), counts)

    def Lost(self, values):
        """Descriptions of the bodies that displacements (n,) carry off like rigid ones.

        Farther than the size of the mesh, and far more than they deform.
        """
        lost = []
        for part, combinations in self.floating:
            own = np.flatnonzero(self.part == part)
            motions = self.motions[own] @ combinations
            moved = values[self.first + own]
            weights = np.linalg.lstsq(motions, moved)[0]
            rigid = motions @ weights
            far = np.max(np.abs(rigid)) > FAR * self.size
            if far and np.max(np.abs(moved - rigid)) < 0.2 * np.max(np.abs(rigid)):
                most = np.argmax(np.abs(combinations @ weights))
                lost.append(f"body {self.name(part)} moves off ({self.names[most]})")
        return lost

    def _Jump(self, rows, part):
        """What the constraints see of the rigid motions of one part."""
        columns = rows.indices - self.first
        own = (columns >= 0) & (columns < self.count)
        columns = np.where(own, columns, 0)
        values = rows.data * (own & (self.part[columns] == part))
        shape = rows.shape[0], self.count
        return csr_matrix((values, columns, rows.indptr), shape=shape) @ self.motions


def Forces(mat, first, count):
    """A function that multiplies with the rows and columns of the displacement, in threads."""
    factor, product = mat.CreateRowVector(), mat.CreateColVector()
    factor[:] = 0
    own = slice(first, first + count)

    def Times(values):
        factor.FV().NumPy()[own] = values
        product.data = mat * factor
        return product.FV().NumPy()[own].copy()

    return Times


def ConnectedParts(mat, first, count):
    """A number (count,) for each of some rows of a sparse matrix: the same where they connect.

    Parameters
    ----------
    mat : BaseMatrix
        With a symmetric pattern. Its graph is not copied.
    first, count : int
        The rows, and the columns that connect them.
    """
    columns, starts = Graph(mat, first, count)
    # Other rows are left empty, which makes each a strongly connected part of its own.
    starts = np.pad(starts, (first, mat.height - first - count), mode="edge")
    graph = csr_matrix((np.ones(len(columns)), columns, starts), shape=mat.shape)
    return connected_components(graph, connection="strong")[1][first : first + count]


def LikelyParts(mat, first, count):
    """The same or too many parts, from two entries of each row."""
    columns, starts = Graph(mat, first, count)
    ends = np.arange(count)[:, None].repeat(2, axis=1)
    filled = np.flatnonzero(np.diff(starts))
    found = columns[np.stack([starts[:-1], starts[1:] - 1], axis=1)[filled]] - first
    ends[filled] = np.where((found >= 0) & (found < count), found, ends[filled])
    starts = np.arange(0, 2 * count + 1, 2)
    graph = csr_matrix((np.ones(2 * count), ends.ravel(), starts), shape=(count, count))
    return connected_components(graph, directed=False)[1]


def Graph(mat, first, count):
    """Columns of some rows of a sparse matrix, which are not copied, and where each row starts."""
    _, columns, starts = (np.asarray(a) for a in mat.CSR())
    starts = starts[first : first + count + 1].astype(np.int64)
    return columns[starts[0] : starts[-1]], starts - starts[0]


def AreApart(part, forces, values, pushed):
    """Do the parts not act on each other? Tells it from forces(values) = pushed."""
    weights = np.random.default_rng(1).standard_normal(1 + part.max(initial=0))[part]
    sizes = np.zeros(1 + part.max(initial=0))
    np.maximum.at(sizes, part, np.abs(pushed))
    return bool(np.all(np.abs(forces(weights * values) - weights * pushed) <= 1e-12 * sizes[part]))


def CloseNearest(contacts, gf, floating):
    """Close macro-elements, the nearest first, until no body floats; False if that does not help.

    Farther contacts are left alone where the nearest ones hold all bodies.
    """
    for count in range(len(contacts)):
        for distance in (0.05, 0.1, 0.2, 0.4, 0.8):
            for contact in sorted(contacts, key=SmallestGap)[: count + 1]:
                # Without friction the tilted normals of distant macro-elements would only hide a
                # motion that is free.
                reach = distance if contact.holds_tangentially else 0.05
                contact.form.Close(NearestMacros(contact, reach), gf.vec)
                contact.Evaluate(gf)
            if not floating():
                return True
    return False


def SmallestGap(contact):
    """Relative to the mean size of the macro-elements."""
    table = contact.Table()
    size = (table["fullarea"] ** (1 / (contact.mesh.dim - 1))).mean()
    return abs(table["gap"][table["area"] > 0]).min(initial=np.inf) / size


def NearestMacros(contact, distance):
    """Macro-elements whose gap exceeds the smallest one by at most `distance` times their size."""
    table = contact.Table()
    paired = table["area"] > 0
    size = table["fullarea"] ** (1 / (contact.mesh.dim - 1))
    nearest = table["gap"][paired].min(initial=np.inf)
    return AsBits(paired & (table["gap"] <= nearest + distance * size))


def FloatingMessage(floating):
    return (
        "; ".join(floating)
        + ": no Dirichlet condition and no active contact holds it. Constrain it, start in "
        "contact, or prescribe a displacement in place of a force"
    )


def FewMessage(contacts):
    """Where there are so few macro-elements that bodies may turn on them; empty if nowhere."""
    few = [c for c in contacts if np.count_nonzero(c.Table()["area"]) < c.mesh.dim]
    return "".join(
        f". Contact number {contacts.index(c)} holds on average over "
        f"{np.count_nonzero(c.Table()['area'])} macro-elements only: refine its slave surface, or "
        "take BubbleVectorH1 for displacements of order 1"
        for c in few
    )


def SlidingMessage(floating):
    return (
        "no equilibrium is found: "
        + "; ".join(floating).replace(" floats (", " slides away (")
        + ": friction is at its limit wherever contact holds it. Constrain it, or prescribe a "
        "displacement in place of a force"
    )


def OverloadMessage(bodies):
    names = [bodies.name(part) for part, _ in bodies.floating[:3]]
    return (
        "nearly all closed macro-elements slip: the load seems to exceed what friction can carry"
        + (f" on body {' or '.join(names)}" if names else "")
        + ". Prescribe a displacement in place of a force to follow the sliding"
    )


def LostMessage(lost):
    return (
        "; ".join(lost)
        + ": the loads exceed what contact and friction can carry. Constrain it, or prescribe a "
        "displacement in place of a force"
    )


def ToCSR(mat):
    """A sparse NGSolve matrix with scalar or square block entries as scipy matrix."""
    block = mat.entrysizes[0]
    # CSR() shows memory of the matrix: copy, the matrix may be a temporary.
    values, columns, starts = (np.array(a) for a in mat.CSR())
    if block == 1:
        return csr_matrix((values, columns, starts), shape=mat.shape)
    return bsr_matrix((values.reshape(-1, block, block), columns, starts)).tocsr()


def ActiveRows(contact, holds="now"):
    """The constraints at work, as a scipy matrix on all scalar dofs, scaled by the areas.

    Parameters
    ----------
    contact : LACContact
    holds : {"now", "rubbing", "closed"}
        What contact prevents: nothing but approach where it slips; all motion where it rubs; or as
        if all of it were closed.
    """
    table, form = contact.Table(), contact.form
    d = contact.mesh.dim
    stick, slip = _AtWork(contact, table, holds)
    if not len(slip) and not np.any(stick):
        return csr_matrix((0, contact.nscalars))
    jump = JumpRows(contact)
    normals = csr_matrix(
        (
            table["normal"][slip].ravel(),
            (np.arange(len(slip)).repeat(d), (d * slip[:, None] + np.arange(d)).ravel()),
        ),
        shape=(len(slip), jump.shape[0]),
    )
    rows = vstack([jump[np.repeat(stick, d)], normals @ jump]).tocsr()
    columns = rows.indices + form.offset * form.fes.dim
    shape = rows.shape[0], contact.nscalars
    return csr_matrix((rows.data / table["fullarea"].mean(), columns, rows.indptr), shape=shape)


def _AtWork(contact, table, holds):
    """Macro-elements held in all directions (as mask), and along the normal only (numbers)."""
    closed = table["area"] > 0 if holds == "closed" else table["status"] > 0
    stick = closed & ((table["status"] == 1) | ((holds != "now") & contact.holds_tangentially))
    return stick, np.flatnonzero(closed & ~stick)


def ActiveRates(contact, rates):
    """What `ActiveRows` times the velocity is, if each mean gap changes with its obstacle alone.

    Parameters
    ----------
    contact : LACContact
    rates : (m,) array
        By which the obstacle opens the mean gaps (length per time).

    Returns
    -------
    (n,) array
        One for each row.
    """
    table = contact.Table()
    stick, slip = _AtWork(contact, table, "now")
    rates = rates * table["area"] / table["fullarea"].mean()
    return np.concatenate([(rates[:, None] * table["normal"])[stick].ravel(), rates[slip]])


def JumpRows(contact):
    """What each macro-element sees of a displacement, times its area: d rows of each, sparse."""
    return ToCSR(contact.form.JumpMatrix(Side.both))


def NullSpace(matrix, tolerance=TOLERANCE):
    """Orthonormal basis of the null space, relative to the size of the matrix or to 1."""
    if not matrix.shape[0]:
        return np.eye(matrix.shape[1])
    if matrix.shape[0] > matrix.shape[1]:
        matrix = np.linalg.qr(matrix, mode="r")
    _, singular, vectors = np.linalg.svd(matrix)
    rank = int(np.sum(singular > tolerance * max(1.0, singular.max(initial=0.0))))
    return vectors[rank:].T


def Norm(matrix):
    """The largest singular value of a tall matrix."""
    return np.sqrt(np.linalg.norm(matrix.T @ matrix, 2))
