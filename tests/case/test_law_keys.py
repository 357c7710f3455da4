"""What a study file may say of contact laws and stiffness laws, and what is rejected when it is read."""

from __future__ import annotations

import pickle
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, ClassVar

import numpy as np
import pytest

import stickslip as ss
from law_studies import HEADER, REST, interface_text
from sentences import rejects
from stickslip.case.case import Case
from stickslip.contact.constants import constant, declaration_of
from stickslip.core.units import Quantity
from stickslip.sweeps.axes import swept_keys
from stickslip.sweeps.plan import plan_cases


def case_of(*interfaces: str) -> Case:
    return Case.from_text(HEADER + "".join(interfaces) + REST)


IWAN = case_of(interface_text("joint", "iwan"))
TABLE = {"pressure": ["1 MPa", "4 MPa"], "normal_stiffness": ["2e4 N/mm^3", 4e13], "tangential_stiffness": [1e13, 2e13]}
TABLE_KEYS = " ".join(f"stiffness_constants.{key}" for key in TABLE)
MEASURED: dict[str, Any] = {
    "interfaces.joint.law": "coulomb",
    "interfaces.joint.constants": {},
    "interfaces.joint.tangential_stiffness": None,
    "interfaces.joint.normal_load": "300 N",
    "interfaces.joint.stiffness_law": "measured",
}


def changed(changes: dict[str, Any]) -> Case:
    """The study with other keys; None takes a key out."""
    data = IWAN.to_dict()
    for key, value in changes.items():
        section, name, *rest = key.split(".")
        home = data[section]
        for part in [name, *rest[:-1]] if rest else []:
            home = home.setdefault(part, {})
        last = rest[-1] if rest else name
        if value is None:
            home.pop(last, None)
        else:
            home[last] = value
    return Case.from_mapping(data)


def test_a_study_without_interfaces_says_what_to_give() -> None:
    with rejects(ss.StudyFileError, "interfaces"):
        case_of()


def test_values_are_in_si_and_come_back_from_mapping_text_and_pickle() -> None:
    case = case_of(interface_text("joint", "cubic"))
    constants = case.interfaces["joint"].constants  # type: ignore[attr-defined]
    assert constants.values == {"stiffness": (1e4, 9e3, 0.0), "cubic_stiffness": 1e9}
    assert Case.from_mapping(case.to_dict()) == case
    assert Case.from_text(case.to_text()).to_dict() == case.to_dict()
    assert pickle.loads(pickle.dumps(case)) == case
    assert "[interfaces.joint.constants]" in case.to_text()
    other = case.replace({"interfaces.joint.constants.cubic_stiffness": "2 N/mm^3"})
    assert other.interfaces["joint"].constants.values["cubic_stiffness"] == 2e9  # type: ignore[attr-defined]


@pytest.mark.parametrize(
    ("changes", "keys"),
    [
        ({"interfaces.joint.law": "iwann"}, "law"),
        ({"interfaces.joint.constants.beta": 0.3}, "constants.beta"),
        ({"interfaces.joint.constants.ratio": None}, "constants.ratio"),
        ({"interfaces.joint.constants.slip_force": "3 mm"}, "constants.slip_force"),
        ({"interfaces.joint.constants.slip_force": [1, 2, 3]}, "constants.slip_force"),
        ({"interfaces.joint.constants.exponent": 0.5}, "constants.exponent"),
        ({"interfaces.joint.constants.slip_force": "-1 N"}, "constants.slip_force"),
        ({"interfaces.joint.constants.slip_force": "1e13 N"}, "constants.slip_force"),
        ({"interfaces.joint.constants": "iwan"}, "constants"),
        ({"interfaces.joint.friction": 0.2}, "friction"),
        ({"interfaces.joint.gap": "1 mm"}, "gap"),
        ({"interfaces.joint.normal_load": "3 N"}, "normal_load"),
        ({"interfaces.joint.tangential_stiffness": None}, "normal_load"),  # roughness follows from it
        ({"interfaces.joint.constants.normal_stiffness": 1.0}, "constants.normal_stiffness"),
        ({"interfaces.joint.law": None}, "constants"),
        ({"interfaces.joint.stiffness_law": "measured"}, TABLE_KEYS),
        ({"interfaces.joint.stiffness_law": "fractal"}, "stiffness_law"),
        ({"interfaces.joint.stiffness_law": "tabel"}, "stiffness_law"),
        ({"interfaces.joint.stiffness_constants": TABLE}, "stiffness_constants"),
        ({"interfaces.joint.allocation": "area"}, "allocation"),
        (
            {"interfaces.joint.stiffness_law": "measured", "interfaces.joint.stiffness_constants": TABLE},
            "tangential_stiffness",
        ),
        (
            MEASURED | {"interfaces.joint.stiffness_constants": TABLE | {"pressure": ["4 MPa", "1 MPa"]}},
            "stiffness_constants.pressure",
        ),
        (
            MEASURED | {"interfaces.joint.stiffness_constants": TABLE | {"tangential_stiffness": [0.0, 1e13]}},
            "stiffness_constants.tangential_stiffness",
        ),
        (
            MEASURED | {"interfaces.joint.stiffness_constants": TABLE | {"file": "a.csv"}},
            TABLE_KEYS,
        ),
        (
            MEASURED | {"interfaces.joint.stiffness_constants": TABLE | {"pressure": "1 MPa"}},
            "stiffness_constants.pressure",
        ),
    ],
)  # fmt: skip
def test_what_does_not_fit_is_rejected_by_its_key(changes: dict[str, Any], keys: str) -> None:
    with rejects(ss.StudyFileError, *(f"interfaces.joint.{key}" for key in keys.split())):
        changed(changes)


def test_each_kind_of_useless_stiffness_is_rejected() -> None:
    text = interface_text("joint", "cubic")
    for key, value in (("normal_stiffness", '"1 N/m"'), ("stiffness_law", '"measured"')):
        extra = text.replace('law = "cubic"\n', f'law = "cubic"\n{key} = {value}\n')
        if key == "stiffness_law":
            extra += '[interfaces.joint.stiffness_constants]\nfile = "a.csv"\n'
        with rejects(ss.StudyFileError, f"interfaces.joint.{key}"):
            case_of(extra)


def test_a_gap_between_matrices_is_for_laws_that_have_one() -> None:
    text = interface_text("joint", "coulomb").replace('law = "coulomb"', 'gap = "1 mm"')
    with rejects(ss.StudyFileError, "interfaces.joint.gap"):
        case_of(text)


def test_a_solved_preload_and_a_law_that_needs_another_load() -> None:
    """Beside another law no stiffness may follow from the pressure that is solved for."""
    load = {
        "preload": {"method": "solved"},
        "static_loads": {"pull": {"node": 1, "direction": [0, 0, 1], "force": 3.0}},
    }
    Case.from_mapping(IWAN.to_dict() | load)
    pressed: dict[str, Any] = (
        case_of(interface_text("joint", "iwan"), interface_text("rough", "coulomb")).to_dict() | load
    )
    for key in ("normal_load", "normal_stiffness", "tangential_stiffness"):
        del pressed["interfaces"]["rough"][key]
    pressed["roughness"] = {}
    with rejects(ss.StudyFileError, "preload.method"):
        Case.from_mapping(pressed)


def test_the_message_names_the_line_of_a_constant() -> None:
    text = HEADER + interface_text("joint", "iwan").replace("-0.5", "0.5") + REST
    with rejects(ss.StudyFileError, "interfaces.joint.constants.exponent"):
        Case.from_text(text)


def test_a_sweep_varies_the_constants_of_a_law() -> None:
    key = "interfaces.joint.constants.slip_force"
    (swept,) = swept_keys({key: "2 N:8 N:3"}, IWAN)
    assert (swept.values, swept.unit) == ((2.0, 5.0, 8.0), "N")
    planned = plan_cases(IWAN, (swept,))
    forces = [each.case.interfaces["joint"].constants.values["slip_force"] for each in planned]  # type: ignore[attr-defined]
    assert forces == [2.0, 5.0, 8.0]
    assert len({each.structure for each in planned}) == 1
    with rejects(ss.StudyFileError):
        plan_cases(IWAN, swept_keys({"interfaces.joint.constants.exponent": "-0.5,0.5"}, IWAN))


@pytest.mark.parametrize(
    "key",
    [
        "interfaces.joint.constants.beta",
        "interfaces.other.constants.ratio",
        "interfaces.joint.stiffness_constants.ratio",
        "friction.constants.ratio",
    ],
)
def test_a_sweep_of_what_is_no_constant_is_rejected(key: str) -> None:
    with rejects(ss.InputError):
        swept_keys({key: "1,2"}, IWAN)


def test_files_of_tables_are_relative_to_the_study_and_part_of_its_hash(tmp_path: Path) -> None:
    (tmp_path / "k.csv").write_text("pressure [MPa], normal_stiffness [N/mm^3], tangential_stiffness [N/mm^3]\n")
    (tmp_path / "masses.npz").write_bytes(b"")
    (tmp_path / "study.toml").write_text(changed(_by_file("k.csv")).to_text())
    case = ss.load_case(tmp_path / "study.toml")
    assert case.input_files["interfaces.joint.stiffness"] == str(tmp_path / "k.csv")
    key = "interfaces.joint.normal_load"
    before = plan_cases(case, swept_keys({key: [1.0]}, case))[0]
    (tmp_path / "k.csv").write_text("another table")
    after = plan_cases(case, swept_keys({key: [1.0]}, case))[0]
    assert before.key != after.key


def _by_file(name: str) -> dict[str, Any]:
    return MEASURED | {"interfaces.joint.stiffness_constants": {"file": name}}


def test_stiffness_law_of_all_faces() -> None:
    section = {"stiffness_law": "measured", "stiffness_constants": TABLE, "allocation": "pressure"}
    case = Case.from_mapping({"contact_stiffness": section})  # also for two blades
    assert case.roughness is None
    assert Case.from_text(case.to_text()).to_dict() == case.to_dict()
    with rejects(ss.StudyFileError, "contact_stiffness.normal_stiffness"):
        Case.from_mapping({"contact_stiffness": section | {"normal_stiffness": 1.0}})
    with rejects(ss.StudyFileError, "contact_stiffness.allocation"):
        Case.from_mapping(
            {"contact_stiffness": {"normal_stiffness": 1.0, "tangential_stiffness": 1, "allocation": "area"}}
        )


def test_a_law_that_does_not_declare_its_constants_is_for_python_only() -> None:
    @dataclass(frozen=True)
    class Undeclared:
        name: ClassVar[str] = "undeclared"
        normal_stiffness: np.ndarray  # the joint knows it
        limit: float

    with rejects(ss.InputError):
        declaration_of(Undeclared)
    with rejects(ss.InputError):
        declaration_of(lambda: None)


def test_a_declared_unit_must_be_one_of_si() -> None:
    @dataclass(frozen=True)
    class Damper:
        damping: float = field(metadata=constant("N s/m"))
        wrong: float = field(default=1.0, metadata=constant("N/mm"))

    assert Quantity.of_unit("N s/m").parse("2 N s/mm") == pytest.approx(2000.0)
    with rejects(ss.InputError):
        declaration_of(Damper)
