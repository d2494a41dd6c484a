"""Dirichlet conditions that hold nothing: they are named, once, and in the error they cause."""

import warnings

import pytest
from ngsolve import (
    H1,
    Compress,
    Periodic,
    VectorH1,
    VectorValued,
    ds,
)
from ngsolve.meshes import MakeStructured2DMesh
from posed import posed
from press import linear

from ngslac import (
    BubbleVectorH1,
    ContactSolver,
    ContactWarning,
    FloatingBodyError,
)
from ngslac.dirichlet import Unheld

MESH = MakeStructured2DMesh(nx=2, ny=2, periodic_x=True)


def vector(**flags):
    return VectorH1(MESH, order=2, **flags)


FINE = [
    {},
    {"dirichlet": ".*"},
    {"dirichlet": ""},
    {"dirichlet": "left|top"},
    {"dirichlet": "lef.*", "dirichletx": "(top|no)"},
    {"dirichlet": "[a-z|]+", "dirichlety": "right"},
    {"dirichlet": [1, 2]},
    {"dirichlet": MESH.Boundaries("left")},
    {"dirichletx": "top|", "dirichlet_bbnd": ""},
]
DEAD = [
    (lambda: vector(dirichlet="tpo"), "dirichlet='tpo', which", "top"),
    (lambda: vector(dirichletx="botom", dirichlet="bottom"), "dirichletx='botom', which", "bottom"),
    (lambda: vector(dirichlety="left|rihgt"), "dirichlety='left|rihgt', of which 'rihgt'", "right"),
    (lambda: vector(dirichlet="tpo|left"), "dirichlet='tpo|left', of which 'tpo'", "top"),
    (lambda: vector(dirichlet=MESH.Boundaries("tpo")), "dirichlet=<Region>, which", ""),
    (lambda: Periodic(vector(dirichlet="tpo")), "dirichlet='tpo'", "top"),
    (lambda: Compress(vector(dirichletx="tpo")), "dirichletx='tpo'", "top"),
    (lambda: H1(MESH, dim=2, dirichlet="tpo"), "dirichlet='tpo'", "top"),
    (lambda: VectorValued(H1(MESH, dirichlet="tpo")), "dirichlet='tpo'", "top"),
    (lambda: H1(MESH, dirichlet="tpo") * H1(MESH, dirichlet="top"), "dirichlet='tpo'", "top"),
    (lambda: H1(MESH, dirichlet="top") * H1(MESH, dirichlet="lfet"), "dirichlet='lfet'", "left"),
    (lambda: BubbleVectorH1(MESH, slave="top", dirichlet="tpo"), "dirichlet='tpo'", "top"),
    (lambda: BubbleVectorH1(MESH, slave="top", dirichletx="tpo"), "dirichletx='tpo'", "top"),
    (lambda: vector(dirichlet_bbnd="corner"), "dirichlet_bbnd='corner'", ""),
]


@pytest.mark.parametrize("flags", FINE)
def test_nothing_is_said_of_conditions_that_hold(flags):
    assert not Unheld(vector(**flags))


@pytest.mark.parametrize(("make", "words", "closest"), DEAD)
def test_the_flag_the_pattern_and_the_closest_name(make, words, closest):
    found = Unheld(make())
    assert words in found
    assert "holds nothing" in found
    assert (f"did you mean '{closest}'?" in found) == bool(closest)


def made(**flags):
    V = VectorH1(MESH, order=2, **flags)
    problem = posed(
        V, lambda u, v, load: linear(u, v) + v[0] * ds("top"), slave="bottom", obstacle=0.0
    )
    return problem.a, problem.gf, problem.contact


def test_the_contact_warns_once_and_the_error_names_it():
    with pytest.warns(ContactWarning, match=r"dirichlet='botom'.* did you mean 'bottom'") as told:
        parts = made(dirichlet="botom")
    assert len(told) == 1
    with pytest.raises(FloatingBodyError, match=r"floats .*dirichlet='botom'"):
        ContactSolver(*parts).Solve(printing=False)


def test_no_word_where_all_holds():
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        ContactSolver(*made(dirichlet="left", dirichletx="right")).Solve(printing=False)
