"""The study file: defaults, units, records that read back, and the written file."""

import inspect
import math
import sys
from dataclasses import asdict
from pathlib import Path
from typing import Any

import pytest
from pydantic import ValidationError

from sentences import rejects
from stickslip.case.case import Case, MeshCase, TwoBladeCase
from stickslip.case.load import load_case
from stickslip.case.sections import ContactStiffnessSection
from stickslip.core.errors import StudyFileError


def test_written_file_reads_back_as_the_defaults() -> None:
    assert Case.from_text(Case().to_text()) == Case()


def test_written_file_names_every_key_within_its_width() -> None:
    text = Case().to_text()
    for section, keys in Case.allowed_keys().items():
        if not Case().shows(section):
            assert f"[{section}" not in text
            continue
        assert f"[{section}]" in text
        for key in keys:
            assert f"{key} = " in text
    assert max(map(len, text.splitlines())) <= 120


@pytest.mark.parametrize(
    ("uncommented", "left_out"),
    [
        (("values",), ("centrifugal_force",)),
        (("rayleigh_alpha", "rayleigh_beta"), ("modal_damping_ratio",)),
        (("normal_stiffness", "tangential_stiffness"), ("[roughness]",)),
    ],
)
def test_examples_in_comments_are_valid(uncommented: tuple[str, ...], left_out: tuple[str, ...]) -> None:
    text = Case().to_text()
    if left_out == ("[roughness]",):
        head, _, rest = text.partition("[roughness]")
        text = head + rest[rest.index("# [contact_stiffness]") + 2 :]
    lines = []
    for line in text.splitlines():
        bare = line.removeprefix("# ")
        if not line.startswith(tuple(f"{key} = " for key in left_out)):
            lines.append(bare if bare.startswith(tuple(f"{key} = " for key in uncommented)) else line)
    case = Case.from_text("\n".join(lines))
    assert set(uncommented) <= {key for section in case.to_dict().values() for key in section}


def test_the_earlier_name_of_a_roughness_mode_reads_as_the_new_one() -> None:
    earlier = Case.from_text('[roughness]\nmode = "paper"\n')
    assert earlier == Case().replace({"roughness.mode": "varying-curvature"})
    assert earlier.roughness is not None
    assert earlier.roughness.mode == "varying-curvature"
    assert 'mode = "varying-curvature"' in earlier.to_text()
    with rejects(StudyFileError, "roughness.mode"):
        Case.from_text('[roughness]\nmode = "Paper"\n')


def test_loaded_values_are_si_floats(tmp_path: Path) -> None:
    path = tmp_path / "study.toml"
    path.write_text(Case().to_text(), encoding="utf-8")
    case = load_case(path)
    assert isinstance(case, TwoBladeCase)
    assert case.geometry.blade_length == 0.145
    assert case.geometry.platform_angle == pytest.approx(math.radians(30.0), rel=1e-14)
    assert case.material.young_modulus == 197e9
    assert case.material.density == 7800.0
    assert case.roughness is not None
    assert case.roughness.sq == 1e-6
    assert case.preload.centrifugal_force == 500.0
    assert case.solver.frequency_stop == 550.0


def test_default_geometry_and_mesh_are_those_of_the_structure() -> None:
    from stickslip.model.kinds.two_blade_geometry import BladePairElements, BladePairGeometry

    default = Case()
    assert isinstance(default, TwoBladeCase)
    geometry = default.geometry.model_dump()
    geometry["platform_angle_deg"] = round(math.degrees(geometry.pop("platform_angle")), 12)
    geometry["right_platform_angle_deg"] = geometry.pop("right_platform_angle")  # None: that of the other one
    assert {**geometry, "damper": {}} == asdict(BladePairGeometry())  # a wedge has no dimensions of its own
    mesh = default.mesh.model_dump()
    assert mesh.pop("element") == "incompatible"
    assert mesh == asdict(BladePairElements())


def test_default_solver_settings_are_those_of_the_solver() -> None:
    from stickslip.solve.path.newton import NewtonSettings
    from stickslip.solve.path.stepping import ContinuationSettings

    solver, steps = Case().solver, ContinuationSettings()
    assert solver.tolerance == NewtonSettings().tolerance
    assert (solver.smallest_step, solver.first_step, solver.largest_step) == (
        steps.smallest_step,
        steps.first_step,
        steps.largest_step,
    )


def test_left_out_keys_are_named() -> None:
    case = Case.from_text('[friction]\ncoefficient = 0.2\n[preload]\ncentrifugal_force = "20 N"\n')
    missing = case.defaulted_keys()
    assert "[geometry]" in missing
    assert "preload.friction_coefficient_at_assembly" in missing
    assert "preload.centrifugal_force" not in missing
    assert "[friction]" not in missing
    assert Case.from_text(Case().to_text()).defaulted_keys() == ()


def test_record_reads_back_exactly() -> None:
    case = Case.from_text(
        '[preload]\nvalues = [1.5, "2 N", -3]\n[excitation]\ndirection = [1, 2, 0]\n[mesh]\nairfoil_rows = 7'
    )
    changed = case.replace({"geometry.blade_length": 0.1 + 0.2, "damping.rayleigh_beta": "7 us"})
    for each in (case, changed):
        record = each.to_dict()
        assert Case.from_mapping(record) == each
        assert Case.from_text(each.to_text()).solver == each.solver
    assert changed.to_dict()["geometry"]["blade_length"] == "0.30000000000000004 m"


def test_replace_validates_and_leaves_the_original() -> None:
    case = Case()
    other = case.replace({"preload.centrifugal_force": "300 N", "solver.samples": 512})
    assert isinstance(case, TwoBladeCase)
    assert isinstance(other, TwoBladeCase)
    assert (other.preload.centrifugal_force, other.solver.samples) == (300.0, 512)
    assert case.preload.centrifugal_force == 500.0
    with rejects(StudyFileError, "preload.centrifugal_force"):
        case.replace({"preload.centrifugal_force": -1})
    with rejects(StudyFileError, "preload.centrifugal"):
        case.replace({"preload.centrifugal": 1})
    with rejects(StudyFileError, "friction"):
        case.replace({"friction": {"coefficient": 0.4}})


def test_case_is_frozen() -> None:
    solver: Any = Case().solver
    with pytest.raises(ValidationError):
        solver.samples = 3


def test_one_given_source_replaces_the_default_of_the_other() -> None:
    case = Case.from_text(
        '[contact_stiffness]\nnormal_stiffness = "1e8 N/m"\ntangential_stiffness = 8e7\n'
        '[damping]\nrayleigh_alpha = "1 1/s"\n[preload]\nvalues = [1.0, 2.0]\n'
    )
    assert case.roughness is None
    assert isinstance(case, TwoBladeCase)
    assert isinstance(case.contact_stiffness, ContactStiffnessSection)
    assert case.contact_stiffness.tangential_stiffness == 8e7
    assert case.damping.modal_damping_ratio is None
    assert case.preload.centrifugal_force is None
    assert case.preload.values == (1.0, 2.0)
    assert Case.from_text(case.to_text()) == case


def test_reference_area_belongs_to_the_pressure() -> None:
    text = '[roughness]\nreference_area = "25 mm^2"\n'
    case = Case.from_text(text + 'allocation = "pressure"\n')
    assert case.roughness is not None
    assert case.roughness.reference_area == 25e-6
    assert 'reference_area = "25 mm^2"' in case.to_text()
    assert Case.from_text(case.to_text()) == case == Case.from_mapping(case.to_dict())
    assert '\n# reference_area = "180 mm^2"' in Case().to_text()
    with rejects(StudyFileError, "roughness.reference_area"):
        Case.from_text(text)
    with rejects(StudyFileError, "roughness.reference_area"):
        Case.from_text(text.replace("mm^2", "mm") + 'allocation = "pressure"\n')
    with rejects(StudyFileError, "roughness.reference_area"):
        case.replace({"roughness.reference_area": "0 mm^2"})


def test_downward_sweep_is_allowed() -> None:
    case = Case.from_text("[solver]\nfrequency_start = 530\nfrequency_stop = 440\n")
    assert case.solver.frequency_start > case.solver.frequency_stop


def test_direction_is_scaled_to_length_one() -> None:
    case = Case.from_text("[excitation]\ndirection = [0, 3, 4]")
    assert isinstance(case, TwoBladeCase)
    assert case.excitation.direction == (0.0, 0.6, 0.8)


def test_byte_order_mark_and_windows_lines(tmp_path: Path) -> None:
    path = tmp_path / "windows.toml"
    path.write_bytes(b"\xef\xbb\xbf[friction]\r\ncoefficient = 0.4\r\n")
    assert load_case(path).friction.coefficient == 0.4


@pytest.mark.long
def test_units_package_is_loaded_for_units_only() -> None:
    import subprocess

    code = (
        "import sys; from stickslip.case.case import Case; Case.from_text('[friction]\\ncoefficient = 0.2');"
        "assert 'pint' not in sys.modules; Case.from_text('[preload]\\ncentrifugal_force = \"1 kN\"');"
        "assert 'pint' in sys.modules"
    )
    subprocess.run([sys.executable, "-c", code], check=True)


@pytest.mark.parametrize(
    "text",
    ["a\\u0000b", "two\\nlines", "\\u001b[31mred", "\\u0085"],
)
def test_a_title_is_one_line_that_can_be_shown(text: str) -> None:
    """NetCDF ends a text at U+0000, which was met after everything was solved."""
    with rejects(StudyFileError, "study.title"):
        Case.from_text(f'[study]\ntitle = "{text}"\n')
    assert Case.from_mapping({"study": {"title": "Schaufel \u2013 \u00b5m, 100 %"}})


def test_the_signature_names_the_class_of_each_section_without_its_keys() -> None:
    words = str(inspect.signature(TwoBladeCase))
    assert "solver=SolverSection(...)" in words
    assert "roughness=RoughnessSection(...)" in words
    assert "rotation=None" in words
    assert inspect.signature(MeshCase).parameters["structure"].default is inspect.Parameter.empty


def test_each_kind_says_how_its_faces_get_more_rows_of_pairs() -> None:
    section, key = TwoBladeCase.finer_faces.split(" = ")[0].split(".")
    assert key in Case.allowed_keys()[section]
    assert MeshCase.finer_faces != TwoBladeCase.finer_faces


def test_another_kind_of_a_section_is_a_change() -> None:
    """The kind is the default of its own class, not that of the section."""
    flat = Case.from_mapping({"damper": {"kind": "flat", "thickness": "3 mm"}, "geometry": {"platform_angle": "0 deg"}})
    assert 'damper.kind = "flat"' in flat.changed_keys()
    mode = {"kind": "mode", "smallest_amplitude": "1 um", "largest_amplitude": "10 um"}
    assert 'analysis.kind = "mode"' in Case.from_mapping({"analysis": mode}).changed_keys()
    assert Case.from_mapping({}).changed_keys() == ()
