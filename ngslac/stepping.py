"""Load stepping with control of the step size."""

from dataclasses import dataclass

from ngslac.errors import ContactConvergenceError

__all__ = ["LoadStepper", "Step"]


@dataclass(frozen=True)
class Step:
    """A converged step.

    Attributes
    ----------
    number : int
    time : float
        Value of the load parameter.
    iterations : int
        Linear solves of this step (those of failed attempts not counted).
    cuts : int
        How often the step was halved before it converged.
    """

    number: int
    time: float
    iterations: int
    cuts: int


class LoadStepper:
    """Raise the load in steps; halve a step that fails, and grow again after success.

    A failed step leaves solution, load and history at the last converged step.

    Parameters
    ----------
    solver : ContactSolver
    load : ngsolve.Parameter
        Appears in the bulk form, in `rhs`, or in `prescribe`; its value is the time.
    prescribe : callable, optional
        ``prescribe(gf)`` sets Dirichlet values for the current load. It should leave other dofs
        alone (``gf.Set(..., definedon=...)`` clears them, which costs the predicted start).
    predict : bool
        Start each step from the linear extrapolation of the last two.
    maxcuts : int
        How often a step may be halved: the smallest step is the equal one over 2**maxcuts.

    Examples
    --------
    >>> load.Set(0)
    >>> steps = LoadStepper(solver, load).Integrate(steps=4, printing=False)
    >>> steps[-1].time
    1.0
    """

    def __init__(self, solver, load, *, prescribe=None, predict=True, maxcuts=8):
        self.solver, self.load = solver, load
        self.prescribe, self.predict, self.maxcuts = prescribe, predict, maxcuts
        self.steps = []
        self._last = None  # increment of the solution and of the load in the last step

    def Integrate(self, end=1.0, *, steps=10, callback=None, printing=True, maxit=30, tol=1e-10):
        """Go from the current load to `end` in `steps` equal steps.

        Parameters
        ----------
        end : float
            Last value of the load parameter.
        steps : int
            Number of equal steps; failing ones are divided.
        callback : callable, optional
            Called with each converged `Step` (of any size) after the commit.
        printing : bool
            One line per step and iteration.
        maxit, tol :
            Handed to `ContactSolver.Solve`.

        Returns
        -------
        list[Step]

        Raises
        ------
        ContactConvergenceError
            When the smallest step fails. After any error, solution, load, history and fields are
            those of the last converged step.
        """
        if steps < 1:
            raise ValueError(f"steps = {steps} must be at least 1")
        begin = self.load.Get()
        done = []
        for k in range(1, steps + 1):
            target = begin + (end - begin) * k / steps
            done += self._Reach(target, callback, printing, maxit, tol)
        return done

    def _Reach(self, target, callback, printing, maxit, tol):
        done, cuts = [], 0
        size = target - self.load.Get()
        least = 0.99 * abs(size) * 0.5**self.maxcuts
        while abs(target - self.load.Get()) > 1e-12 * max(abs(target), abs(size)):
            remaining = target - self.load.Get()
            goal = target if abs(size) >= (1 - 1e-9) * abs(remaining) else self.load.Get() + size
            number = len(self.steps) + 1
            if printing:
                print(f"step {number}  load {goal:g}")
            try:
                last = self._Attempt(goal, printing, maxit, tol)
            except ContactConvergenceError as error:
                cuts += 1
                if abs(goal - self.load.Get()) / 2 < least:
                    raise
                if printing:
                    print(f"  {error}; halved")
                size = (goal - self.load.Get()) / 2
                continue
            self.steps.append(Step(number, goal, last.number, cuts))
            done.append(self.steps[-1])
            if callback:
                callback(self.steps[-1])
            size, cuts = 2 * size, 0
        return done

    def _Attempt(self, goal, printing, maxit, tol):
        solver, vec = self.solver, self.solver.gf.vec
        begin = self.load.Get()
        start = vec.CreateVector()
        start.data = vec
        self.load.Set(goal)
        try:
            if self._last is not None and self.predict:
                increment, size = self._last
                vec.data += (goal - begin) / size * increment
            if self.prescribe:
                self.prescribe(solver.gf)
            last = solver.Solve(maxit=maxit, tol=tol, printing=printing)
        except BaseException:
            vec.data = start
            self.load.Set(begin)
            for contact in solver.contacts:
                contact.Restore()
            raise
        for contact in solver.contacts:
            contact.Commit(solver.gf)
        increment = vec.CreateVector()
        increment.data = vec - start
        self._last = increment, goal - begin
        return last
