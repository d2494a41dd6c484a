"""The frictional Hertz problem of the LAC paper: a cylinder is pressed on a block.

Plane strain, small strains. Cylinder of diameter 100 mm (E = 210 GPa) on a block of side 200 mm
(E = 70 GPa), nu = 0.3, friction 0.2, loaded by a force of 35 kN/mm at its top. The load
grows with the square of time, so that the contact grows by the same length in each step. Half of
the bodies is computed. Start it with::

    python tutorials/examples/hertz.py --out results

Hertz' solution (Johnson, Contact Mechanics, 1985, section 4.2) has no friction. Friction raises the
pressure at the origin by about 1.6 %.
"""

from types import SimpleNamespace
from typing import Literal

import numpy as np
from command import Main, NotNegative
from ngsolve import *
from pictures import Bodies, Curves, Show

from ngslac import *
from ngslac.materials import Stress
from ngslac.meshes import HertzMesh
from ngslac.reference import HertzLine

YOUNG = {"cylinder": 210e3, "block": 70e3}  # MPa
NU, RADIUS, FORCE = 0.3, 50.0, 35e3  # the latter in mm and N/mm
SIDES = {"cylinder": "slave", "block": "master"}  # names in the mesh


def Exact(t=1.0):
    """Hertz' solution at the load factor t."""
    one, two = YOUNG.values()
    return HertzLine(force=FORCE * t, radius1=RADIUS, young1=one, nu1=NU, young2=two, nu2=NU)


def Spans(mesh, macros):
    """First and last x of each macro-element, from the ends of its faces."""
    spans = np.full((max(macros) + 1, 2), (np.inf, -np.inf))
    for el, macro in zip(mesh.Elements(BND), macros, strict=True):
        if macro >= 0:
            x = [mesh.vertices[v.nr].point[0] for v in el.vertices]
            spans[macro] = min(spans[macro, 0], *x), max(spans[macro, 1], *x)
    return spans.T


def AtOrigin(state):
    """Which macro-elements touch the axis."""
    near = 1e-3 * (state["end"] - state["start"])
    return (state["start"] <= near) & (state["end"] >= -near)


def Figures(state):
    """What is compared with Hertz: the pressure at the origin, the edge of the contact, the force.

    The pressure of a macro-element is a mean: it is compared with the mean of Hertz' pressure.
    Beside it the norm of the tangential traction over that of friction times pressure.
    """
    start, end, first = state["start"], state["end"], AtOrigin(state)
    exact = Exact(state["time"]).MeanPressure(start[first], end[first])
    return {
        "p0_ratio": float(np.mean(state["pressure"][first] / exact)),
        "contact_edge": float(end[state["status"] > 0].max(initial=0)),
        "force_ratio": state["force_ratio"],
        "friction_used": state["friction_used"],
    }


def Run(
    order: Literal[1, 2, 3] = 2, h=0.2, friction: NotNegative = 0.2, steps=31,
    power: Literal[1, 2] = 2, stabilize: Literal["split", "bubble", "none"] = "none",
    slave: Literal["cylinder", "block"] = "cylinder", finite=False, full=False, out=None
):  # fmt: skip
    """Press the cylinder down; the solution has the macro-elements in the order of x in `states`.

    Order 1 has macro-elements of two faces, unless they are stabilized.

    order : order of the displacement
    h : edge length in the contact zone, in mm
    friction : coefficient of friction
    steps : load steps
    power : of the load: 1 equal steps, 2 equal growth of the contact
    stabilize : of order 1
    slave : body with the multipliers
    finite : large sliding
    full : the full model in place of the half
    """
    side, other = SIDES[slave], SIDES["block" if slave == "cylinder" else "cylinder"]
    mesh = HertzMesh(h, order=max(2, order), half=not full)
    mesh = SplitSlaveFaces(mesh, side) if stabilize == "split" else mesh
    held = {"dirichletx": "bottom" if full else "bottom|sym", "dirichlety": "bottom"}
    if stabilize == "bubble":
        V = BubbleVectorH1(mesh, order=order, slave=side, **held)
    else:
        V = VectorH1(mesh, order=order, **held)
    X = V * LACSpace(V, slave=side)
    (u, lam), (v, _) = X.TnT()
    t, a, gf = Parameter(0.0), BilinearForm(X), GridFunction(X)
    young = mesh.MaterialCF(YOUNG)
    a += InnerProduct(Stress(Sym(Grad(u)), young, NU), Sym(Grad(v))) * dx
    load = FORCE * (1 if full else 0.5)
    a += t**power * load * v[1] * ds(definedon=mesh.BBoundaries("load"))
    if full:  # springs against rolling, without force by symmetry
        a += YOUNG["cylinder"] * u[0] * v[0] * ds(definedon=mesh.BBoundaries("load|foot"))
    contact = LACContact(u, lam, master=other, friction=friction or None, finite=finite)
    start, end = Spans(mesh, X.components[1].macros)
    order, states = np.argsort(start), []

    def Note(step):
        table, factor = contact.Table(), step.time**power
        traction, normal = table["traction"], table["normal"]
        tangential = normal[:, 0] * traction[:, 1] - normal[:, 1] * traction[:, 0]
        columns = {"start": start, "end": end, "status": table["status"].astype(int)}
        columns |= {"pressure": table["pressure"], "traction": tangential}
        state = {name: column[order] for name, column in columns.items()}
        rubbed, most = (
            np.sqrt((end - start)[order] @ state[f] ** 2) for f in ("traction", "pressure")
        )
        state["friction_used"] = float(rubbed / most / friction) if friction else 0.0
        state["force_ratio"] = float(abs(contact.Force()[1]) / (load * factor))
        states.append(state | {"time": factor, "iterations": step.iterations})

    with TaskManager():
        stepper = LoadStepper(ContactSolver(a, gf, contact), t)
        stepper.Integrate(steps=steps, callback=Note, printing=False)
    moved = gf.components[0]
    iterations, last = [state["iterations"] for state in states], states[-1]
    figures = Figures(last)
    print(f"Newton iterations {iterations}")
    print(f"pressure at the origin {figures['p0_ratio']:.4f} of Hertz' {Exact().peak:.1f} MPa")
    print(f"contact up to {figures['contact_edge']:.3f} mm, Hertz {Exact().halfwidth:.3f} mm")
    print(f"contact force {figures['force_ratio']:.12f} of the load")
    print(f"tangential traction {figures['friction_used']:.4f} of its bound, in L2")
    assert abs(figures["force_ratio"] - 1) < 1e-8, figures
    assert abs(figures["p0_ratio"] - 1) < 0.02 + 0.05 * h, figures
    assert abs(figures["contact_edge"] - Exact().halfwidth) < 2.5 * h, figures
    assert figures["friction_used"] < 1 + 1e-6, figures

    if out:
        near = abs(last["end"]) < 7
        middle = (last["start"] + last["end"])[near] / 2
        pressure, traction = last["pressure"][near], last["traction"][near]
        x = np.linspace(0, 7, 500)
        pressures = {"Hertz, without friction": (x, Exact().Pressure(x), "k-")}
        tractions = {"friction × pressure": (middle, friction * pressure, "k--")}
        pressures["computed"], tractions["computed"] = (
            (middle, pressure, "o"), (middle, abs(traction), "o"))  # fmt: skip
        place, S = "distance from the middle [mm]", Stress(Sym(Grad(moved)), young, NU)
        shear = sqrt((S[0, 0] - S[1, 1]) ** 2 / 4 + S[0, 1] ** 2)
        Show(out, "hertz", moved,
             Bodies(moved, shear, "largest shear stress [MPa]",
                    window=(-12, 12, -12, 12), mirrored=not full),
             Curves(place, "pressure [MPa]", **pressures),
             Curves(place, "tangential traction [MPa]", **tractions), slave=contact)  # fmt: skip
        fields = {"displacement": moved, "stress": S}
        VTKOutput(mesh, [*fields.values()], [*fields], str(out / "hertz"), order=2).Do()
    solution = SimpleNamespace(mesh=mesh, displacement=moved, contact=contact, states=states)
    return figures | {"newton_iterations": iterations, "solution": solution}


main = Main(Run)
