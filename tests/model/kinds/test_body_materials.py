"""Orthotropic bodies of a study, over and under the material of the mesh file."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from own_cases import EXAMPLE, mesh_case
from sentences import rejects
from stickslip.case.case import Case
from stickslip.core.errors import InputError
from stickslip.model.kinds.mesh import MeshSetup
from stickslip.model.model import set_up
from stickslip.structure.anisotropy import orthotropic_matrix, rotated_matrix
from stickslip.structure.elasticity import Material

CRYSTAL: dict[str, Any] = {
    "young_moduli": ["128 GPa", "128 GPa", "100 GPa"],
    "poisson_ratios": [0.38, 0.3, 0.3],
    "shear_moduli": ["120 GPa", "110 GPa", "100 GPa"],
}
MATRIX = orthotropic_matrix([128e9, 128e9, 100e9], [0.38, 0.3, 0.3], [120e9, 110e9, 100e9])


def case_with(**body: Any) -> Case:
    data = mesh_case().as_mapping(only_explicit=True)
    data["bodies"] = {"damper": {"density": "8200 kg/m^3", **body}}
    data["structure"]["file"] = str(EXAMPLE / "beam_and_block.inp")
    return Case.from_mapping(data)


def materials(case: Case) -> tuple[Material, ...]:
    setup = set_up(case)
    assert isinstance(setup, MeshSetup)
    return setup.materials


@pytest.mark.slow
def test_axes_of_an_orthotropic_body() -> None:
    beam, block = materials(case_with(**CRYSTAL, axis_1=[1, 1, 0], axis_2=[0, 3, 0], fatigue_limit="90 MPa"))
    assert beam.elastic is None
    first = np.array([1.0, 1.0, 0.0]) / np.sqrt(2.0)
    axes = np.vstack([first, [-first[0], first[0], 0.0], [0.0, 0.0, 1.0]])
    np.testing.assert_allclose(block.elastic_matrix(), rotated_matrix(MATRIX, axes), rtol=1e-12, atol=1.0)
    assert (block.density, block.fatigue_limit) == (8200.0, 90e6)
    without_axes = materials(case_with(**CRYSTAL))[1]
    np.testing.assert_allclose(without_axes.elastic_matrix(), MATRIX, rtol=1e-12, atol=1.0)


WRONG: dict[str, tuple[dict[str, Any], tuple[str, ...]]] = {
    "also isotropic": ({**CRYSTAL, "young_modulus": "200 GPa"}, ("young_moduli", "young_modulus")),
    "incomplete": ({"young_moduli": CRYSTAL["young_moduli"]}, ("young_moduli",)),
    "axes alone": ({"axis_1": [1, 0, 0]}, ("axis_1",)),
    "parallel axes": ({**CRYSTAL, "axis_1": [0, 1, 0]}, ("axis_1",)),
    "negative energy": ({**CRYSTAL, "poisson_ratios": [0.9, 0.9, 0.9]}, ("poisson_ratios",)),
}


@pytest.mark.slow
@pytest.mark.parametrize("name", WRONG)
def test_what_is_rejected(name: str) -> None:
    body, keys = WRONG[name]
    with rejects(InputError, *(f"bodies.damper.{key}" for key in keys)):
        materials(case_with(**body))


@pytest.mark.slow
def test_half_of_an_isotropic_material_over_an_anisotropic_one(tmp_path: Path) -> None:
    """The file's block is orthotropic; its density may change alone, its modulus not."""
    text = (EXAMPLE / "beam_and_block.inp").read_text(encoding="utf-8")
    lines = text.splitlines()
    at = lines.index("*ELASTIC")
    constants = ["128e3, 128e3, 100e3, .38, .3, .3, 120e3, 110e3,", "100e3"]
    lines[at : at + 2] = ["*ELASTIC, TYPE=ENGINEERING CONSTANTS", *constants]
    (tmp_path / "deck.inp").write_text("\n".join(lines) + "\n", encoding="utf-8")

    def case(**body: Any) -> Case:
        data = case_with(**body).as_mapping(only_explicit=True)
        data["structure"]["file"] = str(tmp_path / "deck.inp")
        return Case.from_mapping(data)

    beam, block = materials(case())
    assert beam.elastic == block.elastic
    np.testing.assert_allclose(block.elastic_matrix(), MATRIX, rtol=1e-12, atol=1.0)
    isotropic = materials(case(young_modulus="200 GPa", poisson_ratio=0.3))[1]
    assert isotropic == Material(200e9, 0.3, 8200.0)
    with rejects(InputError, "bodies.damper.young_modulus"):
        materials(case(young_modulus="200 GPa"))
