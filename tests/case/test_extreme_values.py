"""Values at the ends of what a computer or a key can hold: a sentence or finite numbers, never a fault of Python.

Keys come from the models of the study file, so a key that is added later is tried too.
"""

from __future__ import annotations

import copy
from collections.abc import Iterator
from typing import Any, get_args

import numpy as np
import pytest
from pydantic.fields import FieldInfo

from castings import ROUGH_CASTING
from own_cases import EXAMPLE, mesh_case, write_matrices
from sentences import printed_sentence, rejects
from stickslip.case.case import Case
from stickslip.case.sections import SolverSection
from stickslip.contact.law.coulomb_harmonics import MIN_SAMPLES
from stickslip.core.errors import InputError, StudyFileError
from stickslip.core.units import Count, Quantity
from stickslip.model.model import load_joint, set_up
from stickslip.structure.elasticity import Structure
from stickslip.structure.superelement import Superelement
from stickslip.study.check import check
from stickslip.study.facts import derived_quantities

EXTREME = (5e-324, 1e-310, 1e-300, -5e-324, 1e300, 1e308, -1e308)
COARSE = {
    "shank_columns": 1, "shank_rows": 2, "platform_rows": 1, "airfoil_rows": 2, "inner_columns": 1,
    "contact_columns": 1, "chordwise": 1, "damper_columns": 1, "damper_flank_rows": 1,
}  # fmt: skip
BLADES: dict[str, Any] = {"mesh": COARSE, "reduction": {"modes": 3}}
KINDS = ("two-blade", "mesh", "matrices")
# (section, key, field) of all kinds of study; a key that several classes of a section have stands here once.
ALL_FIELDS = tuple(
    (name, key, Case.field_of(name, key)[1]) for name, keys in Case.allowed_keys().items() for key in keys
)


def limits_in(annotation: Any) -> Iterator[Quantity | Count]:
    """The quantities and counts of an annotation, also within options, tuples and lists."""
    for each in get_args(annotation):  # those of Annotated hold its metadata
        if isinstance(each, Quantity | Count):
            yield each
        else:
            yield from limits_in(each)


def limits_of(field: FieldInfo) -> tuple[Quantity | Count, ...]:
    """The quantities and counts of a key, one for each entry of a place or direction."""
    direct = tuple(each for each in field.metadata if isinstance(each, Quantity | Count))
    return direct or tuple(limits_in(field.annotation))


def numeric_keys() -> Iterator[tuple[str, str, tuple[Quantity | Count, ...]]]:
    """(section, key, limits) of every key that holds a number."""
    for name, key, inner in ALL_FIELDS:
        if actual := limits_of(inner):
            yield name, key, actual


NUMERIC = tuple(numeric_keys())
DIRECTIONS = tuple(
    (name, key)
    for name, key, inner in ALL_FIELDS
    if inner.annotation is not None and "PlainValidator" in repr((inner.metadata, inner.annotation))
)


@pytest.fixture(scope="module")
def bases(tmp_path_factory: pytest.TempPathFactory) -> dict[str, dict[str, Any]]:
    """A small study of each kind as nested dictionaries."""
    folder = tmp_path_factory.mktemp("matrices")
    write_matrices(folder, mesh_case())
    matrices = {
        "structure": {"kind": "matrices", "file": str(folder / "superelement.npz")},
        "material": {"young_modulus": "210 GPa", "poisson_ratio": 0.3, "density": "7850 kg/m^3"},
        "interfaces": {
            "lid": {"first": "lid", "second": "ground", "normal": [0, 0, 1], "area": "36 mm^2", "normal_load": "40 N"}
        },
        "roughness": {"sq": "1 um", "sample_length": "0.8 mm"},
        "forces": {"push": {"set": "lid", "direction": [0, 0, 1], "amplitude": "0.2 N"}},
        "responses": {"lid": {"set": "lid", "direction": [1, 0, 0]}},
        "solver": {"frequency_start": "400 Hz", "frequency_stop": "550 Hz"},
    }
    mesh = mesh_case().to_dict()
    mesh["structure"]["file"] = str(EXAMPLE / "beam_and_block.inp")
    return {"two-blade": BLADES, "mesh": mesh, "matrices": matrices}


def with_value(base: dict[str, Any], section: str, key: str, value: Any) -> dict[str, Any]:
    """A copy of a study with one other value; a section with named entries gets it in its first entry, or a new one."""
    data = copy.deepcopy(base)
    home = data.setdefault(section, {})
    if section in Case.named_sections():
        home = home.setdefault(next(iter(home), "one"), {})
    home[key] = value
    if section == "damper":
        home["kind"] = "flat" if key == "thickness" else "cylindrical"
    return data


def entry_key(data: dict[str, Any], section: str, key: str) -> str:
    """The key that :func:`with_value` changed."""
    return ".".join([section, *list(data[section])[:1], key] if section in Case.named_sections() else [section, key])


def as_typed(limits: tuple[Quantity | Count, ...], key: str, value: float | int) -> Any:
    """A value as a study file has it: a list of it for places and lists, a text where the unit is required."""
    first = limits[0]
    number: Any = value
    if isinstance(first, Quantity) and first.unit_required:
        number = f"{value!r} {first.si_unit}"
    if len(limits) > 1:
        return [number] * len(limits)
    return [number] if key in ("values", "mode_frequencies") else number


def require_finite(case: Case) -> None:
    """Build what ``check`` builds before the eigenvalues, and demand finite numbers."""
    setup = set_up(case)
    joint = load_joint(case, setup.layout)
    structure = setup.assemble()
    assert isinstance(structure, Structure | Superelement)
    for array in (joint.preload, joint.normal_stiffness, joint.tangential_stiffness):
        assert np.isfinite(array).all()
    for matrix in (structure.stiffness, structure.mass):
        assert np.isfinite(matrix.sum())
    for name, value, _, _ in derived_quantities(case, joint):
        assert not isinstance(value, float) or np.isfinite(value), name


@pytest.mark.long
@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize(("section", "key", "limits"), NUMERIC, ids=[f"{name}.{key}" for name, key, _ in NUMERIC])
def test_values_that_no_computer_can_use_are_rejected_by_their_key(
    section: str, key: str, limits: tuple[Quantity | Count, ...], kind: str, bases: dict[str, dict[str, Any]]
) -> None:
    for value in (*EXTREME, 10**400):
        data = with_value(bases[kind], section, key, as_typed(limits, key, value))
        with pytest.raises(StudyFileError) as caught:  # limits and sentences of each key are in tests of its kind
            Case.from_mapping(data)
        assert entry_key(data, section, key) in caught.value.keys


def test_every_quantity_has_two_limits() -> None:
    """So that no key, also none to come, takes a number that cannot be computed with."""
    for name, key, limits in NUMERIC:
        for each in limits:
            low = each.at_least if isinstance(each, Count) or each.at_least is not None else each.above
            high = each.at_most if isinstance(each, Count) or each.at_most is not None else each.below
            assert low is not None, f"{name}.{key}"
            assert high is not None, f"{name}.{key}"
    assert len(NUMERIC) > 60


def test_every_key_with_a_number_was_found() -> None:
    """A key whose type holds a float or an int has a Quantity, a Count or a direction."""
    actual = {(name, key) for name, key, _ in NUMERIC} | set(DIRECTIONS)
    for name, key, inner in ALL_FIELDS:
        words = repr(inner.annotation)
        if "float" in words or "int" in words:
            assert (name, key) in actual, f"{name}.{key}"


@pytest.mark.slow
@pytest.mark.parametrize("value", [[5e-324, 0, 0], [1e308, 1e308, 0], [1e-310, 1e-310, 0], [10**400, 0, 0]])
@pytest.mark.parametrize(("section", "key"), DIRECTIONS)
def test_directions(section: str, key: str, value: list[float], bases: dict[str, dict[str, Any]]) -> None:
    kind = "two-blade" if section == "excitation" else "mesh"
    data = with_value(bases[kind], section, key, value)
    with pytest.raises(StudyFileError) as caught:  # a new section lacks other keys as well
        Case.from_mapping(data)
    assert entry_key(data, section, key) in caught.value.keys
    printed_sentence(str(caught.value))


@pytest.mark.long
@pytest.mark.parametrize("kind", KINDS)
def test_the_limits_themselves_end_in_finite_numbers_or_a_sentence(kind: str, bases: dict[str, dict[str, Any]]) -> None:
    """What a key allows is computed with: warnings of Python are errors in the tests."""
    built = 0
    for section, key, limits in NUMERIC:
        if section in ("mesh", "output", "solver", "reduction"):
            continue  # counts and steps, which no number here follows from
        first = limits[0]
        ends = (first.at_least, first.at_most)
        for end in ends:
            if end is None:
                continue
            try:
                case = Case.from_mapping(with_value(bases[kind], section, key, as_typed(limits, key, end)))
                require_finite(case)
                built += 1
            except InputError:
                continue
    assert built > 10


@pytest.mark.long
def test_the_check_of_a_study_ends_at_its_limits() -> None:
    """The soft end of Young's modulus beside stiff contact: the eigenvalues end after a bounded number of restarts."""
    casting = {key.partition(".")[2]: value for key, value in ROUGH_CASTING.items() if key.startswith("roughness.")}
    coarse = {"mesh": {"chordwise": 2, "airfoil_rows": 4}, "roughness": casting}
    case = Case.from_mapping({**coarse, "material": {"young_modulus": "1 kPa"}})
    with rejects(InputError, "material.young_modulus"):
        check(case)


def test_check_and_run_agree_on_the_fewest_samples() -> None:
    (limit,) = limits_of(SolverSection.model_fields["samples"])
    assert limit.at_least == MIN_SAMPLES
    for samples in range(3, MIN_SAMPLES):
        with rejects(StudyFileError, "solver.samples"):
            Case.from_mapping({"solver": {"harmonics": 1, "samples": samples}})


WRONG_UNITS = {
    "Pa for GPa": (
        {"material": {"young_modulus": 197}},
        "material.young_modulus",
    ),
    "hardness in GPa": ({"roughness": {"hardness": 3}}, "roughness.hardness"),
    "t/mm^3": ({"material": {"density": 7.8e-9}}, "material.density"),
    "blade in mm": ({"geometry": {"blade_length": "145 m"}}, "geometry.blade_length"),
    "no wave so short": ({"roughness": {"shortest_length": 1e-12}}, "roughness.shortest_length"),
}


@pytest.mark.parametrize(("data", "key"), WRONG_UNITS.values(), ids=WRONG_UNITS)
def test_values_that_only_a_wrong_unit_explains_are_rejected(data: dict[str, Any], key: str) -> None:
    with rejects(StudyFileError, key):
        Case.from_mapping(data)


ODD = {
    "MPa for GPa": ({"material": {"young_modulus": "197 kPa"}}, "the material has Young's modulus 1.97e+05 Pa"),
    "soft hardness": (
        {"roughness": {"hardness": "3 MPa"}},
        "roughness.hardness is 3e+06 Pa; machine parts have 1e+07 to 2e+11",
    ),
    "thin air": ({"material": {"density": "7.8 kg/m^3"}}, "the material has the density 7.8 kg/m3"),
    "force": ({"excitation": {"amplitude": "3e9 N"}}, "excitation.amplitude is 3e+09 N"),
    "preload": ({"preload": {"centrifugal_force": "5e8 N"}}, "preload.centrifugal_force is 5e+08 N"),
    "G": ({"roughness": {"fractal_roughness": "0.1 mm"}}, "roughness.fractal_roughness is 0.0001 m"),
    "longest wave": (
        {"roughness": {"shortest_length": "20 mm", "sample_length": "28 mm"}},
        "roughness.shortest_length is 0.02 m",
    ),
    "stiffness": (
        {"contact_stiffness": {"normal_stiffness": "1e15 N/m", "tangential_stiffness": "1e8 N/m"}},
        "contact_stiffness.normal_stiffness is 1e+15 N/m",
    ),
}


@pytest.mark.slow
@pytest.mark.parametrize(("data", "words"), ODD.values(), ids=ODD)
def test_odd_values_of_the_two_blades_are_reported_first(data: dict[str, Any], words: str) -> None:
    """As a warning of ``check``, or before the sentence that follows from them."""
    case = Case.from_mapping(BLADES | data)
    try:
        printed = dict(check(case))["Warnings"][0][1]
    except InputError as error:
        printed = str(error)
        fitting = "This is the probable cause of the following error: " in printed
    else:
        fitting = True
    assert printed.startswith(words)
    assert fitting


def test_the_default_study_has_no_odd_value() -> None:
    assert set_up(Case.from_mapping(BLADES)).layout.odd_values == ()


def test_more_elements_than_memory_are_rejected_before_the_mesh_is_made() -> None:
    case = Case.from_mapping({"mesh": {"chordwise": 1000, "airfoil_rows": 1000}})
    with rejects(InputError, "mesh"):
        set_up(case)


@pytest.mark.parametrize(
    ("data", "keys"),
    [
        ({"study": {"title": "nul \0 title"}}, ("study.title",)),
        ({"study": {"title": "clear \x1b[2J"}}, ("study.title",)),
        (
            {"structure": {"kind": "mesh", "file": "a\0.inp", "length_unit": "mm"}},
            (
                "study.title",
                "structure.file",
            ),
        ),
        (
            {"structure": {"kind": "mesh", "file": "a.inp", "length_unit": "mm", "fixed": ["a\x9b"]}},
            ("structure.fixed",),
        ),
    ],
)
def test_control_characters_in_texts_are_rejected(data: dict[str, Any], keys: tuple[str, ...]) -> None:
    """NUL in a title lost a solved run: results files end a text there."""
    with rejects(StudyFileError, *keys):
        Case.from_mapping(data)


def test_control_characters_in_names_of_entries_are_rejected(bases: dict[str, dict[str, Any]]) -> None:
    data = copy.deepcopy(bases["mesh"])
    data["interfaces"]["so\0le"] = data["interfaces"].pop("sole")
    with rejects(StudyFileError, "interfaces.so\u0000le"):
        Case.from_mapping(data)
    Case.from_mapping({"study": {"title": "Dämpfer – 2 \N{GREEK SMALL LETTER MU}m"}})
