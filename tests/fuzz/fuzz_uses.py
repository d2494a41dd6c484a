"""Tables of uses: one expression of the World `w` each, below words that its error has to hold."""

import fuzz_world
import ngsolve

import ngslac

__all__ = ["Evaluated", "Uses"]

SCOPE = vars(ngsolve) | vars(ngslac) | vars(fuzz_world)


def Uses(helpers, text):
    """Yield (name, run, words) for each line ``name | expression`` below a line ``[word|word]``.

    All names of NGSolve, ngslac, `fuzz_world` and `helpers` are there, as in a script of a user.
    Below the line ``[]`` the use is legal: it has to work.
    """
    words = ()
    for line in filter(None, map(str.strip, text.splitlines())):
        if line.startswith("["):
            words = tuple(filter(None, line[1:-1].split("|")))
            continue
        name, _, code = map(str.strip, line.partition(" | "))
        yield name, Evaluated(code, helpers, name), words


def Evaluated(text, helpers, name="given"):
    """A function of `w` that evaluates an expression."""
    code = compile(text, name, "eval")
    return lambda w: eval(code, {**SCOPE, **helpers, "w": w})
