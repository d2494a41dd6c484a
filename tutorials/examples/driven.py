"""A body that is driven by a boundary, for the examples with large steps."""

import numpy as np


def RigidMotion(V, *, body, driven, target):
    """For `LoadStepper`: moves all of a body until its boundary `driven` is displaced by target().

    Moving the boundary alone would crush the elements at it in the start of Newton's method. Where
    the extrapolation of the last steps has put the boundary in its place, nothing is moved.
    """

    def Vertices(region):
        numbers = {v.nr for element in region.Elements() for v in element.vertices}
        return np.array(sorted(numbers), dtype=int)

    moved = Vertices(V.mesh.Materials(body))
    leader = Vertices(V.mesh.Boundaries(driven))[:1]
    comm = V.mesh.comm  # a process of a distributed mesh may have nothing of the boundary

    def Move(gf):
        values = gf.components[0].vec.FV().NumPy()
        for k, wanted in enumerate(target()):
            first = V.Range(k).start
            # Vertex functions add up to 1; those of edges and faces do not take part.
            reached = comm.Max(float(values[first + leader].max(initial=-np.inf)))
            values[first + moved] += wanted - reached

    return Move
