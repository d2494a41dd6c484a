"""Imports run one way: from a room to those below it, and in no room in a circle.

What is imported for annotations alone does not run: these may name any class.
"""

import ast
from functools import cache
from graphlib import TopologicalSorter
from pathlib import Path

import pytest

import ngslac

HOME = Path(ngslac.__file__).parent
# From the ground up; what stands beside the rooms is for all of them.
FLOORS = (
    *(
        "",
        "parallel",
        "meshes",
        "linear",
        "output",
        "recovery",
        "contact",
        "bodies",
        "petsc",
        "solve",
        "steps",
        "analysis",
        "reference",
        "installation",
    ),
)
MODULES = {
    ".".join(("ngslac", *path.relative_to(HOME).with_suffix("").parts)): path
    for path in sorted(HOME.rglob("*.py"))
    if path not in (HOME / "__init__.py", HOME / "__main__.py")
}


def room(module):
    _, *rooms, _ = module.split(".")
    return rooms[0] if rooms else ""


def imported(path):
    """Modules of the package that a file imports when it runs, at its top or later."""
    todo = [ast.parse(path.read_text())]
    while todo:
        node = todo.pop()
        if isinstance(node, ast.If) and ast.unparse(node.test) == "TYPE_CHECKING":
            continue
        todo += ast.iter_child_nodes(node)
        if isinstance(node, ast.ImportFrom) and node.module:
            yield from (node.module, *(f"{node.module}.{name.name}" for name in node.names))
        elif isinstance(node, ast.Import):
            yield from (name.name for name in node.names)


@cache
def arrows():
    """Modules of the package that each of them imports."""
    return {module: {*imported(path)} & set(MODULES) for module, path in MODULES.items()}


def test_every_folder_is_a_room():
    assert set(map(room, MODULES)) == set(FLOORS)


@pytest.mark.parametrize("module", MODULES)
def test_imports_run_downwards(module):
    floor = FLOORS.index(room(module))
    assert [m for m in arrows()[module] if FLOORS.index(room(m)) > floor] == []


def test_no_circle_of_imports():
    assert len([*TopologicalSorter(arrows()).static_order()]) == len(MODULES)
