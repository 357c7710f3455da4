"""Studies with [mistuning]: factors, result files and page, words of check, and bad input."""

from __future__ import annotations

import copy
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from sentences import rejects
from stickslip.case.case import Case
from stickslip.case.examples import EXAMPLES
from stickslip.case.load import load_case
from stickslip.core.errors import ImportFileError, InputError, StudyFileError
from stickslip.model.model import set_up
from stickslip.reporting.page import page
from stickslip.results.measures import SUMMARY_COLUMNS, summary
from stickslip.results.mistuning import Mistuning
from stickslip.results.storage import load_results, save_results
from stickslip.solve.cyclic.amplification import amplification_factors
from stickslip.study.check import check
from stickslip.study.mistuning import is_highest_at_end
from stickslip.study.solution import Solution, solve_case
from stickslip.sweeps.plan import case_hashes
from stickslip.sweeps.run import sweep

SECTORS = 20
RANDOM = {"standard_deviation": "1 %", "patterns": 120, "seed": 3}


def data(**mistuning: Any) -> dict[str, Any]:
    """A small disk with few pairs, whose range contains both linear resonances."""
    content = copy.deepcopy(EXAMPLES["bladed-disk"])
    content["structure"] = {"kind": "cyclic", "sectors": SECTORS, "contact_columns": 2, "contact_rows": 1}
    content["travelling_wave"]["engine_order"] = 4
    content["analysis"] = {"stiffness_band": False}
    content["reduction"] = {"modes": 6}
    content["output"] = {"figure_formats": [], "stress": False, "mode_shapes": 0, "deflected_shape_frames": 0}
    content["solver"] = {"frequency_start": "470 Hz", "frequency_stop": "620 Hz", "harmonics": 1, "samples": 64}
    content["mistuning"] = mistuning
    return content


def case(**mistuning: Any) -> Case:
    return Case.from_mapping(data(**mistuning))


@pytest.fixture(scope="module")
def random_patterns() -> Solution:
    return solve_case(case(**RANDOM))


def result_of(solution: Solution) -> Mistuning:
    assert solution.response.mistuning is not None
    return solution.response.mistuning


@pytest.mark.long
def test_the_factors_are_those_of_the_function(random_patterns: Solution) -> None:
    result, model = result_of(random_patterns), random_patterns.model
    blade = model.reduced.blade
    assert blade is not None
    for pairs, factors in ((model.pairs, result.stuck_factor), (None, result.free_factor)):
        expected = amplification_factors(
            model.substructure.require_sector(), blade, result.deviation, model.excitation,
            next(iter(model.outputs.values())), frequency_hz=(470.0, 620.0), modal_damping_ratio=0.001, pairs=pairs,
        )  # fmt: skip
        assert factors is not None
        np.testing.assert_allclose(factors, expected.blade_factor, rtol=1e-6)  # the tolerance of its search for peaks
    assert result.stuck_factor is not None
    assert result.factor is not None
    assert result.stuck_factor.max() == result.factor == result.stuck_factor[result.shown].max()
    assert 1.05 < result.factor < result.whitehead_limit
    np.testing.assert_allclose(result.deviation.std(), 0.01, rtol=0.05)


@pytest.mark.long
def test_results_page_and_tables(random_patterns: Solution, tmp_path: Path) -> None:
    result, record = result_of(random_patterns), random_patterns.record
    save_results(tmp_path / "results.nc", random_patterns.response, record)
    assert load_results(tmp_path / "results.nc").response.mistuning == result
    text = page(random_patterns.response, record)
    for words in ("Amplification factor", "Whitehead's limit", *result.words()):
        assert words.replace("'", "&#39;") in text or words in text
    tables = {each.name: each for each in result.tables("mistuning", {})}
    assert len(tables["mistuning"].columns[0].values) == 120
    assert tables["mistuned_blades"].columns[2].values == tuple(result.limits["contacts stuck"][result.shown])
    measures = summary(random_patterns.response, record.outputs[record.response_output])
    assert SUMMARY_COLUMNS["amplification_factor"][2](measures) == result.factor
    assert len(result.plot().axes) == 2
    assert next(result.closing_words("mistuning")).startswith("Mistuning: 120 random patterns")


@pytest.mark.slow
def test_a_given_pattern_of_equal_blades_is_the_tuned_disk(tmp_path: Path) -> None:
    (tmp_path / "blades.csv").write_text("deviation [%]\n" + SECTORS * "0\n")
    study = tmp_path / "study.toml"
    study.write_text(case(file="blades.csv").to_text())
    result = result_of(solve_case(load_case(study)))
    for factors in result.limits.values():
        np.testing.assert_allclose(factors, np.ones((1, SECTORS)), rtol=1e-9)
    assert len(result.limits) == 2
    assert "1 % of them" not in " ".join(result.words())


@pytest.mark.slow
def test_a_limit_without_resonance_in_the_range_is_left_out() -> None:
    content = data(pattern=SECTORS * ["0.5 %"])
    content["solver"] |= {"frequency_start": "560 Hz", "frequency_stop": "620 Hz"}
    result = result_of(solve_case(Case.from_mapping(content)))
    assert list(result.limits) == ["contacts stuck"]
    assert result.message.endswith(" No factors, no contact: no mode there is in the range.")
    assert not result.warnings


@pytest.mark.long
def test_the_disk_with_friction_and_its_column_in_a_sweep(tmp_path: Path) -> None:
    content = data(standard_deviation="1 %", patterns=1, friction_curve=True)
    content["solver"] |= {"frequency_start": "585 Hz", "frequency_stop": "603 Hz"}
    swept = sweep(Case.from_mapping(content), {"mistuning.seed": [3, 4]}, out=tmp_path, workers=1)
    factors = swept.table.column("amplification_factor")
    assert not swept.table.failed
    assert len(set(factors)) == 2
    for factor, file in zip(factors, swept.case_files, strict=True):
        assert file is not None
        saved = load_results(file)
        result = saved.response.mistuning
        assert result is not None
        assert result.friction_factor is not None
        assert result.ring_amplitude is not None
        assert factor == result.friction_factor.max() == result.factor
        assert 1.0 < factor < result.whitehead_limit
        assert saved.study is not None
        text = page(saved.response, saved.study)
        assert "blade that moves most" in text
        assert "without an estimate of the error" in text.split("<section")[0]  # among the warnings on top
        assert [each.name for each in result.tables("mistuning", {})][-1] == "mistuned_curve"
    again = sweep(Case.from_mapping(content), {"mistuning.seed": [3, 4]}, out=tmp_path, workers=1)
    assert again.reused == 2


@pytest.mark.long
def test_unequal_dampers_change_the_curve_with_friction_alone() -> None:
    """All loads doubled are those of a study with twice the load; one damper with less moves the whole disk."""
    sectors = 6
    content = data(pattern=sectors * ["0.1 %"], friction_curve=True)
    content["structure"]["sectors"], content["travelling_wave"]["engine_order"] = sectors, 2
    content["solver"] |= {"frequency_start": "540 Hz", "frequency_stop": "603 Hz"}
    del content["roughness"]

    def solved(*loads: str, normal_load: str = "40 N") -> Mistuning:
        content["mistuning"]["damper_loads"] = list(loads) or None
        for interface in content["interfaces"].values():
            interface |= {
                "normal_load": normal_load, "normal_stiffness": "5e7 N/m", "tangential_stiffness": "4e7 N/m"
            }  # fmt: skip
        return result_of(solve_case(Case.from_mapping(content)))

    doubled, twice = solved(*sectors * ["200 %"]), solved(normal_load="80 N")
    assert doubled.ring_amplitude is not None
    assert twice.ring_amplitude is not None
    np.testing.assert_allclose(doubled.ring_amplitude, twice.ring_amplitude, rtol=1e-12)
    unequal = solved("20 %", *(sectors - 1) * ["100 %"]).ring_amplitude
    assert unequal is not None
    highest = unequal.max(axis=0)
    assert highest.max() > 1.001 * highest.min()


def test_a_highest_amplitude_at_an_end_is_seen() -> None:
    inside = np.array([[1.0, 2.0], [1.0, 3.0], [2.0, 1.0]])
    assert not is_highest_at_end(inside)
    assert is_highest_at_end(inside[1:])
    assert is_highest_at_end(inside[:2])


@pytest.mark.slow
def test_check_says_what_a_run_does() -> None:
    rows = dict(row for _, section in check(case(**RANDOM)) for row in section)
    assert rows["mistuning"].startswith("120 random patterns with a standard deviation of 1 %, seed 3")
    assert float(rows["blade alone"].split(",")[0]) == pytest.approx(515.0, rel=0.05)
    assert rows["Whitehead's limit"].startswith("2.74 times")


def test_patterns_are_inputs_of_a_case_but_not_of_its_structure() -> None:
    one, other = (case_hashes(case(**RANDOM | {"seed": seed})) for seed in (1, 2))
    assert one[0] != other[0]
    assert one[1] == other[1]


@pytest.mark.slow
@pytest.mark.parametrize(
    ("mistuning", "key"),
    [
        ({"pattern": ["1 %"]}, "mistuning.pattern"),
        ({"standard_deviation": "1 %", "blade": "wing"}, "mistuning.blade"),
        ({"standard_deviation": "1 %", "friction_curve": True, "damper_loads": ["90 %"]}, "mistuning.damper_loads"),
    ],
)
def test_patterns_and_blades_that_do_not_fit(mistuning: dict[str, Any], key: str) -> None:
    with rejects(InputError, key):
        set_up(case(**mistuning))


@pytest.mark.slow
def test_a_file_with_another_number_of_blades(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    Path("blades.csv").write_text("deviation [%]\n1\n2\n")
    with rejects(InputError, "mistuning.file"):
        set_up(case(file="blades.csv"))
    Path("blades.csv").write_text("deviation [%]\n-120\n2\n")
    with rejects(ImportFileError, "mistuning.file"):
        set_up(case(file="blades.csv"))


@pytest.mark.slow
def test_a_blade_with_its_root() -> None:
    with rejects(InputError, "mistuning.blade"):
        check(case(standard_deviation="1 %", blade="left boundary"))


@pytest.mark.parametrize(
    ("mistuning", "key"),
    [
        ({}, "standard_deviation"),
        ({"pattern": SECTORS * ["1 %"], "standard_deviation": "1 %"}, "standard_deviation"),
        ({"pattern": SECTORS * ["1 %"], "file": "blades.csv"}, "file"),
        ({"pattern": ["-100 %", *(SECTORS - 1) * ["0 %"]]}, "pattern"),
        ({"standard_deviation": "20 %"}, "standard_deviation"),
        ({"standard_deviation": "1 %", "damper_loads": SECTORS * ["90 %"]}, "damper_loads"),
        ({"standard_deviation": "1 %", "friction_curve": True, "damper_loads": ["0 %"]}, "damper_loads"),
    ],
    ids=["nothing", "two sources", "two patterns", "no stiffness", "too large", "no curve", "no load"],
)
def test_sections_that_are_rejected(mistuning: dict[str, Any], key: str) -> None:
    with rejects(StudyFileError, f"mistuning.{key}"):
        case(**mistuning)


def test_a_disk_that_cannot_have_mistuning() -> None:
    content = data(**RANDOM)
    content["damping"] = {"rayleigh_beta": "1e-6 s"}
    with rejects(StudyFileError, "damping.modal_damping_ratio"):
        Case.from_mapping(content)
    content = data(**RANDOM)
    content["forces"]["gas"]["harmonic"] = 2
    content["solver"]["harmonics"] = 2
    with rejects(StudyFileError, "forces.gas.harmonic"):
        Case.from_mapping(content)


def test_dampers_of_another_law_beside_their_loads() -> None:
    content = data(**RANDOM, friction_curve=True, damper_loads=SECTORS * ["90 %"])
    name = next(iter(content["interfaces"]))
    content["interfaces"][name] = {
        **{key: content["interfaces"][name][key] for key in ("first", "second")},
        "law": "cubic", "constants": {"stiffness": "5e7 N/m", "cubic_stiffness": "1e14 N/m^3"},
    }  # fmt: skip
    with rejects(StudyFileError, f"interfaces.{name}.law"):
        Case.from_mapping(content)


def test_coriolis_forces_beside_mistuning() -> None:
    with rejects(StudyFileError, "rotation.coriolis"):
        Case.from_mapping({**data(**RANDOM), "rotation": {"speed": "3000 rpm", "coriolis": True}})


def test_mistuning_of_a_structure_without_sectors() -> None:
    with rejects(StudyFileError, "mistuning"):
        Case.from_mapping({"mistuning": RANDOM})
