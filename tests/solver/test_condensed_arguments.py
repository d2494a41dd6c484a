"""Numbers of dofs that do not fit the matrix are refused before anything is read with them."""

import numpy as np
import pytest
from netgen.meshing import NgException
from ngsolve import BitArray
from press import press
from test_condensed import system

from ngslac._ngslac import Condensation, MergeMatrices, TwoLevel


@pytest.fixture(scope="module")
def given():
    mat, _, multipliers, free = system(press())
    return mat, multipliers.tolist(), 2, free


@pytest.mark.parametrize("wrong", [-1, 2**31 - 1])
def test_multipliers_that_there_are_not(given, wrong):
    mat, multipliers, dim, free = given
    with pytest.raises(NgException, match=f"no multiplier {wrong} "):
        Condensation(mat, [*multipliers[:-1], wrong], dim, free)


@pytest.mark.parametrize("dim", [-2, 0, 5000])
def test_blocks_that_multipliers_do_not_fill(given, dim):
    mat, multipliers, _, free = given
    with pytest.raises(NgException, match=f"no blocks of {dim}"):
        Condensation(mat, multipliers, dim, free)


def test_bits_of_another_space(given):
    mat, multipliers, dim, free = given
    for bits in (BitArray(0), BitArray(len(free) + 1)):
        with pytest.raises(NgException, match="bits of free dofs"):
            Condensation(mat, multipliers, dim, bits)
        with pytest.raises(NgException, match=r"bits for .* rows"):
            Condensation(*given).Part(bits)


def test_coarse_systems_that_do_not_fit(given):
    whole = Condensation(*given)
    coarse = whole.Part(whole.freedofs)
    held = ~whole.freedofs
    with pytest.raises(NgException, match="does not fit"):
        TwoLevel(whole, coarse, coarse, BitArray(3))
    with pytest.raises(NgException, match="is not free"):
        TwoLevel(whole, whole.Part(held), whole.Part(held), held)
    with pytest.raises(TypeError):
        TwoLevel(whole, coarse, None, whole.freedofs)


def test_none_is_no_matrix(given):
    with pytest.raises(NgException, match="must be sparse"):
        MergeMatrices(given[0], [None], np.ones(given[0].height))
