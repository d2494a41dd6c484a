"""Table of the rates with large deformation (T09): python tests/validation/mms_large_table.py

Relative errors of the displacement and of the pressure in L2 on three meshes, and the rates of the
last refinement, against the ones published for Local Average Contact. See problems_mms_large.py.
"""

import argparse

from problems_mms_large import Case, Manufactured, Rates

# case -> published rates (displacement, pressure) of the element that is nearest to it
PUBLISHED = {
    Case("tet", 1, "split"): ("TETRA4", 1.953, 1.282),
    Case("hex", 1, "hexes"): ("HEXA8, hexahedra", 1.990, 1.887),
    Case("hex", 1, "split"): ("HEXA8, pyramids", 1.988, 1.866),
    Case("prism", 1, "split"): ("PENTA6", 1.957, 1.881),
    Case("tet", 2): ("TETRA10", 2.996, 1.994),
    Case("hex", 2): ("HEXA27", 2.999, 1.016),
    Case("prism", 2): ("PENTA15", 3.933, 2.050),
}
LEVELS = {1: (3, 6, 12), 2: (2, 3, 6)}


def main(argv=None):
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--coarse", action="store_true", help="without the finest mesh")
    options = parser.parse_args(argv)
    head = ("case", "n", "dofs", "iter.", "displacement", "pressure", "rates", "published")
    print("{:16s}{:>4s}{:>8s}{:>6s}{:>14s}{:>12s}{:>12s}  {}".format(*head))
    for case, (name, *published) in PUBLISHED.items():
        levels = LEVELS[case.order][: 2 if options.coarse else 3]
        errors = []
        for n in levels:
            problem = Manufactured(case, n)
            iterations = problem.Solve().number
            errors.append(problem.errors)
            values = "".join(f"{errors[-1][key]:{w}.3e}" for key, w in WIDTHS.items())
            line = f"{case.name:16s}{n:4d}{problem.gf.space.ndof:8d}{iterations:6d}{values}"
            if len(errors) > 1:
                rates = Rates(levels[len(errors) - 2 : len(errors)], errors[-2:])
                line += "".join(f"{rates[key]:6.2f}" for key in WIDTHS)
            if n == levels[-1]:
                line += f"  {published[0]:.2f} {published[1]:.2f} ({name})"
            print(line, flush=True)


WIDTHS = {"displacement": 14, "pressure": 12}

if __name__ == "__main__":
    main()
