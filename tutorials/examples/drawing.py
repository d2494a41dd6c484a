"""Deep drawing of a channel: a punch draws a sheet over a die, and a holder presses on its rim.

Plane strain, one half, large plastic strains. Punch, die and holder are tools: polygons with round
corners. The punch goes down on a path; the holder is moved by a force, so that its travel is an
unknown of the problem. Start it with::

    python tutorials/examples/drawing.py --out results

All forces balance: the die carries what punch and holder press, and the holder presses with the
force that is given, to the tolerance of the solver.
"""

from command import Main, NotNegative
from netgen.occ import OCCGeometry, WorkPlane
from ngsolve import *
from pictures import Bodies, Curves, Show
from plasticity import J2Plasticity, LogStrain

from ngslac import *
from ngslac.tools import Polygon

WIDTH, THICKNESS = 1.0, 0.06  # of the half of the sheet
PUNCH, DIE, CORNER = 0.4, 0.48, 0.12  # where the punch ends and the die begins; radius of corners
FAR = 3.0  # where tools end
SIDES = "die", "punch", "holder"


def Round(left, right, low, high):
    """A rectangle whose corners are round."""
    left, right, low, high = left + CORNER, right - CORNER, low + CORNER, high - CORNER
    return Polygon([(left, low), (right, low), (right, high), (left, high)]).Grown(CORNER)


def Sheet(h):
    """Its lower side is "die", the upper one "punch" and "holder"."""
    split = (PUNCH + DIE) / 2 + CORNER / 2
    plane = WorkPlane().Line(WIDTH, "die").Rotate(90).Line(THICKNESS, "rim").Rotate(90)
    plane.Line(WIDTH - split, "holder").Line(split, "punch").Rotate(90).Line(THICKNESS, "middle")
    return Mesh(OCCGeometry(plane.Face(), dim=2).GenerateMesh(maxh=h))


def Run(h=0.04, depth=0.15, steps=30, friction: NotNegative = 0.1, force=10.0, out=None):
    """Draw the sheet.

    h : edge length
    depth : way of the punch
    steps : steps
    friction : coefficient
    force : of the holder
    """
    mesh = Sheet(h)
    V = X = VectorH1(mesh, order=2, dirichletx="middle")
    for side in SIDES:
        X = X * LACSpace(V, slave=side)
    X = X * NumberSpace(mesh)
    u, *lams, travel = X.TrialFunction()
    material = J2Plasticity(mesh, young=70e3, poisson=0.3, yield_stress=200.0, hardening=200.0)
    a, gf, down = BilinearForm(X), GridFunction(X), Parameter(0.0)
    a += Variation(material.Energy(LogStrain(Grad(u))) * dx(intrules=material.rules))
    top, push = THICKNESS + FAR, {"travel": (None, travel), "force": (0, -force)}
    tools = (
        Round(DIE, FAR, -FAR, 0),
        Round(-FAR, PUNCH, THICKNESS, top).Moved(shift=(0, -down)),
        Round(DIE, FAR, THICKNESS, top).Driven(**push),
    )
    contacts = [
        LACContact(u, lam, obstacle=tool, finite=True, friction=friction)
        for lam, tool in zip(lams, tools, strict=True)
    ]
    moved = gf.components[0]
    stepper = LoadStepper(ContactSolver(a, gf, contacts), down)
    strain = LogStrain(Grad(moved))
    flags = {"printing": False, "callback": lambda _: material.Commit(strain)}
    stepper.Integrate(depth, steps=steps, **flags)

    table = stepper.Table()
    forces = dict(zip(SIDES, table["force"][..., 1].T, strict=True))  # on the sheet, upwards
    last = {side: values[-1] for side, values in forces.items()}
    balance = abs(sum(last.values())) / last["die"]
    draw_in = -moved(mesh(WIDTH, THICKNESS / 2))[0]
    print(f"draw-in {draw_in:.4f}, force of the punch {-last['punch']:.4f}")
    print(f"force of the holder {-last['holder']:.6f}, error of the balance {balance:.1e}")
    assert draw_in > 0 > last["punch"]
    assert abs(last["holder"] / force + 1) < 1e-6
    assert balance < 1e-6

    curves = {side: (table["load"], values, ".-") for side, values in forces.items()}
    Show(out, "drawing", moved, Bodies(moved), Curves("depth", "force, upwards", **curves),
         die=contacts[0])  # fmt: skip
    figures = {"balance": balance, "draw_in": draw_in}
    return figures | {"punch_force": -last["punch"], "holder_force": -last["holder"]}


main = Main(Run)

if __name__ == "__main__":
    main()
