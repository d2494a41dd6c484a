"""Where the faces of both surfaces are: ``mpiexec -n 3 python tests/parallel/where.py``.

A line for each mesh of the cases with the faces of each rank; slave and master of the first ones
are on different ranks.
"""

import inspect

import parallel_shapes
from mpi4py import MPI
from ngsolve import BND

OTHER = {"meshed", "pair_in_space"}


def shapes():
    """The functions that make a mesh, by their names."""
    made = inspect.getmembers(parallel_shapes, inspect.isfunction)
    return {
        name: make
        for name, make in made
        if name not in OTHER and "comm" in inspect.signature(make).parameters
    }


def faces(mesh, pattern):
    """How many faces of this rank match."""
    mask = mesh.Boundaries(pattern).Mask()
    return sum(mask[element.index] for element in mesh.Elements(BND))


def main():
    comm = MPI.COMM_WORLD
    for name, make in shapes().items():
        mesh = make(comm)
        here = mesh.ne, faces(mesh, "slave.*"), faces(mesh, "master")
        elements, slave, master = zip(*comm.allgather(here), strict=True)
        if comm.rank == 0:
            print(f"{name:20} elements {elements}, slave {slave}, master {master}")


if __name__ == "__main__":
    main()
