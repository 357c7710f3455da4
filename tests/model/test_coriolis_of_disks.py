"""Coriolis forces of a disk of a study against the unreduced rotating sector."""

from __future__ import annotations

import numpy as np
import pytest

import stickslip as ss
from stickslip.model.model import build_model, kind_of
from turning_cases import disk_case


@pytest.mark.long
def test_coriolis_forces_of_a_disk_are_those_of_the_rotating_sector() -> None:
    model = build_model(disk_case(speed="9000 rpm", coriolis=True))
    sector = model.in_study.sector
    assert sector is not None
    symmetry = sector.symmetry
    reduced = model.substructure.require_sector()
    assert reduced.has_coriolis
    for direction in ("forward", "backward"):
        full = ss.sector_frequencies(
            sector.structure,
            symmetry,
            (1, 4),
            8,
            gyroscopic=sector.gyroscopic,
            direction=direction,
        )
        for diameter, expected in full.items():
            found = reduced.natural_frequencies(diameter, 8, direction)
            np.testing.assert_allclose(found[6:], expected[6:], rtol=5e-3)
    backward, forward = (reduced.natural_frequencies(1, 8, way)[6] for way in ("backward", "forward"))
    assert backward > 1.003 * forward
    case = disk_case(speed="9000 rpm", coriolis=True)
    assert not any("Coriolis" in words for words in kind_of(case).warnings(case))
    still = disk_case(speed="9000 rpm")
    assert any("rotation.coriolis = true" in words for words in kind_of(still).warnings(still))
