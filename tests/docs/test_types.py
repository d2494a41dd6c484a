"""Type check of the code that users read, the tutorials and the README, against our stubs.

What is checked is the use of ngslac: each of its names, methods and keywords exists. NGSolve has no
``py.typed``, so that mypy leaves its stubs alone. Here it is stubbed as a whole: all of its names
are known and are `Any`, but for the classes that ours derive from, which have the attributes that
they have at run time. Without these, mypy would accept any attribute of a `LACSpace`. Our stubs are
read, too, and what the functions of ngslac say of their arguments and results, which is that all of
them do.

Of what mypy says, messages are kept that name a class, method, function or module of ngslac, and
names or arguments that there are not; the rest is about other people's types, and about the values
of a dict that is handed over as ``**dict``.
"""

import ast
import importlib
import inspect
import pkgutil
import re
import textwrap
from keyword import iskeyword
from pathlib import Path

import nbformat
import pytest
from docstrings import STUB_CLASSES, STUBS
from test_snippets import FILES, README, ROOT, Fences

import ngslac

api = pytest.importorskip("mypy.api")

TUTORIALS = ROOT / "tutorials"
FOREIGN = re.compile(r"^\s*(?:from|import) ((?:ngsolve|netgen)[\w.]*)", re.MULTILINE)
# Their stubs are large, and mypy takes their names for Any without them.
CONFIG = """[mypy]
check_untyped_defs = true
follow_imports = silent
[mypy-ngslac.*]
check_untyped_defs = false
[mypy-numpy.*,scipy.*,matplotlib.*,mpl_toolkits.*,IPython.*,PIL.*]
follow_imports = skip
follow_imports_for_stubs = true
"""
FLAGS = "--config-file=mypy.ini --no-color-output --no-incremental --hide-error-context"
ALWAYS = ("call-arg", "name-defined", "syntax")
MESSAGE = re.compile(r"^(.*?):(\d+): error: (.*?)  \[([\w-]+)\]$", re.MULTILINE)
ANY = """class {}:
    def __init__(self, *args: Any, **flags: Any) -> None: ...
    def __mul__(self, other: Any) -> Any: ...
    def __rmul__(self, other: Any) -> Any: ..."""


def Code(notebook):
    """The code cells of a notebook as one text, without magics."""
    cells = nbformat.read(notebook, as_version=4).cells
    text = "\n\n".join(cell.source for cell in cells if cell.cell_type == "code")
    return re.sub(r"^[%!].*$", "", text, flags=re.MULTILINE)


def Sources():
    """Name -> code of all notebooks, scripts, and pages with Python blocks."""
    found = {path.stem: Code(path) for path in sorted(TUTORIALS.glob("*.ipynb"))}
    found |= {path.stem: path.read_text() for path in sorted(TUTORIALS.glob("*.py"))}
    blocks = {page: [textwrap.dedent(c) for c, _ in Fences(page, {"python"})] for page in FILES}
    for page, own in blocks.items():
        if own:  # pages may use the names of the README
            found[page.stem] = "\n".join(own if page == README else blocks[README] + own)
    return {"code_" + re.sub(r"\W", "_", name): code for name, code in found.items()}


def WriteStubs(modules, folder):
    """Stubs of these modules: names are Any; bases of our compiled classes have attributes."""
    bases = sorted({ast.unparse(base) for cls in STUB_CLASSES.values() for base in cls.bases})
    bases = [base for base in bases if "." in base]  # others are ours
    modules = {*modules, *(base.rpartition(".")[0] for base in bases)}
    packages = {name[:k] for name in modules for k in range(len(name)) if name[k] == "."}
    for name in modules | packages:
        module = importlib.import_module(name)
        names = (n for n, v in vars(module).items() if not inspect.ismodule(v))
        things = {n for n in names if n[0] != "_" and n.isidentifier() and not iskeyword(n)}
        own = {base.rpartition(".")[2] for base in bases if base.rpartition(".")[0] == name}
        lines = ["from typing import Any", *(f"{thing}: Any" for thing in sorted(things - own))]
        for cls in sorted(own):
            members = [n for n in dir(getattr(module, cls)) if n[0] != "_"]
            lines += [ANY.format(cls), *(f"    {member}: Any" for member in members)]
        path = folder / Path(*name.split("."))
        path.mkdir(parents=True, exist_ok=True)
        (path / "__init__.pyi").write_text("\n".join(lines) + "\n")


def OurNames():
    """Names of all modules, classes, methods and functions of ngslac."""
    names = {"ngslac"}
    for found in pkgutil.walk_packages(ngslac.__path__, "ngslac."):
        names.add(found.name)
        for name, thing in vars(importlib.import_module(found.name)).items():
            if not getattr(thing, "__module__", "").startswith("ngslac"):
                continue
            if inspect.isclass(thing):
                names |= {name, *(n for n in vars(thing) if n[0].isupper())}
            elif inspect.isfunction(thing):
                names.add(name)
    return names


def Check(sources, folder):
    """Errors in the use of ngslac, as texts ``name: message: line of code``."""
    package = Path(ngslac.__file__).parent
    texts = [*sources.values(), *(path.read_text() for path in package.rglob("*.py"))]
    WriteStubs({name for text in texts for name in FOREIGN.findall(text)}, folder / "stubs")
    for name, text in sources.items():
        (folder / f"{name}.py").write_text(text)
    (folder / "mypy.ini").write_text(CONFIG)
    files = [str(STUBS), *(f"{name}.py" for name in sources)]
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("MYPYPATH", f"{folder / 'stubs'}:{package.parent}")
        patch.chdir(folder)
        output, trouble, _ = api.run([*FLAGS.split(), "--allow-redefinition", *files])
    assert not trouble, trouble
    sources, ours = sources | {STUBS.stem: STUBS.read_text()}, OurNames()
    return [
        f"{(name := Path(file).stem)}: {text}: {sources[name].splitlines()[int(line) - 1].strip()}"
        for file, line, text, kind in MESSAGE.findall(output)
        if kind in ALWAYS or (kind != "no-redef" and ours & {*re.findall(r'"([\w.]+)"', text)})
        if '"**dict' not in text
    ]


def Silent():
    """Functions of the package that do not say the types of their arguments and their result."""
    for path in sorted(Path(ngslac.__file__).parent.rglob("*.py")):
        for node in ast.walk(ast.parse(path.read_text())):
            if isinstance(node, ast.FunctionDef):
                arguments = [*node.args.args, *node.args.kwonlyargs]
                said = all(a.annotation for a in arguments if a.arg not in ("self", "cls"))
                if not (said and (node.returns or node.name == "__init__")):
                    yield f"{path.name}, line {node.lineno}: {node.name}"


def test_all_functions_say_their_types():
    assert [*Silent()] == []


@pytest.fixture(scope="module")
def found(tmp_path_factory):
    """Errors of everything, in one run."""
    sources = Sources()
    assert len(sources) > 4
    wrong = {"wrong": WRONG + "\n".join(MISTAKES)}
    return Check(sources | wrong, tmp_path_factory.mktemp("types"))


def test_tutorials_and_snippets(found):
    assert [text for text in found if not text.startswith("wrong: ")] == []


WRONG = """
from ngsolve import *
from ngsolve.meshes import MakeStructured2DMesh
from ngslac import *
from ngslac.reference import HertzLine

mesh = MakeStructured2DMesh()
V = VectorH1(mesh, order=2)
Q = LACSpace(V, slave="bottom")
(u, lam), (v, mu) = (V * Q).TnT()
Q.ndof, Q.FreeDofs()  # are NGSolve's
contact = LACContact(u, lam, master="top")
solver = ContactSolver(BilinearForm(V * Q), GridFunction(V * Q), contact)
"""
MISTAKES = {
    'contact = LACContact(u, lam, mastr="top")': "mastr",
    'LACContact(u, lam, master="top").presure': "presure",
    'LACContact(u, lam, master="top").Forse()': "Forse",
    'LACContact(u, lam, master="top").Moment(pnt=(0, 0))': "pnt",
    'LACSpace(V, slaves="bottom")': "slaves",
    "Q.nmacro": "nmacro",
    "ContactSolver(BilinearForm(V * Q)).Solve()": "contacts",
    "LoadStepper(solver, Parameter(0)).Integrate(step=3)": "step",
    "LoadStepper(contact, Parameter(0))": "LoadStepper",
    "HertzLine(force=1, radius=2)": "radius",
    "LACSpaces(V)": "LACSpaces",
    "from ngslac import LACContct": "LACContct",
    'LACContact(u, lam, master="top").Check().nmacro': "nmacro",
    "solver.Solve().equilibrum": "equilibrum",
    "def Later():\n    return TimeStepper(solver, 1, dt=1).Tabel()": "Tabel",
}


def test_mistakes_are_seen(found):
    seen = [text for text in found if text.startswith("wrong: ")]
    assert len(seen) == len(MISTAKES), "\n".join(seen)
    for text, name in zip(seen, MISTAKES.values(), strict=True):
        assert f'"{name}"' in text
