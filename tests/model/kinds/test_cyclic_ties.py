"""[ties.NAME] in studies of disks."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

import stickslip as ss
from model_writers import write_inp
from sectors import tied_blade
from sentences import rejects
from stickslip.case.case import Case
from stickslip.core.errors import InputError
from stickslip.model.kinds.cyclic import CyclicSetup
from stickslip.model.model import build_model, set_up


def tied_case(folder: Path, **sections: Any) -> Case:
    mesh = tied_blade(0.6, 3)
    sides = {name: mesh.sides(name) for name in ("foot", "rim", "tip")}
    nodes = {name: mesh.node_sets[name] for name in ("left", "right", "bore")}
    whole = ss.Mesh(mesh.points, mesh.cells, mesh.body, nodes, mesh.body_names, sides)
    write_inp(folder / "sector.inp", whole, ["disk", "blade"], list(sides), "bore")
    content = {
        "structure": {"kind": "cyclic", "file": str(folder / "sector.inp"), "length_unit": "mm", "left": "left",
                      "right": "right"},
        "ties": {"root": {"dependent": "foot", "independent": "rim", "tolerance": "10 mm"}},
        "interfaces": {"wall": {"first": "tip", "second": "ground", "normal_load": "100 N"}},
        "contact_stiffness": {"normal_stiffness": "1e7 N/m", "tangential_stiffness": "1e7 N/m"},
        "friction": {"coefficient": 0.3},
        "travelling_wave": {"engine_order": 1},
        "forces": {"gas": {"set": "tip", "direction": [0, 0, 1], "amplitude": "1 N"}},
        "responses": {"tip": {"set": "tip", "direction": [0, 0, 1]}},
        "solver": {"frequency_start": "100 Hz", "frequency_stop": "200 Hz", "harmonics": 1},
    }  # fmt: skip
    return Case.from_mapping(content | sections)


@pytest.mark.slow
def test_a_tied_blade_of_a_study_has_the_frequencies_of_the_tied_sector(tmp_path: Path) -> None:
    case = tied_case(tmp_path)
    setup = set_up(case)
    assert isinstance(setup, CyclicSetup)
    assert any(label == "Tied nodes, root" for label, *_ in setup.layout.facts)
    sector = build_model(case).substructure.require_sector()
    at_rest = setup.sector.at_rest()
    assert at_rest.constraints is not None
    expected = ss.sector_frequencies(at_rest, setup.symmetry, range(3), 3)
    for diameter, full in expected.items():
        np.testing.assert_allclose(sector.natural_frequencies(diameter, 3), full, rtol=1e-4)


@pytest.mark.slow
def test_without_its_ties_the_blade_is_loose(tmp_path: Path) -> None:
    """Contact alone supports the blade then, which is another structure."""
    with_ties, without = set_up(tied_case(tmp_path)), set_up(tied_case(tmp_path, ties={}))
    assert isinstance(with_ties, CyclicSetup)
    assert isinstance(without, CyclicSetup)
    assert with_ties.sector.constraints is not None
    assert without.sector.constraints is None


@pytest.mark.slow
def test_places_that_follow_other_nodes(tmp_path: Path) -> None:
    response = {"foot": {"set": "foot", "direction": [0, 0, 1]}}
    with rejects(InputError, "responses.foot"):
        set_up(tied_case(tmp_path, responses=response))
    wall = {"wall": {"first": "foot", "second": "ground", "normal_load": "100 N"}}
    with rejects(InputError, "interfaces.wall"):
        set_up(tied_case(tmp_path, interfaces=wall))
