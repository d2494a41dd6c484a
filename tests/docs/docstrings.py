"""What the public names are, and what their docstrings say, in numpy's style.

Public are the names of `ngslac`, `ngslac.materials` and `ngslac.reference`, the classes of what
their methods return, and all methods and properties of these classes without an underscore. The
arguments of compiled classes are read from the stubs.
"""

import ast
import inspect
import re
import textwrap
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

import ngslac
import ngslac.materials
import ngslac.reference
from ngslac import _ngslac
from ngslac.contact.report import ContactReport
from ngslac.output.segments import Segments
from ngslac.solve.iteration import Iteration
from ngslac.steps.balance import EnergyBalance, TimeStep
from ngslac.steps.load import Step

__all__ = ["RESULTS", "CompiledNames", "Entries", "Name", "PublicNames", "Sections", "StubNames"]

STUBS = Path(ngslac.__file__).with_name("_ngslac.pyi")
RESULTS = (EnergyBalance, TimeStep, Iteration, ContactReport, Segments, Step)
COMPILED = (ngslac.LACSpace, ngslac.BubbleVectorH1)
# These check their arguments and raise ValueError.
CHECKS = {"finite", "positive", "nonnegative", "poisson", "points", "interval"}
PROTOCOL = {"__init__", "__post_init__"}


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

    @cached_property
    def parameters(self):
        """Names of the arguments."""
        if self.compiled:
            return _StubArguments(self.name if self.kind == "method" else f"{self.name}.__init__")
        thing = getattr(self.thing, "__func__", self.thing)
        if self.kind == "class" and issubclass(thing, Exception):
            return []
        names = [p.name for p in inspect.signature(thing).parameters.values()]
        return [name for name in names if name not in ("self", "cls")]

    @property
    def compiled(self):
        return (self.owner or self.thing) in COMPILED

    @cached_property
    def sources(self):
        """Syntax trees of the functions behind: of a class, those that run when it is made."""
        if self.compiled:
            return []
        if self.kind != "class":
            return [_Tree(getattr(self.thing, "__func__", self.thing))]
        made = (getattr(self.thing, name, None) for name in PROTOCOL)
        return [_Tree(function) for function in made if _IsOurs(function)]

    @property
    def returns(self):
        """Does a function or method give back a value?"""
        if self.compiled:
            return not self.parameters or _StubReturns(self.name)
        return any(
            isinstance(node, ast.Return) and node.value is not None
            for tree in self.sources
            for node in _Own(tree)
        )

    @property
    def raises(self):
        """Names of the errors that are raised in its own lines, or by the checks it calls."""
        nodes = [node for tree in self.sources for node in _Own(tree)]
        found = {
            # Wrong(kind, ...) makes the message of an error of a kind.
            node.exc.args[0].id if node.exc.func.id == "Wrong" else node.exc.func.id
            for node in nodes
            if isinstance(node, ast.Raise)
            and isinstance(node.exc, ast.Call)
            and isinstance(node.exc.func, ast.Name)
        }
        calls = {getattr(n.func, "id", None) for n in nodes if isinstance(n, ast.Call)}
        if self.kind in ("class", "function") and calls & CHECKS:
            found.add("ValueError")
        return found


def _IsOurs(function):
    return inspect.isfunction(function) and function.__module__.startswith("ngslac")


def _Tree(function):
    lines = getattr(function, "__code__", None)
    if lines is None or lines.co_filename.startswith("<"):  # made by dataclass
        return ast.parse("")
    return ast.parse(textwrap.dedent(inspect.getsource(function)))


def _Own(tree):
    """All nodes of a function, but for those of functions inside of it."""
    todo = list(tree.body)
    todo = todo[0].body[:] if todo and isinstance(todo[0], ast.FunctionDef) else todo
    while todo:
        node = todo.pop()
        yield node
        if not isinstance(node, (ast.FunctionDef, ast.Lambda)):
            todo += ast.iter_child_nodes(node)


def _StubFunction(name):
    """The first definition of ``Class.method`` in the stubs."""
    owner, method = name.split(".")
    classes = {n.name: n for n in ast.parse(STUBS.read_text()).body if isinstance(n, ast.ClassDef)}
    functions = (n for n in classes[owner].body if isinstance(n, ast.FunctionDef))
    return next((f for f in functions if f.name == method), None)


def _StubArguments(name):
    arguments = _StubFunction(name).args
    return [a.arg for a in (*arguments.args, *arguments.kwonlyargs) if a.arg != "self"]


def _StubReturns(name):
    return ast.unparse(_StubFunction(name).returns) != "None" if "." in name else False


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
    found = {}
    for base in reversed(cls.__mro__):
        if not base.__module__.startswith("ngslac"):
            continue
        if cls in COMPILED and base is not cls:
            continue
        found |= {n: v for n, v in vars(base).items() if not n.startswith("_")}
    for member, value in found.items():
        thing = getattr(value, "fget", None) or getattr(value, "func", None)
        if thing is not None or isinstance(value, property):
            yield Name(f"{name}.{member}", value if thing is None else thing, "property", cls)
        elif callable(value) or isinstance(value, classmethod):
            yield Name(f"{name}.{member}", getattr(cls, member), "method", cls)


def PublicNames():
    """All of them."""
    things = {name: getattr(ngslac, name) for name in ngslac.__all__ if name[0] != "_"}
    for room in (ngslac.materials, ngslac.reference):
        things |= {name: getattr(room, name) for name in room.__all__}
    things |= {cls.__name__: cls for cls in RESULTS}
    names = []
    for name, thing in things.items():
        if inspect.isclass(thing):
            names += [Name(name, thing, "class"), *_Members(thing, name)]
        elif callable(thing):
            names.append(Name(name, thing, "function"))
    return names


def StubNames():
    """Names of the stubs, and those of each class: ``{"": ..., "LACSpace": ...}``."""
    body = ast.parse(STUBS.read_text()).body
    names = {"": {n.name for n in body if isinstance(n, (ast.ClassDef, ast.FunctionDef))}}
    for cls in (n for n in body if isinstance(n, ast.ClassDef)):
        inside = {n.name for n in cls.body if isinstance(n, ast.FunctionDef)}
        inside |= {n.target.id for n in cls.body if isinstance(n, ast.AnnAssign)}
        names[cls.name] = inside
    return names


def CompiledNames():
    """The same of the compiled module, without what Python gives to every class."""
    things = {n: v for n, v in vars(_ngslac).items() if not n.startswith("__")}
    names = {"": set(things)}
    for name, cls in things.items():
        if inspect.isclass(cls):
            names[name] = {n for n in vars(cls) if not n.startswith("_")}
    return names
