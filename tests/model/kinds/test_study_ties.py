"""Studies with ties: in the study file and in the mesh file, with reference nodes as force and response places."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scipy.sparse.linalg import spsolve

from sentences import printed_sentence, rejects
from stickslip.case.case import Case
from stickslip.core.errors import InputError
from stickslip.model.model import build_model, set_up
from stickslip.structure.elasticity import Structure
from stickslip.structure.recovery import Recovery
from stickslip.study.check import check
from stickslip.study.run import run
from tied_decks import two_blocks, write_deck

COUPLED = "*COUPLING, REF NODE=9001, SURFACE=stop, CONSTRAINT NAME=c\n*DISTRIBUTING\n1,6\n"
REFERENCE = "9001, 0.03, 0.005, 0.07"
TIE = {"joint": {"dependent": "upper", "independent": "lower"}}


def study(folder: Path, cards: str = COUPLED, **changes: Any) -> Case:
    """Two blocks of which the lower one is clamped and the upper one tied to it, its top under a rigid ground."""
    mesh = two_blocks()
    side = np.flatnonzero(np.isclose(mesh.points[:, 0], 20e-3) & (mesh.points[:, 2] > 42e-3))
    mesh.node_sets["side"] = side  # type: ignore[index]
    write_deck(folder / "deck.inp", mesh, cards, more_nodes=REFERENCE)
    data: dict[str, Any] = {
        "structure": {"kind": "mesh", "file": str(folder / "deck.inp"), "length_unit": "m", "fixed": []},
        "interfaces": {"lid": {"first": "side", "second": "ground", "normal_load": "100 N",
                               "normal_stiffness": "1e7 N/m", "tangential_stiffness": "1e7 N/m"}},
        "ties": TIE,
        "forces": {"push": {"node": 9001, "direction": [0.6, 0, 0.8], "amplitude": "20 N"}},
        "responses": {"end": {"node": 9001, "direction": [1, 0, 0]}},
        "reduction": {"modes": 5},
        "damping": {"rayleigh_beta": "1e-7 s"},
        "solver": {"frequency_start": "4100 Hz", "frequency_stop": "4500 Hz", "harmonics": 1, "samples": 64},
        "output": {"figure_formats": []},
    }  # fmt: skip
    return Case.from_mapping(data | changes)


@pytest.mark.slow
def test_a_force_on_a_reference_node_moves_the_contact_as_the_full_model_does(tmp_path: Path) -> None:
    """Exact for any reduction: static displacements of contact nodes under the force, and the work of the force."""
    case = study(tmp_path)
    model = build_model(case)
    structure, group = model.structure, model.joint.layout.node_groups["forces.push"]
    assert isinstance(structure, Structure)
    row = np.array([0.6, 0.0, 0.8]) @ model.reduced.node_groups["forces.push"]
    reduced: Any = np.linalg.solve(model.superelement.stiffness, row)
    load: Any = group.unit_loads(structure.full_size) @ [0.6, 0.0, 0.8]
    whole = structure.expand(spsolve(structure.stiffness.tocsc(), structure.gather(load)))
    nodes = model.joint.face_pairs.nodes
    own = np.array([reduced[model.superelement.unknowns_of(int(node))] for node in nodes])
    np.testing.assert_allclose(own, whole.reshape(-1, 3)[nodes], rtol=1e-8, atol=1e-9 * np.abs(whole).max())
    recovery = model.superelement.recovery
    assert isinstance(recovery, Recovery)
    full = recovery.with_omitted_modes(reduced[:, None], load[:, None])
    np.testing.assert_allclose(full[:, 0], whole, atol=1e-9 * np.abs(whole).max())
    np.testing.assert_allclose(group.mean_of(whole.reshape(-1, 3)), group.unit_loads(len(whole)).T @ whole)
    assert group.mean_place(structure.mesh.points).tolist() == [0.03, 0.005, 0.07]


@pytest.mark.slow
def test_a_tie_in_the_study_is_that_of_the_file(tmp_path: Path) -> None:
    of_study = set_up(study(tmp_path))
    in_file = set_up(study(tmp_path, f"*TIE, NAME=t\nsupper, slower\n{COUPLED}", ties={}))
    one, other = of_study.assemble(), in_file.assemble()
    assert isinstance(one, Structure)
    assert isinstance(other, Structure)
    assert one.stiffness.shape == other.stiffness.shape
    assert abs(one.stiffness - other.stiffness).max() < 1e-9 * abs(one.stiffness).max()
    count = two_blocks().node_sets["upper"].size
    facts = {name: value for name, value, _, _ in of_study.layout.facts}
    assert (facts["Tied nodes, joint"], facts["Largest distance of a tied node, joint"]) == (count, 0.0)
    assert not [words for words in of_study.layout.messages if "ties.joint" in words]
    partly = set_up(study(tmp_path, ties={"joint": TIE["joint"] | {"dependent": "b"}}))
    printed_sentence("\n".join(partly.layout.messages), "ties.joint", "0.45 mm")
    assert dict(of_study.sizes())["dependent displacements"] == f"{3 * count}"


@pytest.mark.slow
def test_a_node_that_follows_is_a_place_too(tmp_path: Path) -> None:
    mesh = two_blocks()
    node = int(mesh.node_sets["upper"][1])
    case = study(tmp_path, responses={"end": {"node": node + 1, "direction": [0, 0, 1]}})
    (group,) = [group for name, group in set_up(case).layout.node_groups.items() if name == "responses.end"]
    values = np.random.default_rng(2).normal(size=(mesh.n_nodes, 3))
    structure = set_up(case).assemble()
    assert isinstance(structure, Structure)
    motion = structure.expand(structure.gather(values.ravel())).reshape(-1, 3)
    np.testing.assert_allclose(group.mean_of(motion), motion[node], atol=1e-12)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("changes", "keys"),
    [
        ({"ties": {"joint": {"dependent": "nowhere", "independent": "lower"}}}, "ties.joint"),
        ({"ties": {"joint": {"dependent": "top", "independent": "lower"}}}, "ties.joint"),
        ({"ties": {}}, None),
        ({"cards": "*RIGID BODY, NSET=side, REF NODE=9001\n"}, "interfaces.lid"),
        ({"cards": f"{COUPLED}*BOUNDARY\n9001, 1, 6\n"}, "forces.push.node"),
        ({"cards": "*EQUATION\n2\n9001, 1, 1., 9001, 2, -1.\n"}, "forces.push.node"),
    ],
)
def test_what_does_not_fit_is_named(tmp_path: Path, changes: dict[str, Any], keys: str | None) -> None:
    case = study(tmp_path, **changes)
    if changes == {"ties": {}}:
        assert set_up(case).layout.face_pairs.n_pairs  # the contact alone may support the upper block
        return
    with rejects(InputError, *([keys] if keys else [])):
        set_up(case)


@pytest.mark.slow
def test_a_tied_study_runs_to_its_report(tmp_path: Path) -> None:
    case = study(tmp_path)
    run(case, tmp_path / "out")
    page = (tmp_path / "out" / "report.html").read_text(encoding="utf-8")
    assert "Tied nodes, joint" in page
    assert any("dependent displacements" in str(row) for row in check(case))
