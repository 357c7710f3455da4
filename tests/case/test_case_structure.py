"""Study files about structures of the user's own: what belongs together, what is refused, and that they read back."""

from __future__ import annotations

import pickle
from pathlib import Path
from typing import Any

import pytest
from typer.testing import CliRunner

from own_cases import EXAMPLE, mesh_case
from sentences import printed_sentence, rejects
from stickslip.case.case import Case, MeshCase, TwoBladeCase
from stickslip.case.examples import EXAMPLES
from stickslip.case.load import load_case
from stickslip.cli.main import app
from stickslip.core.errors import InputError, StudyFileError
from stickslip.sweeps.axes import swept_keys
from stickslip.sweeps.plan import case_hashes

MESH = (EXAMPLE / "study.toml").read_text(encoding="utf-8")


@pytest.mark.slow
@pytest.mark.parametrize("kind", EXAMPLES)
def test_new_writes_a_file_of_each_kind_that_reads_back(kind: str, tmp_path: Path) -> None:
    path = tmp_path / "study.toml"
    result = CliRunner().invoke(app, ["new", str(path), "--kind", kind])
    assert result.exit_code == 0, result.output
    text = path.read_text(encoding="utf-8")
    assert max(map(len, text.splitlines())) <= 120
    case = Case.from_text(text)
    assert case == Case.from_mapping(EXAMPLES[kind])
    assert Case.from_mapping(case.to_dict()) == case
    assert ("\n[geometry]" in text) == (kind == "two-blade")
    assert ("length_unit" in text) == (kind != "two-blade")


def test_new_of_another_kind_is_rejected(tmp_path: Path) -> None:
    result = CliRunner().invoke(app, ["new", str(tmp_path / "study.toml"), "--kind", "shell"])
    assert result.exit_code == 2
    printed_sentence(result.stderr, "--kind")


def test_values_are_si_and_file_names_absolute() -> None:
    case = load_case(EXAMPLE / "study.toml")
    assert isinstance(case, MeshCase)
    assert Path(case.structure.file) == EXAMPLE.resolve() / "beam_and_block.inp"
    assert case.responses["block"].point == pytest.approx((0.048, 0.00367, 0.014))
    assert case.interfaces["lid"].normal_stiffness == 1e6
    assert case.forces["push"].phase == 0.0
    assert type(case) is MeshCase
    assert case.material is None
    assert {"geometry", "mesh", "excitation"}.isdisjoint(case.sections)


def test_equal_cases_have_one_hash() -> None:
    assert len({mesh_case(), mesh_case(), Case(), Case()}) == 2


def test_a_key_of_a_named_entry_is_replaced_and_swept() -> None:
    case = mesh_case(interfaces__sole__friction=0.6)
    unchanged = mesh_case()
    assert isinstance(case, MeshCase)
    assert isinstance(unchanged, MeshCase)
    assert case.interfaces["sole"].friction == 0.6
    assert case.interfaces["lid"] == unchanged.interfaces["lid"]
    (key,) = swept_keys({"interfaces.sole.normal_load": "10:40:3"})
    assert (key.values, key.unit) == ((10.0, 25.0, 40.0), "N")
    with rejects(StudyFileError, "interfaces.soul.friction"):
        case.replace({"interfaces.soul.friction": 0.5})
    with rejects(InputError, "interfaces.friction"):
        swept_keys({"interfaces.friction": "0.1,0.2"})


@pytest.mark.slow
def test_hashes_show_what_changes_the_structure(tmp_path: Path) -> None:
    base = case_hashes(mesh_case())
    for key, value, shared in (
        ("interfaces.sole.friction", 0.6, True),
        ("forces.push.amplitude", "1 N", True),
        ("interfaces.sole.points", "quadrature", False),
        ("bodies.damper.density", 8300, False),
    ):
        other = case_hashes(mesh_case().replace({key: value}))
        assert other[0] != base[0], key
        assert (other[1] == base[1]) == shared, key
    deck = tmp_path / "deck.inp"
    copy = mesh_case().replace({"structure.file": str(deck)})
    deck.write_text((EXAMPLE / "beam_and_block.inp").read_text(encoding="utf-8"), encoding="utf-8")
    before = case_hashes(copy)
    deck.write_text(deck.read_text(encoding="utf-8").replace("7.85e-09", "7.9e-09"), encoding="utf-8")
    assert all(one != other for one, other in zip(before, case_hashes(copy), strict=True))


WRONG = {
    "kind": (MESH.replace('kind = "mesh"', 'kind = "mash"'), ("structure.kind",)),
    "two-blade section": (MESH + '[geometry]\nwidth = "1 mm"\n', ("geometry",)),
    "own section of two blades": ('[interfaces.a]\nfirst = "x"\nsecond = "y"\n', ("interfaces",)),
    "file of two blades": ('[structure]\nfile = "x.inp"\n', ("structure.file",)),
    "no unit of length": (MESH.replace('length_unit = "mm"', ""), ("structure.length_unit",)),
    "no file": (MESH.replace('file = "beam_and_block.inp"', ""), ("structure.file",)),
    "near key": (MESH.replace("normal_load =", "normal_laod =", 1), ("interfaces.sole.normal_laod",)),
    "range": (MESH.replace("friction = 0.2", "friction = -1"), ("interfaces.sole.friction",)),
    "unit": (MESH.replace('"0.5 N"', '"0.5 mm"'), ("forces.push.amplitude",)),
    "no direction": (
        MESH.replace("direction = [0, 1, 0]", "", 1),
        ("forces.push.direction",),
    ),
    "two places": (MESH.replace('spread = "area"', "node = 3"), ("forces.push",)),
    "no interface": (
        MESH.replace("[interfaces.", "[static_loads."),
        (
            "static_loads.sole.direction",
            "static_loads.sole.force",
            "static_loads.sole.first",
            "static_loads.sole.second",
            "static_loads.sole.normal_load",
            "static_loads.sole.friction",
            "static_loads.lid.direction",
            "static_loads.lid.force",
            "static_loads.lid.first",
            "static_loads.lid.second",
            "static_loads.lid.normal_load",
            "static_loads.lid.normal_stiffness",
            "static_loads.lid.tangential_stiffness",
        ),
    ),
    "no side": (MESH.replace('second = "ground"', ""), ("interfaces.lid.second",)),
    "no load": (MESH.replace('normal_load = "40 N"', "", 1), ("interfaces.sole.normal_load",)),
    "one stiffness": (
        MESH.replace('tangential_stiffness = "8e5 N/m"', ""),
        ("interfaces.lid.tangential_stiffness",),
    ),
    "wedge": (MESH + "[preload]\ncentrifugal_force = 5\n", ("preload.centrifugal_force",)),
    "half a material": (MESH + "[material]\ndensity = 7800\n", ("material.young_modulus", "material.poisson_ratio")),
    "area of a mesh": (MESH.replace("friction = 0.2", 'area = "1 mm^2"'), ("interfaces.sole.area",)),
    "entry without name": (MESH + "[bodies]\ndensity = 3\n", ("bodies.density",)),
    "speed": (MESH + '[rotation]\nspeed = "50 Hz"\naxis = [0, 0, 1]\n', ("rotation.speed",)),
    "matrices without units": (
        '[structure]\nkind = "matrices"\nstiffness = "k.mtx"\nmass = "m.mtx"\n',
        ("structure.length_unit",),
    ),
    "matrices without normal": (
        '[structure]\nkind = "matrices"\nfile = "a.npz"\n[interfaces.a]\nfirst = "x"\nsecond = "ground"\n'
        "normal_load = 3\n",
        ("interfaces.a.normal", "interfaces.a.area"),
    ),
    "two sources of the load": (
        MESH + "\n[preload]\nvalues = [1.0, 2.0]\n",
        ("interfaces.sole.normal_load",),
    ),
    "friction of the wedge": (
        MESH + "\n[preload]\nfriction_coefficient_at_assembly = 0.2\n",
        ("preload.friction_coefficient_at_assembly",),
    ),
}


@pytest.mark.long
@pytest.mark.parametrize(("text", "keys"), WRONG.values(), ids=WRONG.keys())
def test_wrong_study_file(text: str, keys: tuple[str, ...], tmp_path: Path) -> None:
    path = tmp_path / "study.toml"
    path.write_text(text, encoding="utf-8")
    with rejects(StudyFileError, *keys) as caught:
        load_case(path)
    result = CliRunner().invoke(app, ["check", str(path)])
    assert (result.exit_code, result.stderr) == (2, f"Error: {caught.value}\n")


@pytest.mark.parametrize(
    "name", ["block/beam", "..", "/etc", "a=b", "a:b", " a", "a ", "a\\b", "a\tb", "", "n" * 65, 'a"b']
)
@pytest.mark.parametrize("section", ["interfaces", "forces", "responses", "static_loads"])
def test_names_that_files_and_keys_cannot_take_are_rejected(section: str, name: str) -> None:
    """A slash was met when the table of a solved sweep was written."""
    entries = {"interfaces": {"first": "a", "second": "b"}}.get(section, {"set": "a", "direction": [1.0, 0.0, 0.0]})
    structure = {"kind": "mesh", "file": "a.inp", "length_unit": "mm"}
    with pytest.raises(StudyFileError) as caught:
        Case.from_mapping({"structure": structure, section: {name: entries}})
    assert f"{section}.{name}" in caught.value.keys
    line = next(line for line in str(caught.value).splitlines() if f"[{section}." in line)
    printed_sentence(line)


@pytest.mark.slow
@pytest.mark.parametrize("name", ["block-beam", "Gelenk links", "face 1.2 (top)", "_a", "N1"])
def test_usual_names_pass(name: str) -> None:
    case = mesh_case().to_dict()
    case["responses"] = {name: next(iter(case["responses"].values()))}
    checked = Case.from_mapping(case)
    assert isinstance(checked, MeshCase)
    assert list(checked.responses) == [name]


def test_bodies_are_called_as_in_the_mesh_and_texts_can_be_shown() -> None:
    data: dict[str, Any] = {
        "structure": {"kind": "mesh", "file": "a.inp"},
        "bodies": {"Part/Body:1": {"density": 7800.0}},
    }
    with rejects(StudyFileError, "structure.length_unit") as error:  # it lacks interfaces and more
        Case.from_mapping(data)
    assert "Part/Body" not in str(error.value)
    data["bodies"] = {"a\x1b[2Jb": {"density": 7800.0}}
    data["structure"]["fixed"] = ["root\x07"]
    with rejects(StudyFileError, "structure.length_unit", "structure.fixed", "bodies.a\u001b[2Jb"):
        Case.from_mapping(data)


def test_each_kind_is_a_class_with_its_sections() -> None:
    two_blade, mesh = Case(), mesh_case()
    assert (type(two_blade), type(mesh)) == (TwoBladeCase, MeshCase)
    assert isinstance(mesh, Case)
    assert pickle.loads(pickle.dumps(mesh)) == mesh
    assert not hasattr(two_blade, "interfaces")
    assert not hasattr(mesh, "geometry")
    assert Case.model_validate(mesh.to_dict()) == mesh
    with rejects(
        StudyFileError,
        "structure.kind",
        "structure.file",
        "structure.length_unit",
        "bodies",
        "interfaces",
        "forces",
        "responses",
    ):
        TwoBladeCase.from_mapping(mesh.to_dict())


def test_what_belongs_to_another_kind_is_judged_by_its_value_first() -> None:
    data = mesh_case().to_dict()
    data["interfaces"]["sole"]["area"] = "3 mm"
    data["geometry"] = {"width": "4 kg"}
    with rejects(StudyFileError, "interfaces.sole.area", "geometry.width"):
        Case.from_mapping(data)


def test_foreign_keys_that_say_nothing_are_read() -> None:
    """Files of earlier versions have them."""
    data = mesh_case().to_dict()
    data["preload"]["friction_coefficient_at_assembly"] = 0.0
    assert Case.from_mapping(data) == mesh_case()


def test_the_kind_of_analysis_is_a_choice() -> None:
    assert Case.from_text('[analysis]\nkind = "forced"\n') == Case()
    with rejects(StudyFileError, "analysis.kind"):
        Case.from_text('[analysis]\nkind = "modes"\n')


def test_the_band_of_tractions_is_yes_or_no() -> None:
    assert Case.from_text("[analysis]\ntraction_band = true\n").analysis.traction_band
    with rejects(StudyFileError, "analysis.traction_band"):
        Case.from_text('[analysis]\ntraction_band = "tip"\n')
