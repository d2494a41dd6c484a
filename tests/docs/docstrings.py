"""What the public names are, and what their docstrings say, in numpy's style.

Public are the names of `ngslac`, `ngslac.analysis`, `ngslac.materials`, `ngslac.reference` and
`ngslac.tools`, the classes of what their methods return, and all methods and properties of these
classes without an underscore. The arguments of compiled classes are read from the stubs.
"""

import ast
import inspect
import re
import textwrap
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

import ngslac
import ngslac.analysis
import ngslac.materials
import ngslac.reference
import ngslac.tools
from ngslac.analysis.adapt import AdaptStep
from ngslac.analysis.estimate import ErrorEstimate
from ngslac.analysis.goal import GoalError
from ngslac.contact.certificate import Certificate, Excess
from ngslac.contact.report import ContactReport
from ngslac.output.segments import Segments
from ngslac.recovery.recovered import Recovered
from ngslac.solve.iteration import Iteration
from ngslac.steps.balance import EnergyBalance, TimeStep
from ngslac.steps.load import Step

STUBS = Path(ngslac.__file__).with_name("_ngslac.pyi")
STUB_CLASSES = {n.name: n for n in ast.parse(STUBS.read_text()).body if hasattr(n, "bases")}
RESULTS = (
    AdaptStep,
    ErrorEstimate,
    GoalError,
    EnergyBalance,
    TimeStep,
    Iteration,
    ContactReport,
    Certificate,
    Excess,
    Recovered,
    Segments,
    Step,
    ngslac.tools.Tool,
)
COMPILED = (ngslac.LACSpace, ngslac.BubbleVectorH1)
# These check their arguments and raise ValueError.
CHECKS = {"finite", "positive", "nonnegative", "poisson", "points", "interval"}


@dataclass(frozen=True)
class Name:
    """A public class, function, method or property.

    Parameters
    ----------
    name : str
        With the class and a dot, if it belongs to one.
    thing : object
        What it is; of a property the function behind.
    kind : {"class", "function", "method", "property"}
    owner : type, optional
        The class.
    """

    name: str
    thing: object
    kind: str
    owner: type | None = None

    @cached_property
    def doc(self):
        """The docstring, of compiled functions without the signature above it."""
        thing = self.thing
        if self.kind == "property":
            thing = inspect.getattr_static(self.owner, self.name.rpartition(".")[2])
        text = inspect.cleandoc(thing.__doc__ or "")
        return re.sub(r"^\w*\(.*\) -> .*\n\n", "", text) if self.compiled else text

    @cached_property
    def sections(self):
        return Sections(self.doc)

    @property
    def compiled(self):
        return (self.owner or self.thing) in COMPILED

    @property
    def stub(self):
        """The first definition of a compiled method, or of ``__init__``, in the stubs."""
        owner, _, method = self.name.partition(".")
        functions = (n for n in STUB_CLASSES[owner].body if isinstance(n, ast.FunctionDef))
        return next(f for f in functions if f.name == (method or "__init__"))

    @cached_property
    def parameters(self):
        """Names of the arguments."""
        if self.compiled:
            arguments = self.stub.args
            names = [a.arg for a in (*arguments.args, *arguments.kwonlyargs)]
        elif self.kind == "class" and issubclass(self.thing, Exception):
            names = []
        else:
            names = inspect.signature(getattr(self.thing, "__func__", self.thing)).parameters
        return [name for name in names if name not in ("self", "cls")]

    @cached_property
    def nodes(self):
        """Syntax of the functions behind: of a class, of those that run when it is made."""
        functions = [getattr(self.thing, "__func__", self.thing)]
        if self.kind == "class":
            functions = [getattr(self.thing, n, None) for n in ("__init__", "__post_init__")]
        return [] if self.compiled else [node for f in functions for node in _Own(f)]

    @property
    def returns(self):
        """Does a function or method give back a value?"""
        if self.compiled:
            return not self.parameters or ast.unparse(self.stub.returns) != "None"
        return any(isinstance(node, ast.Return) and node.value is not None for node in self.nodes)

    @property
    def raises(self):
        """Names of the errors that are raised in its own lines, or by the checks it calls."""
        calls = [node.exc for node in self.nodes if isinstance(node, ast.Raise)]
        calls = [call for call in calls if isinstance(getattr(call, "func", None), ast.Name)]
        # Wrong(kind, ...) makes the message of an error of a kind.
        found = {c.args[0].id if c.func.id == "Wrong" else c.func.id for c in calls}
        called = {getattr(n.func, "id", None) for n in self.nodes if isinstance(n, ast.Call)}
        if self.kind in ("class", "function") and called & CHECKS:
            found.add("ValueError")
        return found


def _Own(function):
    """All nodes of a function of ours, but for those of functions inside of it."""
    code = getattr(function, "__code__", None)
    if code is None or code.co_filename.startswith("<"):  # not there, or made by dataclass
        return
    todo = ast.parse(textwrap.dedent(inspect.getsource(function))).body[0].body[:]
    while todo:
        node = todo.pop()
        yield node
        if not isinstance(node, (ast.FunctionDef, ast.Lambda)):
            todo += ast.iter_child_nodes(node)


def Sections(doc):
    """A docstring's sections: "" (before the first) and by their titles, each as its text."""
    parts = re.split(r"^([A-Z]\w+)\n-{3,}\n", doc, flags=re.MULTILINE)
    return {"": parts[0]} | dict(zip(parts[1::2], parts[2::2], strict=True))


def Entries(section):
    """The names that a section describes: ``a, b : float`` has two."""
    heads = re.findall(r"^(\S[^:\n]*?)(?: ?:.*)?$", section, flags=re.MULTILINE)
    return {name.strip("* ") for head in heads for name in head.split(",")}


def _Members(cls, name):
    """Public methods and properties that a class has from this package."""
    bases = [base for base in reversed(cls.__mro__) if base.__module__.startswith("ngslac")]
    bases = [cls] if cls in COMPILED else bases
    for member, value in {n: v for base in bases for n, v in vars(base).items()}.items():
        thing = getattr(value, "fget", None) or getattr(value, "func", None)
        if member.startswith("_"):
            continue
        if thing is not None or isinstance(value, property):
            yield Name(f"{name}.{member}", value if thing is None else thing, "property", cls)
        elif callable(value) or isinstance(value, classmethod):
            yield Name(f"{name}.{member}", getattr(cls, member), "method", cls)


def PublicNames():
    """All of them."""
    things = {name: getattr(ngslac, name) for name in ngslac.__all__ if name[0] != "_"}
    for room in (ngslac.analysis, ngslac.materials, ngslac.reference, ngslac.tools):
        things |= {name: getattr(room, name) for name in room.__all__}
    things |= {cls.__name__: cls for cls in RESULTS}
    names = []
    for name, thing in things.items():
        if inspect.isclass(thing):
            names += [Name(name, thing, "class"), *_Members(thing, name)]
        elif callable(thing):
            names.append(Name(name, thing, "function"))
    return names
