"""Names as CAD gives them, with what is special in patterns: they stand for themselves."""

import re

import ngsolve as ngs
import pytest
from netgen.occ import Compound, MoveTo, OCCGeometry, Rectangle, X, Y

from ngslac import BubbleVectorH1, LACContact, LACSpace, SplitSlaveFaces, tools

NAMES = ["Bore (left)", "a|b", "x.y+z*", "seat [1]", "C:\\part{2}", "^top$"]


@pytest.fixture(scope="module")
def mesh():
    low, up = MoveTo(0, -1).Rectangle(1, 1).Face(), Rectangle(1, 1).Face()
    places = [up.edges.Min(Y), up.edges.Max(Y), up.edges.Min(X)]
    places += [low.edges.Max(Y), low.edges.Min(Y), low.edges.Min(X)]
    low.edges.name = up.edges.name = "xAyyzz"
    for edge, name in zip(places, NAMES, strict=True):
        edge.name = name
    return ngs.Mesh(OCCGeometry(Compound([low, up]), dim=2).GenerateMesh(maxh=0.4))


def numbers(mesh, *names):
    """The boundaries of these names."""
    return [name in names for name in mesh.GetBoundaries()]


@pytest.mark.parametrize("name", NAMES)
def test_a_name_stands_for_itself(mesh, name):
    V = ngs.VectorH1(mesh, order=2)
    assert list(LACSpace(V, slave=name).slave.Mask()) == numbers(mesh, name)
    assert SplitSlaveFaces(mesh, name).ne > mesh.ne
    tools.FromMesh(mesh, name, closed=False)
    u, lam = (V * LACSpace(V, slave="xAyyzz")).TrialFunction()
    assert list(LACContact(u, lam, master=name).master.Mask()) == numbers(mesh, name)


@pytest.mark.parametrize("name", NAMES)
def test_bubbles_and_their_conditions(mesh, name):
    held = ~ngs.BitArray(BubbleVectorH1(mesh, slave=name, dirichlet=name).FreeDofs())
    region = mesh.Boundaries([k for k, yes in enumerate(numbers(mesh, name)) if yes])
    same = BubbleVectorH1(mesh, slave=region, dirichlet=region)
    assert list(held) == list(~ngs.BitArray(same.FreeDofs()))
    assert held.NumSet() > 0


def test_among_alternatives_and_patterns_as_before(mesh):
    V = ngs.VectorH1(mesh, order=2)

    def mask(pattern):
        return list(LACSpace(V, slave=pattern).slave.Mask())

    assert mask("Bore (left)|seat [1]") == numbers(mesh, "Bore (left)", "seat [1]")
    assert mask("x.y+z*|a|b") == numbers(mesh, "x.y+z*")  # a and b are no names
    assert mask(r"x.*z\*") == numbers(mesh, "x.y+z*")
    assert mask("x.+") == numbers(mesh, "x.y+z*", "xAyyzz")
    assert mask("(xA|seat).*") == numbers(mesh, "xAyyzz", "seat [1]")


@pytest.mark.parametrize(
    ("given", "closest"),
    [
        ("Bore(left)", "Bore (left)"),
        ("bore", "Bore (left)"),
        ("Bore (lef", "Bore (left)"),  # no regular expression, either
        ("seta [1]", "seat [1]"),
        ("nowhere|xAyyz", "xAyyzz"),
    ],
)
def test_what_matches_nothing_is_told_the_closest_name(mesh, given, closest):
    V, special = ngs.VectorH1(mesh, order=2), any(c in given for c in "([|")
    for call in (
        lambda: LACSpace(V, slave=given),
        lambda: SplitSlaveFaces(mesh, given),
        lambda: BubbleVectorH1(mesh, slave=given),
    ):
        with pytest.raises(ValueError, match=re.escape(f"did you mean '{closest}'?")) as told:
            call()
        assert ("regular expressions" in str(told.value)) == special


def test_no_name_is_near(mesh):
    with pytest.raises(ValueError, match=r"the boundaries are: '.*'$"):
        SplitSlaveFaces(mesh, "nothing at all")
