"""The section [roughness]: machined faces under Persson's law by default, and what a key of another law implies."""

from __future__ import annotations

import pytest

from sentences import rejects
from stickslip.case.case import Case
from stickslip.case.sections import RoughnessSection
from stickslip.core.errors import StudyFileError


def roughness(text: str) -> RoughnessSection:
    section = Case.from_text(f"[roughness]\n{text}\n").roughness
    assert section is not None
    return section


def test_the_default_is_a_machined_face_under_the_law_that_agrees_with_boundary_elements() -> None:
    section = roughness("")
    assert (section.law, section.sq, section.fractal_roughness) == ("persson", 1e-6, None)
    assert (section.fractal_dimension, section.sample_length, section.mode) == (2.2, 0.8e-3, None)
    assert Case.from_text(Case().to_text()) == Case()  # a file without a key means what the template writes


@pytest.mark.parametrize(
    "line", ['mode = "consistent"', 'mode = "paper"', 'reference_area = "180 mm^2"\nallocation = "pressure"']
)
def test_a_key_of_the_fractal_law_alone_chooses_it(line: str) -> None:
    """Files of versions whose only law it was name its keys and not the law."""
    assert roughness(line).law == "fractal"
    assert roughness(line).fractal_mode in ("consistent", "varying-curvature")


def test_a_law_that_is_named_remains() -> None:
    assert roughness('law = "persson"\nmode = "consistent"').law == "persson"  # files of earlier versions
    with rejects(StudyFileError, "roughness.mode"):
        roughness('law = "persson"\nmode = "unloading"')


def test_a_given_scale_replaces_the_default_one() -> None:
    assert roughness('fractal_roughness = "1e-9 m"').sq is None
    assert roughness('sq = "2 um"').fractal_roughness is None
    with rejects(StudyFileError, "roughness.sq"):
        roughness('sq = "2 um"\nfractal_roughness = "1e-9 m"')


def test_a_given_slope_replaces_the_default_shortest_wave() -> None:
    section = roughness('sq = "1.2 um"\nsdq = 0.07')
    assert (section.sdq, section.shortest_length) == (0.07, None)
    assert roughness("").shortest_length == 1e-6
    case = Case.from_text("[roughness]\nsdq = 0.07\n")
    assert Case.from_text(case.to_text()) == case
    assert Case().replace({"roughness.sdq": 0.07}).roughness == case.roughness


@pytest.mark.parametrize(
    "lines", ['shortest_length = "1 um"', 'fractal_roughness = "1e-9 m"'], ids=["two shortest waves", "no sq"]
)
def test_a_slope_beside_a_key_that_it_replaces_is_rejected(lines: str) -> None:
    with rejects(StudyFileError, "roughness.sdq"):
        roughness(f"sdq = 0.07\n{lines}")


@pytest.mark.parametrize("value", ["0", "-0.1", '"3 um"', "1e9"])
def test_a_value_that_is_no_slope_is_rejected(value: str) -> None:
    with rejects(StudyFileError, "roughness.sdq"):
        roughness(f"sdq = {value}")


@pytest.mark.parametrize("value", ["0", '"3 N"', "-1.0"])
def test_a_factor_that_is_no_stiffness_is_rejected(value: str) -> None:
    with rejects(StudyFileError, "roughness.stiffness_factor"):
        roughness(f"stiffness_factor = {value}")
