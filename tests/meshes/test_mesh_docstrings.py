"""The examples in the docstrings of the mesh builders run."""

import doctest
import importlib

import pytest

MODULES = ["blocks3d", "boxes", "cylinders", "geometry3d", "spheres"]


@pytest.mark.parametrize("name", MODULES)
def test_examples_in_docstrings(name):
    result = doctest.testmod(importlib.import_module(f"ngslac.meshes.{name}"))
    assert result.attempted > 0
    assert result.failed == 0
