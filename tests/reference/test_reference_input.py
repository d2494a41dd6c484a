"""Refused input, and the examples of the docstrings."""

import doctest
import importlib
import pkgutil
from dataclasses import FrozenInstanceError, replace
from math import inf, nan

import numpy as np
import pytest

import ngslac.reference as reference
from ngslac.reference import (
    GRECO_SLAB,
    CattaneoMindlin,
    ContactModulus,
    DundursBeta,
    ElasticSignorini,
    ScalarSignorini,
    SpenceLine,
    StickZone,
)


@pytest.mark.parametrize(
    ("name", "value"),
    [
        *(("force", bad) for bad in (0.0, -1.0, nan, inf)),
        *(("radius1", bad) for bad in (0.0, -50.0, nan, inf)),
        *(("radius2", bad) for bad in (0.0, -50.0, nan)),
        *(("young2", bad) for bad in (0.0, -1.0, nan)),
        *(("nu1", bad) for bad in (0.5, -1.0, 0.6, nan)),
    ],
)
def test_hertz_refuses(seed, name, value):
    blamed = "radius2" if (name, value) == ("radius1", inf) else name  # both are flat
    with pytest.raises(ValueError, match=rf"{blamed} = .*{value}.* is not valid: .*give"):
        replace(seed, **{name: value})


@pytest.mark.parametrize("function", [ContactModulus, DundursBeta])
def test_elastic_constants_refuse(function):
    with pytest.raises(ValueError, match=r"young1 = -1\.0 is not valid"):
        function(young1=-1.0, nu1=0.3)
    with pytest.raises(ValueError, match=r"young2 = inf is not valid: body 1 is rigid"):
        function(young1=inf, nu1=0.3)
    with pytest.raises(ValueError, match=r"nu2 = 0\.5 is not valid"):
        function(young1=1.0, nu1=0.3, young2=1.0, nu2=0.5)


@pytest.mark.parametrize("points", [nan, [0.0, inf]])
def test_points_must_be_finite(seed, points):
    spence = SpenceLine(hertz=seed, friction=0.2)
    calls = [seed.Pressure, spence.Traction, ScalarSignorini().Gap]
    for call in calls:
        with pytest.raises(ValueError, match=r"x = .* is not valid: give finite"):
            call(points)
    with pytest.raises(ValueError, match=r"x1 = .* is not valid: give finite"):
        seed.MeanPressure(0.0, points)


def test_intervals_must_not_be_empty(seed, equal):
    states = [
        seed.MeanPressure,
        CattaneoMindlin(hertz=equal, shear=1.0, friction=0.2).MeanTraction,
        SpenceLine(hertz=seed, friction=0.2).MeanTraction,
        ScalarSignorini().MeanPressure,
    ]
    for mean in states:
        with pytest.raises(ValueError, match=r"x1 = .*nonzero length"):
            mean([0.0, 1.0], [1.0, 1.0])


def test_mindlin_refuses(seed, equal):
    for shear in (25.0, -25.0):
        with pytest.raises(ValueError, match=r"shear = .* would slide, keep .* 24\.0"):
            CattaneoMindlin(hertz=equal, shear=shear, friction=0.2)
    with pytest.raises(ValueError, match=r"shear = nan"):
        CattaneoMindlin(hertz=equal, shear=nan, friction=0.2)
    with pytest.raises(ValueError, match=r"friction = -0\.1 is not valid"):
        CattaneoMindlin(hertz=equal, shear=0.0, friction=-0.1)
    with pytest.raises(ValueError, match=r"hertz = .*give both bodies the same material"):
        CattaneoMindlin(hertz=seed, shear=1.0, friction=0.2)
    loaded = CattaneoMindlin(hertz=equal, shear=10.0, friction=0.2)
    for shear in (10.1, -10.1):
        with pytest.raises(ValueError, match=r"shear = .* <= \|start\.shear\| = 10\.0"):
            loaded.Reverse(shear)
    with pytest.raises(ValueError, match=r"shear = nan"):
        loaded.Reverse(nan)


@pytest.mark.parametrize("friction", [-0.2, nan, inf])
def test_friction_must_be_finite_and_not_negative(seed, friction):
    with pytest.raises(ValueError, match=r"friction = .*give a finite number >= 0"):
        SpenceLine(hertz=seed, friction=friction)
    with pytest.raises(ValueError, match=r"friction = .*give a finite number >= 0"):
        StickZone(beta=0.1, friction=friction)


def test_signorini_refuses():
    with pytest.raises(ValueError, match=r"tip = nan"):
        ScalarSignorini(tip=nan)
    with pytest.raises(ValueError, match=r"body = 3 is not valid: give 1"):
        ScalarSignorini().Value(0.0, 0.0, body=3)
    good = ElasticSignorini(young1=1.0, nu1=0.3, young2=1.0, nu2=0.3)
    for name, bad in (("young1", 0.0), ("nu2", 0.5), ("strength", -1.0), ("tip", inf)):
        with pytest.raises(ValueError, match=rf"{name} = {bad} is not valid"):
            replace(good, **{name: bad})
    with pytest.raises(ValueError, match=r"body = 0"):
        good.Stress(0.0, 0.0, body=0)


def test_slab_refuses():
    for name, bad in (("young", -1.0), ("friction", -1.0), ("side_pressure", nan)):
        with pytest.raises(ValueError, match=rf"{name} = {bad} is not valid"):
            replace(GRECO_SLAB, **{name: bad})
    with pytest.raises(ValueError, match=r"published = .* one value for each of the 5"):
        replace(GRECO_SLAB, published=(1.0, 2.0))
    with pytest.raises(ValueError, match=r"reference = 'mine' is not valid"):
        GRECO_SLAB.Errors(GRECO_SLAB.converged, reference="mine")


def test_solutions_cannot_be_changed(seed):
    with pytest.raises(FrozenInstanceError):
        seed.force = 1.0


def test_numbers_in_numbers_out(seed, equal):
    calls = [
        seed.Pressure,
        CattaneoMindlin(hertz=equal, shear=1.0, friction=0.2).Slip,
        SpenceLine(hertz=seed, friction=0.2).Traction,
        ScalarSignorini().Pressure,
    ]
    for call in calls:
        assert np.ndim(call(0.1)) == 0
        assert not isinstance(call(0.1), np.ndarray)
        assert call([[0.1, 0.2, 0.3]]).shape == (1, 3)


@pytest.mark.parametrize(
    "name", [m.name for m in pkgutil.iter_modules(reference.__path__) if m.name[0] != "_"]
)
def test_examples_in_docstrings(name):
    result = doctest.testmod(importlib.import_module(f"ngslac.reference.{name}"))
    assert result.failed == 0
    assert result.attempted > 0
