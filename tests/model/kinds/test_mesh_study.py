"""A study of a mesh that another program made: from its file to the report, and what is refused on the way."""

from __future__ import annotations

import html
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from typer.testing import CliRunner

from own_cases import BELOW_THE_PEAK, EXAMPLE, QUICK, mesh_case, parts_deck
from sentences import printed_sentence, rejects
from stickslip.case.case import Case
from stickslip.case.load import load_case
from stickslip.cli.main import app
from stickslip.core.errors import ImportFileError, InputError, StudyFileError
from stickslip.core.shown_numbers import typeset
from stickslip.formats.meshes.read import read_model
from stickslip.model.model import build_model, kind_of, load_joint, set_up
from stickslip.results.measures import energy_imbalance
from stickslip.results.storage import load_results
from stickslip.study.check import check

CUBES = Path(__file__).parents[2] / "data" / "models" / "cubes.bdf"
DENSITY = "8200 kg/m^3"
HEAVY = "body 'damper' has the density 3.1e+04 kg/m3; machine parts have 100 to 30000 kg/m3"


@pytest.fixture(scope="module")
def solved(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, str]:
    """The example as ``stickslip run`` solves it, from files in another folder, with a damper too heavy to be true."""
    folder = tmp_path_factory.mktemp("mesh")
    (folder / "beam_and_block.inp").write_text((EXAMPLE / "beam_and_block.inp").read_text("utf-8"), "utf-8")
    text = (EXAMPLE / "study.toml").read_text(encoding="utf-8")
    assert DENSITY in text
    text = text.replace(DENSITY, "31000 kg/m^3").replace('"2040 Hz"', '"1000 Hz"')
    assert 'accuracy = "2 %"' in text
    text = text.replace('accuracy = "2 %"', "harmonics = 1\nsamples = 64") + "\n[analysis]\nstiffness_band = false\n"
    (folder / "study.toml").write_text(text, encoding="utf-8")
    result = CliRunner().invoke(app, ["run", str(folder / "study.toml"), "--out", str(folder / "out")])
    assert result.exit_code == 0, result.output
    return folder / "out", result.output


@pytest.mark.long
def test_run_writes_report_results_and_shapes(solved: tuple[Path, str]) -> None:
    folder, output = solved
    for name in ("results.nc", "report.html", "contact_pairs.vtu", "mode_shapes.vtu", "deflected_shape.pvd"):
        assert (folder / name).stat().st_size > 0
        assert name in output
    saved = load_results(folder / "results.nc")
    assert saved.study is not None
    assert saved.study.face_names == ("sole", "lid")
    assert list(saved.study.outputs) == ["tip", "block"]
    # Pairs that keep their traction creep by 1e-6 of their mean a cycle, which dissipates only in those that slip.
    assert np.abs(energy_imbalance(saved.response)).max() < 1e-5
    assert (saved.response.contact_state > 0).any(), "nothing moves: raise the force of this test"
    page = (folder / "report.html").read_text(encoding="utf-8")
    for words in ("Contact states, lid", "contact stuck", "Area without a partner, sole", "Beam with a friction block"):
        assert words in page
    assert "paper" not in saved.study.description


@pytest.mark.slow
def test_wrong_units_are_warned_of_wherever_one_looks(solved: tuple[Path, str]) -> None:
    folder, output = solved
    assert HEAVY in " ".join(output.split())
    page = html.unescape((folder / "report.html").read_text(encoding="utf-8"))
    assert typeset(HEAVY) in page.replace("\xa0", " ")  # a page keeps a number and its unit in one line
    result = CliRunner().invoke(app, ["check", str(folder.parent / "study.toml")])
    assert result.exit_code == 0, result.output
    assert HEAVY in " ".join(result.output.split())


@pytest.mark.slow
def test_mode_table_compares_full_and_reduced(solved: tuple[Path, str]) -> None:
    record = load_results(solved[0] / "results.nc").study
    assert record is not None
    assert record.mode_contact == "stuck"
    assert len(record.mode_table) == 10
    assert all(0.0 <= float(row["difference_percent"]) < 1.0 for row in record.mode_table[:4])
    assert all(float(row["mac"]) > 0.99 for row in record.mode_table[:4])


@pytest.mark.slow
def test_check_shows_bodies_sets_pairs_and_frequencies() -> None:
    sections = dict(check(mesh_case()))
    sizes = dict(sections["Sizes"])
    assert sizes["body beam"].startswith("48 elements, 0.03768 kg")  # 60 x 10 x 8 mm of 7850 kg/m^3
    assert "8200 kg/m^3" in sizes["body damper"]
    assert sizes["contact pairs"] == "48 on 2 faces"
    assert "beam_top" in sizes["face sets"]
    assert dict(sections["Derived quantities"])["Area of the pairs, sole"] == "160 mm²"


@pytest.mark.slow
def test_forces_loads_and_outputs_of_sets() -> None:
    """Resultants: a force on a set sums up to its amplitude, rotation to mass times distance of the centre."""
    data = mesh_case().to_dict()
    data["forces"]["second"] = {"node": 39, "direction": [0, 2, 0], "amplitude": "3 N", "phase": "90 deg"}
    data["static_loads"] = {"weight": {"set": "damper_top", "direction": [0, 0, -1], "force": "80 N"}}
    data["rotation"] = {"speed": "200 rpm", "axis": [0, 0, 1], "point": ["-1 m", "5 mm", "0 mm"]}
    data["preload"] = {"method": "solved", "residual_traction": "kept"}
    for interface in data["interfaces"].values():
        del interface["normal_load"]
    case = Case.from_mapping(data)
    setup = set_up(case)
    (words,) = kind_of(case).warnings(case)  # the load is solved at the speed
    printed_sentence(words)
    model = build_model(case, setup.assemble(), load_joint(case, setup.layout))
    # a rigid motion of the beam is not free (it is clamped), so the shift is that of the loose block alone
    block = np.isin(model.superelement.boundary_nodes, setup.mesh.nodes_of_body(1))  # type: ignore[attr-defined]
    shift = np.zeros((3, model.superelement.size))
    for axis in range(3):
        shift[axis, 3 * np.flatnonzero(block) + axis] = 1.0
    mass = 8200.0 * 0.02 * 0.008 * 0.006
    turning = (200.0 / 60.0 * 2.0 * np.pi) ** 2 * mass * 1.05
    assert shift @ model.static_load == pytest.approx([turning, 0.0, -80.0], rel=1e-9, abs=1e-9)
    cosine = model.excitation.on(model.superelement, 1).coefficients(0.0)[1]
    assert np.linalg.norm(cosine) == pytest.approx(3.0)
    assert cosine[model.superelement.unknowns_of(int(setup.layout.node_groups["forces.second"].nodes[0]))][1] == 3.0
    assert model.outputs["block"] @ shift[0] == pytest.approx(1.0)
    assert np.allclose(setup.layout.node_groups["forces.push"].weights.sum(), 1.0)
    assert model.preload is not None
    assert np.isfinite(model.joint.preload).all()
    assert set(model.joint.friction_coefficient) == {0.2, 0.3}


@pytest.mark.slow
def test_a_pair_across_a_gap_is_open_by_its_gap() -> None:
    case = mesh_case(interfaces__lid__gap="0.01 mm")
    with rejects(InputError, "interfaces.lid.normal_load"):
        load_joint(case, set_up(case).layout)
    count = set_up(case).layout.face_pairs.n_pairs
    values = case.to_dict() | {"preload": {"values": [2.0] * (count // 2) + [0.0] * (count // 2)}}
    for interface in values["interfaces"].values():
        del interface["normal_load"]
    opened = Case.from_mapping(values)
    joint = load_joint(opened, set_up(opened).layout)
    lid = joint.face_pairs.face == 1
    assert joint.preload[lid] == pytest.approx(-1e-5 * joint.normal_stiffness[lid])
    assert joint.preload[~lid] == pytest.approx(np.full(count // 2, 2.0))


@pytest.mark.slow
def test_two_materials_meet_in_the_reduced_modulus() -> None:
    layout = set_up(mesh_case(bodies__damper__young_modulus="70 GPa")).layout
    first, second = layout.face_materials[0]
    assert (first.young_modulus, second.young_modulus) == (70e9, 210e9)
    assert layout.face_materials[1] == (first, first)


WRONG = {
    "set that is not there": ({"interfaces.sole.second": "beam_tip"}, (InputError, "interfaces.sole.second")),
    "faces that do not meet": (
        {"interfaces.sole.second": "tip"},
        (InputError, "interfaces.sole.first", "interfaces.sole.second"),
    ),
    "fixed set that is not there": ({"structure.fixed": ["foot"]}, (InputError, "structure.fixed")),
    "unknown body": ({"bodies.lamper.density": 1}, (StudyFileError, "bodies.lamper.density")),
    "force on a clamped set": ({"forces.push.set": "root", "forces.push.spread": "equal"}, (InputError, "forces.push")),
    "contact on a clamped face": ({"structure.fixed": ["beam_top"]}, (InputError, "interfaces.sole")),
    "point far away": ({"responses.block.point": [50, 5, 14]}, (InputError, "responses.block.point")),
    "unit of length": ({"structure.length_unit": "furlong"}, (InputError, "structure.length_unit")),
    "ground with search": ({"interfaces.lid.search_distance": "1 mm"}, (InputError, "interfaces.lid.search_distance")),
    "ground with adjust": ({"interfaces.lid.adjust": "closed"}, (InputError, "interfaces.lid.adjust")),
    "units that explain it": (
        {"structure.length_unit": "m"},
        (InputError, "responses.block"),
    ),
    "file that is not there": ({"structure.file": "nowhere.inp"}, (ImportFileError, "structure.file")),
}


@pytest.mark.slow
@pytest.mark.parametrize(("changes", "expected"), WRONG.values(), ids=WRONG.keys())
def test_what_does_not_fit_is_named(changes: dict[str, object], expected: tuple[Any, ...]) -> None:
    with rejects(*expected):
        set_up(mesh_case().replace(changes))


@pytest.mark.slow
@pytest.mark.parametrize("entry", ["forces.push.set", "responses.top.set", "structure.fixed", "interfaces.joint.first"])
def test_the_name_of_a_body_is_rejected_as_such(entry: str) -> None:
    """Bodies of a Nastran deck are properties, whose names ``stickslip import`` shows, but they are no sets."""
    case = Case.from_mapping(
        {
            "structure": {"kind": "mesh", "file": str(CUBES), "length_unit": "mm"},
            "interfaces": {
                "joint": {
                    "first": "opposite",
                    "second": "contact",
                    "normal_load": "10 N",
                    "normal_stiffness": "1e7 N/m",
                    "tangential_stiffness": "1e7 N/m",
                }
            },
            "forces": {"push": {"set": "set 3", "direction": [0, 0, 1], "amplitude": "1 N"}},
            "responses": {"top": {"node": 16, "direction": [0, 0, 1]}},
            "solver": {"frequency_start": 100.0, "frequency_stop": 200.0},
        }
    )
    assert set_up(case).layout.face_names == ("joint",)
    changes: dict[str, object] = {entry: ["upper"] if entry == "structure.fixed" else "upper"}
    changes |= {"responses.top.node": None} if entry.startswith("responses") else {}
    with rejects(InputError, entry):
        set_up(case.replace(changes))


def test_missing_material_is_named(tmp_path: Path) -> None:
    deck = (EXAMPLE / "beam_and_block.inp").read_text(encoding="utf-8")
    (tmp_path / "bare.inp").write_text(deck.replace("*DENSITY\n7.85e-09\n", ""), encoding="utf-8")
    case = mesh_case().replace({"structure.file": str(tmp_path / "bare.inp")})
    with rejects(InputError, "structure.file"):
        set_up(case)


@pytest.mark.slow
@pytest.mark.parametrize("sides", [("damper_bottom", "beam_top"), ("beam_top", "damper_bottom")])
def test_a_joint_that_appears_twice_is_rejected(sides: tuple[str, str]) -> None:
    data = mesh_case().to_dict()
    data["interfaces"]["again"] = {**data["interfaces"]["sole"], "first": sides[0], "second": sides[1]}
    with rejects(InputError, "interfaces.sole", "interfaces.again"):
        set_up(Case.from_mapping(data))


def test_a_sector_alone_is_rejected(tmp_path: Path) -> None:
    """A deck with cyclic symmetry is one sector; kind = "mesh" would solve it without its neighbours."""
    deck = tmp_path / "sector.inp"
    text = (EXAMPLE / "beam_and_block.inp").read_text(encoding="utf-8")
    deck.write_text(f"{text}\n*CYCLIC SYMMETRY MODEL, N=12, TIE=t\n0., 0., 0., 0., 0., 1.\n", encoding="utf-8")
    with rejects(InputError, "structure.kind"):
        set_up(mesh_case(structure__file=str(deck)))


def test_a_body_without_support_is_rejected() -> None:
    data = mesh_case().to_dict()
    sole = data["interfaces"].pop("sole")
    data["interfaces"] = {"other": {**sole, "first": "tip", "second": "ground"}}
    with rejects(InputError, "structure.fixed"):
        set_up(Case.from_mapping(data))


@pytest.mark.slow
def test_wrong_units_are_a_warning() -> None:
    layout = set_up(mesh_case(bodies__damper__density="8.2 kg/m^3", structure__length_unit="mm")).layout
    sentences = [odd.sentence for odd in layout.odd_values]
    printed_sentence("\n".join(sentences), "damper", "8.2 kg/m3")


@pytest.mark.slow
def test_a_sweep_varies_the_entry_of_one_interface(tmp_path: Path) -> None:
    """A sweep over an entry with a name of its own: two cases, one reduction, results that differ."""
    from stickslip.sweeps.run import sweep

    case = mesh_case().replace(BELOW_THE_PEAK)
    result = sweep(case, {"interfaces.sole.normal_load": [20, 40]}, out=tmp_path, workers=1)
    assert result.table.failed == ()
    peaks = result.table.column("peak_amplitude_m")
    assert peaks[0] != peaks[1]
    assert {row.name.rsplit("_", 1)[0] for row in result.table.rows} == {"sole.normal_load-20N", "sole.normal_load-40N"}


DOTTED = {
    '"damper_bottom"': '"Block.1.damper_bottom"',
    '"damper_top"': '"Block.1.damper_top"',
    '"beam_top"': '"Beam-1.beam_top"',
    'set = "tip"': 'set = "Beam-1.tip"',
    "[bodies.damper]": '[bodies."Block.1"]',
    "beam_and_block.inp": "parts.inp",
    "[interfaces.sole]": '[interfaces."Beam-1.sole"]',
}


def dotted_study(folder: Path, *changes: tuple[str, str]) -> Path:
    """The example with a deck of parts, whose names have dots."""
    parts_deck(folder)
    text = (EXAMPLE / "study.toml").read_text(encoding="utf-8")
    for old, new in (*DOTTED.items(), *changes):
        assert old in text
        text = text.replace(old, new)
    (folder / "study.toml").write_text(text, encoding="utf-8")
    return folder / "study.toml"


@pytest.mark.slow
def test_the_layout_has_the_numbers_of_the_mesh_file(tmp_path: Path) -> None:
    case = load_case(dotted_study(tmp_path))
    numbers, source = set_up(case).layout.file_numbers, read_model(tmp_path / "parts.inp", "mm")
    assert numbers is not None
    np.testing.assert_array_equal(numbers[0], source.node_labels)
    np.testing.assert_array_equal(numbers[1], source.element_labels)
    assert (np.diff(np.sort(numbers[0])) > 1).any()  # numbers of instances have offsets
    assert set_up(Case()).layout.file_numbers is None


@pytest.mark.slow
def test_a_deck_with_parts_gives_the_same_study(tmp_path: Path) -> None:
    flat = mesh_case()
    case = load_case(dotted_study(tmp_path)).replace(QUICK)
    assert Case.from_text(case.to_text()) == case
    models = []
    for each in (case, flat):
        setup = set_up(each)
        models.append(build_model(each, setup.assemble(), load_joint(each, setup.layout)))
    for name in ("stiffness", "mass"):
        actual, wanted = (getattr(model.superelement, name) for model in models)
        np.testing.assert_allclose(actual, wanted, rtol=1e-9, atol=1e-9 * np.abs(wanted).max())
    drives = [model.excitation.on(model.superelement, 1).coefficients(0.0) for model in models]
    np.testing.assert_array_equal(drives[0], drives[1])
    np.testing.assert_allclose(models[0].joint.preload, models[1].joint.preload, rtol=1e-12)
    assert set_up(case).mesh.body_names == ("Beam-1", "Block.1")  # type: ignore[attr-defined]


@pytest.mark.slow
def test_a_sweep_varies_a_body_whose_name_has_a_dot(tmp_path: Path) -> None:
    from stickslip.sweeps.run import sweep

    case = load_case(dotted_study(tmp_path)).replace(QUICK | BELOW_THE_PEAK)
    varied = {"bodies.Block.1.density": [8000, 9000], "interfaces.Beam-1.sole.normal_load": [30]}
    result = sweep(case, varied, out=tmp_path / "out", workers=1)
    assert result.table.failed == ()
    peaks = result.table.column("peak_amplitude_m")
    assert peaks[0] != peaks[1]
    assert result.table.rows[0].name.startswith("Block.1.density-8000kgm3_Beam-1.sole.normal_load-30N_")


@pytest.mark.slow
@pytest.mark.parametrize(
    ("old", "new", "expected"),
    [
        ('[bodies."Block.1"]', "[bodies.Block.1]", (StudyFileError, "bodies.Block.1")),
        ('[bodies."Block.1"]', '[bodies."Block.2"]', (InputError, "bodies.Block.2")),
        ('"Beam-1.beam_top"', '"Beam-1.top"', (InputError, "interfaces.Beam-1.sole.second")),
        ('"Block.1.damper_top"', '"Beam-1.root"', (InputError, "interfaces.lid")),
    ],
)
def test_names_with_dots_in_messages(tmp_path: Path, old: str, new: str, expected: tuple[Any, ...]) -> None:
    with rejects(*expected):
        set_up(load_case(dotted_study(tmp_path, (old, new))))


@pytest.mark.slow
def test_a_material_that_is_missing_requests_a_name_in_quotes(tmp_path: Path) -> None:
    study_file = dotted_study(tmp_path)
    deck = (tmp_path / "parts.inp").read_text(encoding="utf-8")
    assert "*DENSITY\n7.85e-09\n" in deck
    (tmp_path / "parts.inp").write_text(deck.replace("*DENSITY\n7.85e-09\n", ""), encoding="utf-8")
    case = load_case(study_file).replace({"bodies.Block.1.density": "8200 kg/m^3"})
    with rejects(InputError, "structure.file"):
        set_up(case)
    complete = {"young_modulus": "210 GPa", "poisson_ratio": 0.3, "density": "7850 kg/m^3"}
    only_beam = case.to_dict() | {"bodies": {"Beam-1": complete}}
    with rejects(InputError, "structure.file"):
        set_up(Case.from_mapping(only_beam))
