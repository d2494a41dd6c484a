"""The frictional Hertz problem of the LAC paper: a cylinder is pressed on a block.

Plane strain, small strains. Cylinder of diameter 100 mm (E = 210 GPa) on a block of side 200 mm
(E = 70 GPa), nu = 0.3, friction 0.2, loaded by a force of 35 kN/mm at its top. The load
grows with the square of time, so that the contact grows by the same length in each step. Half of
the bodies is computed. Start it with::

    python tutorials/examples/hertz.py --out results

Hertz' solution (Johnson, Contact Mechanics, 1985, section 4.2) has no friction. Friction raises the
pressure at the origin by about 1.6 %.
"""

import math

import numpy as np
from command import Count, Main, Mosaic, NotNegative, Positive
from deformed import Smooth
from ngsolve import *

from ngslac import BubbleVectorH1, ContactSolver, LACContact, LACSpace, LoadStepper, SplitSlaveFaces
from ngslac.materials import Stress
from ngslac.meshes import HertzMesh
from ngslac.reference import HertzLine

YOUNG = {"cylinder": 210e3, "block": 70e3}  # MPa
NU, RADIUS, FORCE = 0.3, 50.0, 35e3  # the latter in mm and N/mm
SIDES = {"cylinder": "slave", "block": "master"}  # names in the mesh


def Exact(t=1.0):
    """Hertz' solution at the load factor t."""
    one, two = YOUNG["cylinder"], YOUNG["block"]
    return HertzLine(force=FORCE * t, radius1=RADIUS, young1=one, nu1=NU, young2=two, nu2=NU)


def Displacements(slave, order=2, h=0.5, stabilize="none", full=False, **placed):
    """Their space, held at the bottom and on the line of symmetry.

    Order 1 has macro-elements of two faces, unless `stabilize` is "bubble" or "split".
    """
    mesh = HertzMesh(h, order=max(2, order), half=not full, **placed)
    flags = {"order": order, "dirichletx": "bottom|sym", "dirichlety": "bottom"}
    if stabilize == "bubble":
        return BubbleVectorH1(mesh, slave=slave, **flags)
    return VectorH1(SplitSlaveFaces(mesh, slave) if stabilize == "split" else mesh, **flags)


class Hertz:
    """Bodies, load and solver; `states` has an entry for each load step.

    One millimetre is `length` and one MPa `stress` in the units of the computation, and the full
    model can be turned by `angle` in degrees: the states, in mm and MPa, do not depend on these.
    The load is the `power` of the load parameter; with 2 the contact grows evenly.
    """

    def __init__(
        self,
        *,
        friction=0.2,
        slave="cylinder",
        finite=False,
        full=False,
        length=1.0,
        stress=1.0,
        angle=0.0,
        power=1,
        **options,
    ):
        if angle and not full:
            raise ValueError(f"angle = {angle}: the half model cannot be turned, use full=True")
        c, s = math.cos(math.radians(angle)), math.sin(math.radians(angle))
        self.frame = np.array([[c, s], [-s, c]])  # directions along the block, and up
        self.length, self.unit, self.friction, self.states = length, stress, friction, []
        self.load, self.power = FORCE * length * stress * (1 if full else 0.5), power
        side, other = SIDES[slave], SIDES["block" if slave == "cylinder" else "cylinder"]
        V = Displacements(side, full=full, scale=length, angle=angle, **options)
        self.mesh, X = V.mesh, V * LACSpace(V, slave=side)
        (u, lam), (v, _) = X.TnT()
        t, self.gf = Parameter(0.0), GridFunction(X)
        self.displacement = self.gf.components[0]
        young = self.mesh.MaterialCF({name: E * stress for name, E in YOUNG.items()})
        right, up = (CF(tuple(direction)) for direction in self.frame)
        a = BilinearForm(X)
        a += InnerProduct(Stress(Sym(Grad(u)), young, NU), Sym(Grad(v))) * dx
        line = ds(definedon=self.mesh.BBoundaries("load"))
        a += t**power * self.load * InnerProduct(up, v) * line
        if full:  # springs against rolling, without force by symmetry
            axis = ds(definedon=self.mesh.BBoundaries("load|foot"))
            a += YOUNG["cylinder"] * stress * InnerProduct(right, u) * InnerProduct(right, v) * axis
        self.stress = Stress(Sym(Grad(self.displacement)), young, NU)
        self.shear = sqrt((self.stress[0, 0] - self.stress[1, 1]) ** 2 / 4 + self.stress[0, 1] ** 2)
        self.contact = LACContact(u, lam, master=other, friction=friction or None, finite=finite)
        self.stepper = LoadStepper(ContactSolver(a, self.gf, self.contact), t)
        self.spans = self._Spans(X.components[1].macros)

    def _Spans(self, macros):
        """First and last x of each macro-element, from the ends of its faces."""
        spans = np.full((max(macros) + 1, 2), (np.inf, -np.inf))
        for el, macro in zip(self.mesh.Elements(BND), macros, strict=True):
            if macro >= 0:
                points = np.array([self.mesh.vertices[v.nr].point for v in el.vertices])
                x = points @ self.frame[0] / self.length
                spans[macro] = min(spans[macro, 0], x.min()), max(spans[macro, 1], x.max())
        return spans

    def Press(self, steps, printing=False):
        """Apply the load in equal steps."""
        with TaskManager():
            self.stepper.Integrate(steps=steps, callback=self._Record, printing=printing)

    def _Record(self, step):
        """Macro-elements in the order of x, in mm and MPa."""
        table = self.contact.Table()
        traction, normal = (table[name] @ self.frame.T for name in ("traction", "normal"))
        tangential = normal[:, 0] * traction[:, 1] - normal[:, 1] * traction[:, 0]
        (start, end), order = self.spans.T, np.argsort(self.spans[:, 0])
        columns = {"start": start, "end": end, "status": table["status"].astype(int)}
        columns |= {"pressure": table["pressure"] / self.unit, "traction": tangential / self.unit}
        state = {name: column[order] for name, column in columns.items()}
        rubbed, most = (
            np.sqrt((end - start)[order] @ state[f] ** 2) for f in ("traction", "pressure")
        )
        state["friction_used"] = float(rubbed / most / self.friction) if self.friction else 0.0
        factor = step.time**self.power
        force = abs(self.frame[1] @ self.contact.Force()) / (self.load * factor)
        state |= {"time": factor, "iterations": step.iterations, "force_ratio": float(force)}
        self.states.append(state)


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


def ShowBodies(axes, problem, wide):
    """The largest shear stress in both bodies about the contact, deformed and mirrored."""
    points, faces, (moved, shear) = Smooth(problem.mesh, (problem.displacement, problem.shear))
    place, shear = points + moved, shear.ravel()
    faces = faces[np.all(np.abs(place[faces]) < 1.4 * wide, axis=(1, 2))]
    levels = np.linspace(0, shear[faces].max(), 25)
    for sign in (-1, 1):
        half = sign * place[:, 0], place[:, 1], faces
        filled = axes.tricontourf(*half, shear, levels=levels, cmap="turbo")
    bar = axes.figure.colorbar(filled, ax=axes, location="bottom", shrink=0.8, pad=0.03, aspect=40)
    bar.set_label("largest shear stress [MPa]")
    bar.set_ticks(range(0, int(levels[-1]), 250))
    for height, body in (0.9, "steel cylinder"), (-0.94, "aluminium block"):
        axes.text(-0.96 * wide, height * wide, body, va="center")
    axes.set(xlim=(-wide, wide), ylim=(-wide, wide), aspect="equal")
    axes.axis("off")


def ShowTractions(upper, lower, problem):
    """Pressure and tangential traction of the macro-elements, each at its middle."""
    x, last = np.linspace(0, 7, 1000), problem.states[-1]
    near = last["start"] < x[-1]
    middle, dots = ((last["start"] + last["end"]) / 2)[near], {"ms": 4, "color": "#c2185b"}
    bound = problem.friction * last["pressure"][near]
    upper.plot(x, Exact().Pressure(x), "k", lw=1, label="Hertz, without friction")
    upper.plot(middle, last["pressure"][near], "o", label="computed", **dots)
    lower.plot(middle, bound, "k--", lw=1, label="friction × pressure")
    lower.plot(middle, np.abs(last["traction"][near]), "o", label="computed", **dots)
    upper.set_title("pressure [MPa]", loc="left")
    lower.set_title("tangential traction [MPa]", loc="left")
    lower.set(xlabel="distance from the middle [mm]")
    for axes in upper, lower:
        axes.set(xlim=(0, x[-1]), ylim=0)
        axes.grid(alpha=0.25)
        axes.spines[["top", "right"]].set_visible(False)
        axes.legend(frameon=False, loc="upper right")


def Show(problem, folder):
    """Stress in the bodies beside pressure and traction between them."""
    layout = [["bodies", "pressure"], ["bodies", "traction"]]
    with Mosaic(folder, "hertz", layout, size=(10.5, 5), width_ratios=[1, 1.2]) as axes:
        ShowBodies(axes["bodies"], problem, 12)
        ShowTractions(axes["pressure"], axes["traction"], problem)


def Write(problem, folder):
    """A picture; the bodies and their surface for ParaView."""
    Show(problem, folder)
    problem.contact.WriteVTU(folder / "hertz_slave", displacement=problem.displacement)
    fields = {"displacement": problem.displacement, "stress": problem.stress}
    VTKOutput(problem.mesh, [*fields.values()], [*fields], str(folder / "hertz"), order=2).Do()


def Run(steps=31, h=0.2, power=2, out=None, quiet=True, **options):
    """Press the cylinder down; the options are those of `Hertz`. Returns the numbers of the end."""
    problem = Hertz(h=h, power=power, **options)
    problem.Press(steps, printing=not quiet)
    iterations = [state["iterations"] for state in problem.states]
    figures = Figures(problem.states[-1]) | {
        "newton_iterations": iterations,
        "newton_max": max(iterations),
        "ndof": len(problem.gf.vec),
    }
    assert abs(figures["force_ratio"] - 1) < 1e-8, figures
    if out:
        Write(problem, out)
    if not quiet:
        print(f"{figures['ndof']} unknowns, Newton iterations {iterations}")
        print(f"pressure at the origin {figures['p0_ratio']:.4f} of Hertz' {Exact().peak:.1f} MPa")
        print(f"contact up to {figures['contact_edge']:.3f} mm, Hertz {Exact().halfwidth:.3f} mm")
        print(f"contact force {figures['force_ratio']:.12f} of the load")
        print(f"tangential traction {figures['friction_used']:.4f} of its bound, in L2")
    return figures


main = Main(
    Run,
    __doc__,
    Displacements,
    Hertz,
    order=((1, 2, 3), "order of the displacement"),
    h=(Positive, "edge length in the contact zone, in mm"),
    friction=(NotNegative, "coefficient of friction"),
    steps=(Count, "load steps"),
    power=((1, 2), "of the load: 1 equal steps, 2 equal growth of the contact"),
    stabilize=(("split", "bubble", "none"), "of order 1"),
    slave=(tuple(SIDES), "body with the multipliers"),
    finite=(bool, "large sliding"),
    full=(bool, "the full model in place of the half"),
)


if __name__ == "__main__":
    main()
