"""Refused input, the data of the benchmarks, and their examples."""

import doctest
from dataclasses import replace
from importlib import import_module
from math import inf, nan
from pathlib import Path

import exact_disc
import exact_signorini
import exact_slab
import exact_spence
import lubkin
import numpy as np
import published
import pytest
from exact_disc import ElasticSignoriniDisc
from exact_signorini import ElasticSignorini, ScalarSignorini
from exact_slab import GRECO_SLAB
from exact_spence import SpenceLine, StickZone
from lubkin import TwistPoint

from ngslac import reference
from ngslac.reference import (
    CattaneoMindlin,
    CattaneoMindlinPoint,
    ContactModulus,
    DundursBeta,
    HertzLine,
    HertzPoint,
)

PAIR = dict(radius1=30, radius2=60, young1=2e4, nu1=0.25, young2=2e4, nu2=0.25)
LINE, POINT = HertzLine(force=120, **PAIR), HertzPoint(force=120, **PAIR)
SLIP = CattaneoMindlin(hertz=LINE, shear=10.0, friction=0.2)
ROUND = CattaneoMindlinPoint(hertz=POINT, shear=10.0, friction=0.2)
TWIST = TwistPoint(hertz=POINT, moment=1.0, friction=0.2)
SPENCE, ZONE = SpenceLine(hertz=LINE, friction=0.2), StickZone(beta=0.1, friction=0.2)
SCALAR = ScalarSignorini()
ELASTIC = ElasticSignorini(young1=1.0, nu1=0.3, young2=1.0, nu2=0.3)
DISC = ElasticSignoriniDisc(young1=1.0, nu1=0.3, young2=1.0, nu2=0.3)

FIELDS = [  # a state, its fields, and values that they cannot have
    (LINE, "force", (0.0, -1.0, nan, inf)),
    (POINT, "force radius1", (0.0, -50.0, nan)),
    (LINE, "radius1 radius2 young1 young2", (0.0, -50.0, nan)),
    (LINE, "nu1 nu2", (0.5, -1.0, 0.6, nan)),
    (SLIP, "friction", (-0.1, nan, inf)),
    (SLIP, "shear", (nan, inf)),
    (ROUND, "friction shear", (nan,)),
    (TWIST, "friction moment", (nan, inf)),
    (SPENCE, "friction", (-0.2, nan, inf)),
    (ZONE, "friction beta", (nan, inf)),
    (SCALAR, "tip", (nan, inf)),
    (ELASTIC, "young1 young2 strength", (0.0, -1.0, inf)),
    (ELASTIC, "nu1 nu2", (0.5,)),
    (ELASTIC, "tip", (inf,)),
    (DISC, "radius strength young1", (0.0, -1.0)),
    (DISC, "nu2", (0.5,)),
    (GRECO_SLAB, "young friction", (-1.0,)),
    (GRECO_SLAB, "side_pressure", (nan,)),
]
LINEUP = [[0, 0], [1, 1], [2, 2]]
CALLS = [  # a call, and what it says
    (
        lambda: replace(LINE, radius1=inf, radius2=inf),
        r"radius2 = inf .*: surface 1 is flat .*give",
    ),
    (lambda: ContactModulus(young1=-1.0, nu1=0.3), r"young1 = -1\.0 is not valid"),
    (lambda: DundursBeta(young1=inf, nu1=0.3), r"young2 = inf is not valid: body 1 is rigid"),
    (lambda: DundursBeta(young1=1.0, nu1=0.3, young2=1.0, nu2=0.5), r"nu2 = 0\.5 is not valid"),
    (lambda: replace(SLIP, shear=25.0), r"shear = .* would slide, keep .* 24\.0"),
    (lambda: replace(ROUND, shear=-25.0), r"shear = .* would slide, keep .* 24\.0"),
    (lambda: replace(SLIP, hertz=replace(LINE, young2=1e4)), r"hertz = .*the same material"),
    (lambda: replace(ROUND, hertz=replace(POINT, young2=1e4)), r"hertz = .*the same material"),
    (lambda: SLIP.Reverse(10.1), r"shear = .* <= \|start\.shear\| = 10\.0"),
    (lambda: ROUND.Reverse(-10.1), r"shear = .* <= \|start\.shear\| = 10\.0"),
    (lambda: SLIP.Reverse(nan), r"shear = nan"),
    (lambda: replace(LINE, force=10**400), r"force is too large for a float: give"),
    (lambda: LINE.MeanPressure([0, 1], [1, 2, 3]), r"x1 = .* give ends of one shape, x0 has \(2,"),
    (lambda: TWIST.Reverse(1.01), r"moment = .* \|start\.moment\|"),
    (lambda: replace(TWIST, moment=-1.001 * TWIST.limit), r"moment = .* would turn freely, keep"),
    (
        lambda: CattaneoMindlinPoint.FromShift(hertz=POINT, shift=1.0, friction=0.2),
        r"shift = 1\.0 is not valid: the bodies would slide",
    ),
    (lambda: TwistPoint.FromAngle(hertz=POINT, angle=nan, friction=0.2), r"angle = nan is not"),
    (lambda: HertzPoint.FromApproach(approach=-1.0, **PAIR), r"approach = -1\.0 is not valid"),
    (lambda: POINT.Pressure(nan), r"r = nan is not valid: give finite"),
    (lambda: DISC.Gap(nan), r"r = nan is not valid"),
    (lambda: TWIST.Traction([0.0, nan]), r"r = .* is not valid: give finite"),
    (lambda: ROUND.Slip(0.0, nan), r"y = .* is not valid: give finite"),
    (lambda: POINT.AxisStress([1.0, -1.0]), r"depth = -1\.0 is not valid"),
    (lambda: POINT.AxisStress(1.0, body=3), r"body = 3 is not valid"),
    (lambda: SCALAR.Value(0.0, 0.0, body=3), r"body = 3 is not valid: give 1"),
    (lambda: ELASTIC.Stress(0.0, 0.0, body=0), r"body = 0"),
    (lambda: DISC.Displacement(0.0, 0.0, 0.0, body=3), r"body = 3 is not valid"),
    (lambda: POINT.MeanPressure([[0, 0], [1, 1]]), r"shape \(2, 2\) are not valid.*corners, 2"),
    (lambda: POINT.MeanPressure(LINEUP), r"(?s)vertices = .*nonzero area"),
    (lambda: TWIST.MeanTraction(LINEUP), r"(?s)vertices = .*nonzero area"),
    (
        lambda: replace(GRECO_SLAB, published=(1.0, 2.0)),
        r"published = .* one value for each of the 5",
    ),
    (lambda: GRECO_SLAB.Errors(GRECO_SLAB.converged, reference="mine"), r"reference = 'mine' is"),
]


@pytest.mark.parametrize(("state", "names", "values"), FIELDS)
def test_fields_are_checked(state, names, values):
    for name in names.split():
        for value in values:
            with pytest.raises(ValueError, match=rf"{name} = {value} is not valid: .*give"):
                replace(state, **{name: value})


@pytest.mark.parametrize(("call", "text"), CALLS)
def test_refused(call, text):
    with pytest.raises(ValueError, match=text):
        call()


def test_converged_slab_agrees_with_the_published_one():
    """Within the 5 % of the verification case; four of five within 0.5 %."""
    slab = GRECO_SLAB
    errors = np.abs(slab.Errors(slab.converged, reference="published"))
    assert (errors < 0.05).all()
    assert (np.sort(errors)[:4] < 0.005).all()
    assert (slab.Errors(slab.converged) == 0).all()
    free = slab.FrictionlessDisplacement(slab.abscissae)  # friction holds it back
    assert (np.maximum(slab.converged, slab.published) < free).all()
    assert (np.diff(slab.converged) < 0).all()
    assert max(slab.abscissae) < slab.slip_end < slab.width
    assert 0 < slab.open_end < slab.slip_end


def test_frictionless_slab_satisfies_hooke_and_the_loads():
    strain = GRECO_SLAB.FrictionlessDisplacement(0) / -GRECO_SLAB.width
    sxx, syy, young, nu = -15e7, -5e7, 1.3e11, 0.2
    szz = nu * (sxx + syy)  # plane strain
    assert strain == pytest.approx((sxx - nu * (syy + szz)) / young, rel=1e-12)
    assert GRECO_SLAB.FrictionlessDisplacement(GRECO_SLAB.width) == 0


MODULES = [exact_disc, exact_signorini, exact_slab, exact_spence, lubkin, published]


@pytest.mark.parametrize("module", MODULES)
def test_examples_of_modules(module):
    result = doctest.testmod(module, extraglobs=vars(reference))
    assert result.failed == 0
    assert result.attempted > 0


@pytest.mark.parametrize("name", reference.MOVED)
def test_names_that_moved_say_where_they_are(name):
    """Also where they are imported by name; the file has them."""
    file = reference.MOVED[name]
    with pytest.raises(ImportError, match=rf"after version 0\.1\.0: copy the file {file}"):
        exec(f"from ngslac.reference import {name}", {})
    assert hasattr(import_module(Path(file).stem), name)
    assert not hasattr(reference, f"{name}s")


def test_a_number_may_be_an_array_without_dimensions():
    assert HertzLine(force=np.array(120.0), **PAIR) == LINE
