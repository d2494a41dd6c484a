"""Every reference case holds, computed with small sizes and without its picture."""

from pathlib import Path

import pytest
from cases import CASES

# Each week: tests of the same problem stand for these. Those of examples run each week, too.
ELSEWHERE = {
    "rolling": "examples/test_example_scripts.py::test_numbers_and_files",
    "flatpunch": "examples/test_example_scripts.py::test_numbers_and_files",
    "carter": "examples/test_example_scripts.py::test_numbers_and_files",
    "cup": "examples/test_example_scripts.py::test_numbers_and_files",
    "pyramid": "examples/test_example_scripts.py::test_numbers_and_files",
    "cattaneo3d": "examples/test_example_scripts.py::test_numbers_and_files",
    "indentation": "examples/test_example_plasticity.py::test_loading_unloading_and_loading_again",
    "flat-ring": "examples/test_example_solutions.py::test_the_flat_ring_touches_itself_as_a_plane",
    "bouncing-ring": "examples/test_example_solutions.py::test_bouncing_with_slip_all_the_time",
    "hertz-sides": "validation/test_sides.py::test_equal_bodies_hardly_rub",
    "nafems1": "validation/test_hertz.py::test_benchmark_in_small_strain",
    "spheres": "validation/test_hertz3d.py::test_two_half_spheres_are_stiffer_than_half_spaces",
    "infsup3d": "validation/test_infsup.py::test_bounded_under_refinement_3d",
    "patch3d": "validation/test_patch.py::test_constant_shear_3d",
    "patch2d": "validation/test_patch.py::test_constant_stress_2d",
    "patch-large": "validation/test_patch_large.py::test_large_strain",
    "infsup2d": "validation/test_infsup.py::test_bounded_under_refinement_2d",
    "mms-large": "validation/test_mms_large.py::"
    "test_rates_and_newton_from_the_interpolated_solution",
    "hertz2d": "validation/test_hertz.py::test_pressure_agrees_with_hertz",
    "hertz3d": "validation/test_hertz3d.py::test_pressures_are_those_of_hertz",
    "hertz3d-line": "validation/test_hertz3d.py::test_pressures_are_those_of_hertz",
    "twist": "validation/test_sphere.py::test_twist",
    "ironing": "examples/test_example_solutions.py::test_forces_of_ironing_are_the_published_ones",
    "materials": "validation/test_materials.py::test_heated_disc_in_a_ring_converges_to_lame",
    "half-ring": "validation/test_large.py::test_half_ring_buckles_and_rests_on_two_places",
    "spence": "validation/test_cylinder.py::test_low_load_agrees_with_spence",
    "impact": "solver/test_dynamics.py::test_impact_of_a_bar_on_a_wall",
    "restart": "solver/test_restart.py::test_continued_in_a_new_process",
    "adaptive-edge": "analysis/test_adapt.py::"
    "test_adaptive_meshes_converge_as_if_the_solution_were_smooth",
    "adaptive-size": "analysis/test_adapt.py::test_the_size_of_a_contact_takes_few_dofs",
    "mode-coupling": "analysis/test_modes.py::test_mode_coupling",
    "hertz-exponents": "analysis/test_sensitivity.py::test_by_material_friction_obstacle_and_load",
    "cantilever": "tutorials/test_tutorial_peeling.py::test_force_and_beam_theory",
    "stick-slip": "tutorials/test_tutorial_laws.py::test_stick_and_slip",
    "dent": "examples/test_example_plasticity.py::test_onset_of_yield",
    "adhesion": "solver/test_descent.py::test_a_block_that_is_pulled_off_tilts",
    "frictional-heat": "contact/test_flux.py::test_heat_is_the_power_of_friction",
}


def Marked(case):
    marks = [pytest.mark.full] if case.name in ELSEWHERE else []
    return pytest.param(case, id=case.name, marks=marks)


def test_what_stands_for_a_case_is_there():
    assert CASES.keys() > ELSEWHERE.keys()
    for file, _, function in (place.partition("::") for place in ELSEWHERE.values()):
        assert f"def {function}(" in (Path(__file__).parents[1] / file).read_text()


@pytest.mark.parametrize("case", [Marked(case) for case in CASES.values()])
def test_every_judged_row_holds(case):
    rows = case.function(quick=True).rows
    assert [row.Cells() for row in rows if not row.holds] == []
    assert any(row.judged for row in rows)
