"""Stiffness over pressure from a table that a study file holds or names, prescribed and solved preload."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

import stickslip as ss
from law_studies import JOINT, interface_text, write_masses, write_study
from own_cases import mesh_case
from sentences import printed_sentence, rejects
from stickslip.core.errors import ImportFileError, InputError
from stickslip.model.model import load_joint, set_up
from stickslip.study.check import check

PRESSURE, NORMAL, TANGENTIAL = [1e4, 1e5, 1e7], [2e11, 8e11, 9e12], [1e11, 5e11, 6e12]
TABLE = {
    "pressure": PRESSURE,
    "normal_stiffness": [f"{value:g} N/m^3" for value in NORMAL],
    "tangential_stiffness": TANGENTIAL,
}
CSV = """\
# measured with ultrasound
tangential_stiffness [N/mm^3]; pressure [MPa]; normal_stiffness [N/m^3]
100; 0.01; 2e11
500; 0.1; 8e11

6e3; 10; 9e12
"""
LAW = ss.MeasuredStiffness(np.array(PRESSURE), np.array(NORMAL), np.array(TANGENTIAL))


def measured_case(tables: dict[str, Any], allocation: str = "area", **changes: Any) -> Any:
    """The own mesh whose sole follows a table; the lid has a given stiffness."""
    section = {"stiffness_law": "measured", "stiffness_constants": tables, "allocation": allocation}
    return mesh_case(**{f"interfaces__sole__{key}": value for key, value in section.items()}, **changes)


@pytest.fixture
def table_file(tmp_path: Path) -> str:
    target = tmp_path / "stiffness.csv"
    target.write_text(CSV, encoding="utf-8")
    return str(target)


@pytest.mark.slow
@pytest.mark.parametrize("allocation", ["area", "pressure"])
@pytest.mark.parametrize("by_file", [False, True])
def test_springs_are_those_of_python(allocation: str, by_file: bool, table_file: str) -> None:
    case = measured_case({"file": table_file} if by_file else TABLE, allocation)
    joint = load_joint(case, set_up(case).layout)
    sole = joint.face_pairs.face == 0
    area, preload = joint.face_pairs.area[sole], np.maximum(joint.preload[sole], 0.0)
    normal, tangential = ss.springs_of_pairs(LAW, area, preload, allocation=allocation)  # type: ignore[arg-type]
    np.testing.assert_allclose(joint.normal_stiffness[sole], normal, rtol=1e-14)
    np.testing.assert_allclose(joint.tangential_stiffness[sole], tangential, rtol=1e-14)
    assert joint.normal_stiffness[~sole].sum() == pytest.approx(1e6)
    assert joint.stiffness_warnings == ()


@pytest.mark.slow
def test_one_table_for_all_faces() -> None:
    section = {"stiffness_law": "measured", "stiffness_constants": TABLE}
    data = mesh_case(interfaces__lid__normal_stiffness="1 N/m").to_dict() | {"contact_stiffness": section}
    del data["roughness"], data["interfaces"]["lid"]["normal_stiffness"]
    del data["interfaces"]["lid"]["tangential_stiffness"]
    case = ss.Case.from_mapping(data)
    joint = load_joint(case, set_up(case).layout)
    load = np.maximum(joint.preload, 0.0)
    normal, _ = ss.springs_of_pairs(LAW, joint.face_pairs.area, load, face=joint.face_pairs.face)
    np.testing.assert_allclose(joint.normal_stiffness, normal, rtol=1e-14)


@pytest.mark.slow
def test_a_pressure_outside_of_the_table_is_a_warning() -> None:
    case = measured_case(TABLE | {"pressure": ["0.01 MPa", "0.1 MPa", "0.2 MPa"]})
    joint = load_joint(case, set_up(case).layout)
    (sentence,) = joint.stiffness_warnings
    printed_sentence(sentence, "sole", "1e+04", "2e+05 Pa")
    assert any(sentence == words for title, rows in check(case) if title == "Warnings" for _, words in rows)


def solved_model(folder: Path, allocation: str, normal_law: str, table: str = "pressure = [1e3, 1e4, 1e6]") -> Any:
    """Two masses, pressed to the ground by 6 N and 2 N: 120 and 40 kPa less what their springs carry."""
    write_masses(folder, 2)
    keys = f'stiffness_law = "measured"\nallocation = "{allocation}"\n[interfaces.joint.stiffness_constants]\n'
    keys += f"{table}\nnormal_stiffness = {NORMAL}\ntangential_stiffness = {TANGENTIAL}\n"
    joint = f'[interfaces.joint]\nfirst = "all"\nsecond = "ground"\n{JOINT}{keys}'
    loads = f'[preload]\nmethod = "solved"\nnormal_law = "{normal_law}"\n'
    for node, force in ((1, 6), (2, 2)):
        loads += f"[static_loads.press{node}]\nnode = {node}\ndirection = [0, 0, 1]\nforce = {force}.0\n"
    return ss.build_model(ss.load_case(write_study(folder, joint, loads)))


@pytest.mark.slow
def test_a_list_of_passwords_is_not_shown(tmp_path: Path) -> None:
    """The name of the file may be that of another file; the first entry of its first line was in the message."""
    file = tmp_path / "passwd"
    file.write_text("root:x:0:0:root\nme:x:1:2:secret\n", encoding="utf-8")
    case = measured_case({"file": str(file)})
    with rejects(ImportFileError, "interfaces.sole.stiffness_constants.file") as error:
        load_joint(case, set_up(case).layout)
    assert "root:" not in str(error.value)
    assert "secret" not in str(error.value)


@pytest.mark.slow
def test_a_stiffness_that_no_joint_has_is_rejected_by_its_law() -> None:
    case = measured_case(TABLE | {"normal_stiffness": [1e38, 2e38, 3e38]})
    with rejects(InputError, "interfaces.sole", "interfaces.sole.normal_load"):
        load_joint(case, set_up(case).layout)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("allocation", "normal_law"), [("area", "spring"), ("pressure", "spring"), ("pressure", "pressure-gap")]
)
def test_a_solved_preload_follows_the_table(allocation: str, normal_law: str, tmp_path: Path) -> None:
    model = solved_model(tmp_path, allocation, normal_law)
    joint, force = model.joint, model.preload.state.normal_force
    law = ss.MeasuredStiffness(np.array([1e3, 1e4, 1e6]), np.array(NORMAL), np.array(TANGENTIAL))
    normal, tangential = ss.springs_of_pairs(law, joint.face_pairs.area, force, allocation=allocation)  # type: ignore[arg-type]
    assert (force > 0.5).all()
    np.testing.assert_allclose(joint.tangential_stiffness, tangential, rtol=1e-3)
    if normal_law == "spring":
        np.testing.assert_allclose(joint.normal_stiffness, normal, rtol=1e-3)
    else:  # the slope of the pressure over the closure is the law at the pressure of each pair
        np.testing.assert_allclose(joint.normal_stiffness, normal, rtol=0.02)
    # The curve of pressure over closure begins at 1 % of the mean pressure of 80 kPa, below the table.
    below = ["800 Pa are below the measured range, 1e+03 to 1e+06 Pa"] if normal_law == "pressure-gap" else []
    assert len(joint.stiffness_warnings) == len(below)
    assert all(part in words for part, words in zip(below, joint.stiffness_warnings, strict=True))


@pytest.mark.slow
@pytest.mark.parametrize(
    ("allocation", "normal_law", "warns"), [("area", "spring", False), ("area", "pressure-gap", True)]
)
def test_a_solved_pressure_outside_of_the_table_is_a_warning(
    allocation: str, normal_law: str, warns: bool, tmp_path: Path
) -> None:
    """The mean pressure, 40 to 80 kPa, is in this table, the larger of the two pressures is not."""
    model = solved_model(tmp_path, allocation, normal_law, "pressure = [1e3, 1e4, 8.2e4]")
    pressure = model.preload.state.normal_force / model.joint.face_pairs.area
    assert pressure.mean() < 8.2e4 < pressure.max()
    sentences = model.joint.stiffness_warnings
    assert bool(sentences) is warns
    for each in sentences:
        printed_sentence(each, "8.2e+04 Pa")


@pytest.mark.slow
@pytest.mark.parametrize(
    ("content", "expected"),
    [
        (None, (ImportFileError, "interfaces.sole.stiffness_constants.file")),
        ("", (ImportFileError, "interfaces.sole.stiffness_constants.file")),
        (
            "pressure [MPa], normal_stiffness [N/m^3]\n1,2\n",
            (ImportFileError, "interfaces.sole.stiffness_constants.file"),
        ),
        (
            "pressure, normal_stiffness [N/m^3], tangential_stiffness [N/m^3]\n1,2,3\n",
            (ImportFileError, "interfaces.sole.stiffness_constants.file"),
        ),
        ("force [N], pressure [Pa]\n1,2\n", (ImportFileError, "interfaces.sole.stiffness_constants.file")),
        (CSV.replace("500; 0.1; 8e11", "500; 0.1"), (ImportFileError, "interfaces.sole.stiffness_constants.file")),
        (CSV.replace("8e11", "x"), (ImportFileError, "interfaces.sole.stiffness_constants.file")),
        (CSV.replace("[MPa]", "[mm]"), (ImportFileError, "interfaces.sole.stiffness_constants.file")),
        (CSV.replace("0.1;", "0.01;"), (InputError, "interfaces.sole.stiffness_constants.file")),
    ],
)
def test_a_file_that_is_no_table(content: str | None, expected: tuple[Any, ...], tmp_path: Path) -> None:
    file = tmp_path / "k.csv"
    if content is not None:
        file.write_text(content, encoding="utf-8")
    case = measured_case({"file": str(file)})
    with rejects(*expected) as error:
        load_joint(case, set_up(case).layout)
    assert error.value.keys == ("interfaces.sole.stiffness_constants.file",)


@pytest.mark.slow
def test_a_contact_law_takes_its_stiffness_from_a_table(tmp_path: Path) -> None:
    """An Iwan joint: small motions feel the tangential stiffness under the normal load."""
    write_masses(tmp_path, 2)
    (tmp_path / "k.csv").write_text(CSV, encoding="utf-8")
    keys = 'normal_load = "2 N"\nstiffness_law = "measured"\nstiffness_constants = { file = "k.csv" }\n'
    text = interface_text("joint", "iwan").replace('tangential_stiffness = "1e4 N/m"\n', keys)
    (law,) = ss.build_model(ss.load_case(write_study(tmp_path, text))).pairs.laws
    normal, tangential = ss.springs_of_pairs(LAW, [5e-5, 5e-5], [1.0, 1.0])
    np.testing.assert_allclose(law.resting_springs(), np.column_stack([tangential, tangential, normal]), rtol=1e-14)
