"""All reference cases, which tests and the validation report share."""

from __future__ import annotations

from importlib import import_module

__all__ = ["CASES", "MODULES"]

# In the order of the report, a line for each module.
NAMES = """
case_patch
case_patch_large
case_balance
case_invariance
case_infsup
case_signorini
case_adaptive
case_wavy
case_mms_large
case_hertz
case_cylinder
case_slab
case_hertz3d
case_spheres
case_sphere
case_directions
case_punch
case_axisymmetric
case_pin
case_halfring
case_rubber
case_ironing
case_twistblocks
case_tools
case_materials
case_series
case_dynamics
case_modes
case_laws
case_wear
case_adhesion
case_heat
case_restart
case_sensitivity
"""
MODULES = [import_module(name) for name in NAMES.split()]
CASES = {case.name: case for module in MODULES for case in module.CASES}
