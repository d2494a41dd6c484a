"""A solution is the same in any number of threads; in one, to the last bit."""

import numpy as np
import pytest
from ngsolve import SetNumThreads, TaskManager
from press import mixed_press, numpy


@pytest.mark.parametrize("flags", [{}, {"finite": True, "nonlinear": True}])
def test_threads_change_nothing_but_rounding(flags):
    def solution(threads):
        SetNumThreads(threads)
        with TaskManager():
            problem = mixed_press(h=0.5, **{"order": 1, **flags})
            problem.solver().Solve(printing=False)
        return numpy(problem.gf)

    try:
        one, again, three = [solution(threads) for threads in (1, 1, 3)]
    finally:
        SetNumThreads(1)
    assert one.tobytes() == again.tobytes()
    assert np.abs(three - one).max() < 1e-13 * np.abs(one).max()
