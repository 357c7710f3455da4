"""The page as text: complete in itself, honest about failure, and with the right numbers packed inside."""

import base64
import dataclasses
import json
import re
from collections.abc import Callable
from pathlib import Path

import h5py
import numpy as np
import plotly.graph_objects
import pytest

from browser_pages import LARGEST_PAGE
from helpers import matched
from large_results import large_result
from sentences import rejects
from sketches import stacked_boxes
from stickslip.contact.law.contact_pairs import ContactPairs
from stickslip.contact.law.coulomb import CoulombLaw
from stickslip.contact.law.law import ContactState
from stickslip.contact.pairing.pairing_result import FROM_PAIRING
from stickslip.core.errors import InputError
from stickslip.reporting import page as page_module
from stickslip.reporting import page_data as page_data_module
from stickslip.reporting import plots
from stickslip.reporting.curve_plot import amplitude_frequency
from stickslip.reporting.page import page, write_page
from stickslip.reporting.page_data import page_data
from stickslip.reporting.section import Section
from stickslip.reporting.view import View
from stickslip.results.measures import summary, summary_table
from stickslip.results.record import StudyRecord
from stickslip.results.response import ForcedResponse
from stickslip.results.storage import load_results, save_results
from synthetic import synthetic_response, synthetic_study


@pytest.fixture(scope="module")
def case() -> tuple[ForcedResponse, StudyRecord]:
    return synthetic_response(), synthetic_study()


@pytest.fixture(scope="module")
def text(case: tuple[ForcedResponse, StudyRecord]) -> str:
    return page(*case)


def unpacked(text: str, kind: str) -> np.ndarray:
    return np.frombuffer(base64.b64decode(text), dtype=f"<{kind}")


def without_plotly(text: str) -> str:
    """The page without the plotly.js library, the longest of its scripts."""
    library = max(re.findall(r"<script>(.*?)</script>", text, flags=re.S), key=len)
    return text.replace(library, "")


@pytest.mark.slow
def test_page_is_one_file_without_outside_references(text: str) -> None:
    own = without_plotly(text)
    assert len(text.encode()) < 15e6
    assert not re.search(r'(?:src|href)\s*=\s*"(?!data:,")', own)
    assert not re.search(r"https?://(?!www\.w3\.org/2000/svg)", own)
    assert "{{" not in own


@pytest.mark.slow
def test_page_says_what_the_reader_must_know(text: str) -> None:
    reference = ("Reference: modal test of the two blades.", "Full model against reference, %")
    for words in (*reference, "0-to-peak", "Hz", "stick-slip", "separating", "Equivalent damping ratio"):
        assert words in text
    assert 'class="notice' not in text


@pytest.mark.slow
def test_an_accuracy_is_on_the_page_with_the_error_of_the_peak(
    case: tuple[ForcedResponse, StudyRecord], text: str
) -> None:
    response, study = case
    errors = np.full(response.n_points, 0.0012)
    errors[0] = 0.004
    accurate = dataclasses.replace(
        response,
        settings=response.settings | {"accuracy": 0.005},
        point_harmonics=np.full(response.n_points, response.harmonics),
        estimated_error=errors,
    )
    words = f"accuracy 0.5 % (up to {response.harmonics} harmonics, estimated error of the peak 0.12 %)"
    assert words in page(accurate, study)
    assert "estimated error" not in text
    parted = dataclasses.replace(response, point_harmonics=np.where(errors > 0.002, response.harmonics, 1))
    assert f"1 to {response.harmonics} harmonics" in page(parted, study)


@pytest.mark.slow
def test_failure_and_warnings_are_prominent(case: tuple[ForcedResponse, StudyRecord]) -> None:
    response, study = case
    failed = dataclasses.replace(response, converged=False, message="Stopped at 420 Hz <fold>.", warnings=("Too few.",))
    text = without_plotly(page(failed, dataclasses.replace(study, warnings=("Sdq is above 1.",))))
    notices = text[text.index('class="notice bad"') : text.index('class="tiles"')]
    for words in (
        "did not converge",
        "Stopped at 420 Hz &lt;fold&gt;.",
        "partial results",
        "Too few.",
        "Sdq is above 1.",
    ):
        assert words in notices
    assert "highest of the computed part of the curve at" in text
    (marked, _) = [name for name, _, _ in summary_table(summary(failed, study.outputs[study.response_output]))][:2]
    assert (
        marked
        == "Highest peak on the curve (highest of the computed part of the curve): amplitude, 0-to-peak, mean included"
    )


@pytest.mark.slow
def test_peak_at_the_end_of_the_range_is_a_warning(case: tuple[ForcedResponse, StudyRecord]) -> None:
    response, study = case
    half = 12
    parts: tuple[str, ...] = (
        "frequency_hz",
        "displacement",
        "contact_state",
        "dissipated_energy",
        "normal_work",
        "closure",
        "residual",
    )
    parts += ("iterations", "input_energy", "viscous_energy", "load_factor", "kinetic_energy", "part")
    cut = dataclasses.replace(response, **{name: getattr(response, name)[:half] for name in parts})
    text = without_plotly(page(cut, study))
    assert "widen the frequency range" in text
    assert "highest computed, at an end of the curve at" in text


@pytest.mark.slow
def test_text_of_the_user_cannot_break_the_page(case: tuple[ForcedResponse, StudyRecord]) -> None:
    response, study = case
    nasty = dataclasses.replace(
        study, title="<b>T</b> {{data}}", inputs="</script><script>alert(1)</script>", face_names=("</script>", "R&D")
    )
    text = without_plotly(page(response, nasty))
    assert "alert(1)</script>" not in text
    assert "&lt;b&gt;T&lt;/b&gt; {{data}}" in text
    assert json.loads(matched(r'id="page-data">(.*?)</script>', text, flags=re.S).group(1))["points"] == 40


@pytest.mark.slow
def test_figures_are_valid_plotly(case: tuple[ForcedResponse, StudyRecord]) -> None:
    view = View.of(*case)
    drawn = [
        amplitude_frequency(view),
        plots.hysteresis_loop(view),
        plots.pair_signals(),
        plots.energy_curve(view),
    ]
    drawn += [plots.face_map(view, face, quantity) for face in (0, 1) for quantity in ("state", "energy")]
    drawn += [plots.output_signals(("damper left x", "damper left y"))]
    for figure in drawn:
        plotly.graph_objects.Figure(figure)  # raises for an unknown key or value


def test_packed_states_energies_and_forces(case: tuple[ForcedResponse, StudyRecord]) -> None:
    response, study = case
    view = View.of(response, study)
    data = page_data(view)
    shape = (response.n_points, response.pairs.n_pairs)
    np.testing.assert_array_equal(unpacked(data["states"], "i1").reshape(shape), response.contact_state)
    energy = unpacked(data["energy"], "f4").reshape(shape)
    np.testing.assert_allclose(energy, view.energy_factor * response.friction_energy, rtol=1e-6, atol=1e-12)
    loops = data["loops"]
    assert loops["points"] == list(range(response.n_points))
    slots = unpacked(loops["slots"], "i4").reshape(shape)
    np.testing.assert_array_equal(slots < 0, response.contact_state == 0)
    forces = unpacked(loops["forces"], "i2").reshape(-1, 2, len(loops["times"]))
    scales = unpacked(loops["scales"], "f4")
    slot = slots[view.point, view.pair]
    exact = response.pair_cycle(view.point).force[:, view.pair, :2].T
    np.testing.assert_allclose(forces[slot] * scales[slot], exact, atol=1.01 * scales[slot] / 2)
    relative = unpacked(loops["relative"], "f4").reshape(*shape, 3, -1)
    np.testing.assert_allclose(relative[5], 1e6 * response.pair_coefficients(5), rtol=1e-6, atol=1e-9)


def test_force_of_a_stuck_pair_is_its_spring_as_the_page_assumes(case: tuple[ForcedResponse, StudyRecord]) -> None:
    response, pair = case[0], 7
    assert response.contact_state[0, pair] == 0
    motion = response.pair_displacement(0, response.samples)[:, pair, :2]
    expected = response.pairs.tangential_springs[pair] * (motion - motion.mean(axis=0))
    np.testing.assert_allclose(response.pair_cycle(0).force[:, pair, :2], expected, atol=1e-9 * np.abs(expected).max())


def held_numbers(view: View) -> int:
    """Characters of states, energies and loops on the page."""
    data = page_data(view)
    return sum(len(data[name]) for name in ("states", "energy")) + sum(
        len(data["loops"][name]) for name in ("relative", "slots", "scales", "forces")
    )


@pytest.mark.slow
def test_maps_and_loops_are_thinned_to_the_room_and_keep_the_peak(
    case: tuple[ForcedResponse, StudyRecord], monkeypatch: pytest.MonkeyPatch
) -> None:
    view = View.of(*case)
    whole = page_data(view)
    assert whole["mapPoints"] == whole["loops"]["points"] == list(range(case[0].n_points))
    fixed = page_data_module.PAIR_CHARACTERS * 110 + page_data_module.POINT_CHARACTERS * 40
    fixed += sum(len(text) for text in whole["signals"].values())
    assert case[1].rough_patch is not None
    fixed += page_data_module.HEIGHT_CHARACTERS * case[1].rough_patch.height.size
    for room, most_maps in ((400_000, 40), (30_000, 39)):
        monkeypatch.setattr(page_data_module, "DATA_CHARACTERS", fixed + room)
        data = page_data(view)
        assert view.point in data["mapPoints"]
        assert 1 < len(data["mapPoints"]) <= most_maps
        assert set(data["loops"]["points"]) <= set(data["mapPoints"])
        assert len(data["loops"]["points"]) < 40
        assert held_numbers(view) <= room + 20  # base64 fills up to four characters
        shape = len(data["mapPoints"]), case[0].pairs.n_pairs
        np.testing.assert_array_equal(
            unpacked(data["states"], "i1").reshape(shape), case[0].contact_state[data["mapPoints"]]
        )
    monkeypatch.setattr(page_data_module, "DATA_CHARACTERS", 0)
    data = page_data(view)
    assert (data["mapPoints"], data["loops"]["points"]) == ([view.point], [])


@pytest.mark.long
@pytest.mark.parametrize(("n_pairs", "n_points"), [(1000, 600), (5000, 600), (110, 10_000)])
def test_no_page_grows_beyond_its_limit(n_pairs: int, n_points: int) -> None:
    response, study = large_result(n_pairs, n_points)
    assert response.pairs.n_pairs >= n_pairs
    text = page(response, study)
    assert len(text.encode()) < LARGEST_PAGE
    data = json.loads(matched(r'id="page-data">(.*?)</script>', text, flags=re.S).group(1))
    assert data["loops"]["points"]
    assert 1 < len(data["mapPoints"]) <= n_points


@pytest.mark.slow
def test_no_page_grows_beyond_its_limit_where_all_pairs_need_their_forces() -> None:
    """Tractions that are kept at rest: the page needs the friction force of stuck pairs too."""
    response, study = large_result(3000, 200)
    law = dataclasses.replace(response.pairs.coulomb, residual_traction=np.zeros((response.pairs.n_pairs, 2)))
    retained = ContactPairs.with_laws(response.pairs.operator, [law])
    text = page(dataclasses.replace(response, pairs=retained), study)
    assert 11e6 < len(text.encode()) < LARGEST_PAGE


def test_the_rough_face_is_drawn_about_its_mean_in_mm_and_um(
    case: tuple[ForcedResponse, StudyRecord], text: str
) -> None:
    patch = case[1].rough_patch
    assert patch is not None
    figure = json.loads(matched(r'id="page-figures">(.*?)</script>', text, flags=re.S).group(1))["rough-map"]
    drawn = figure["data"][0]
    assert np.shape(drawn["z"]) == (40, 140)
    np.testing.assert_allclose(drawn["z"], 1e6 * (patch.height - patch.height.mean()), rtol=1e-3)
    assert (drawn["x"][0], drawn["x"][-1], drawn["y"][0], drawn["y"][-1]) == (0.0, 28.0, 0.0, 6.5)
    assert drawn["colorscale"] == "Cividis"
    assert len(json.dumps(drawn["z"])) < page_data_module.HEIGHT_CHARACTERS * patch.height.size
    plotly.graph_objects.Figure(figure)
    assert "28 mm by 6.5 mm" in text
    assert "Sq 54 µm and Sdq 0.82 of all waves" in text
    assert f"Sq {1e6 * patch.height.std():.4g} µm of the 5600 points" in text


@pytest.mark.slow
def test_a_study_without_roughness_has_no_rough_face(case: tuple[ForcedResponse, StudyRecord]) -> None:
    text = without_plotly(page(case[0], dataclasses.replace(case[1], rough_patch=None)))
    assert "Rough face" not in text
    assert "rough-map" not in text


@pytest.mark.slow
def test_quantities_from_the_pairing_are_folded(case: tuple[ForcedResponse, StudyRecord]) -> None:
    response, study = case
    derived = (("Pressure", 1.5, "MPa", "mean"), ("Contact pairs, sole", 24, "-", FROM_PAIRING))
    text = without_plotly(page(response, dataclasses.replace(study, derived=derived)))
    table, folded = text[text.index("<h2>Derived") : text.index("<h2>Inputs")].split("<details")
    assert "Pressure" in table
    assert "Contact pairs, sole" not in table
    assert "<summary>From the pairing of the contact faces (1)</summary>" in folded
    assert "Contact pairs, sole" in folded


@pytest.mark.slow
def test_digits_of_tables(case: tuple[ForcedResponse, StudyRecord]) -> None:
    """Four digits of derived numbers, frequencies to 0.01 Hz; the record keeps all of them."""
    response, study = case
    derived = (
        ("Peak elsewhere", 452.343123, "Hz", ""),
        ("Pressure", 1.58612345, "MPa", ""),
        ("Low", 0.812345, "Hz", ""),
    )
    text = without_plotly(page(response, dataclasses.replace(study, derived=derived)))
    table = text[text.index("<h2>Derived quantities") : text.index("<h2>Inputs")]
    assert re.findall(r"<td>(.*?)</td>", table) == ["452.34", "1.586", "0.8123"]
    modes = text[text.index("<h2>Natural frequencies") : text.index("<h2>Measures")]
    assert all(re.fullmatch(r"\d+\.\d\d", value) for value in re.findall(r"<td>(\d{3,}\.\d+)</td>", modes))
    measured = matched(r">Highest peak on the curve: frequency</th><td>(.*?) Hz<", text).group(1)
    assert measured == f"{View.of(response, study).summary.peak.frequency_hz:.2f}"
    assert f"at {measured} Hz" in text


@pytest.mark.slow
def test_page_from_a_saved_file_is_the_same(
    case: tuple[ForcedResponse, StudyRecord], text: str, tmp_path: Path
) -> None:
    save_results(tmp_path / "results.nc", *case)
    again = load_results(tmp_path / "results.nc")
    assert again.study is not None
    write_page(tmp_path / "report.html", again.response, again.study)
    assert (tmp_path / "report.html").read_text(encoding="utf-8") == text


@pytest.mark.slow
def test_page_from_a_file_that_is_older_than_sketches_and_rough_faces(
    case: tuple[ForcedResponse, StudyRecord], tmp_path: Path
) -> None:
    sketched = dataclasses.replace(case[1], sketch=stacked_boxes())
    save_results(tmp_path / "results.nc", case[0], sketched)
    with h5py.File(tmp_path / "results.nc", "a") as file:
        del file["sketch"]
        for name in ("mode_contact", "rough_height", "rough_numbers"):
            del file["study"][name]
    old = load_results(tmp_path / "results.nc")
    assert old.study is not None
    assert page(old.response, old.study) == page(case[0], dataclasses.replace(case[1], rough_patch=None))


@pytest.mark.slow
def test_page_to_a_folder_that_is_not_there(case: tuple[ForcedResponse, StudyRecord], tmp_path: Path) -> None:
    with rejects(InputError):
        write_page(tmp_path / "none" / "report.html", *case)


@pytest.mark.slow
def test_study_without_faces_groups_or_modes(case: tuple[ForcedResponse, StudyRecord]) -> None:
    response, study = case
    bare = dataclasses.replace(study, signal_groups={}, mode_table=(), derived=())
    text = without_plotly(page(response, bare))
    assert "Motion over one period" not in text
    assert "Natural frequencies, contact" not in text


@pytest.mark.slow
def test_a_mode_that_only_the_reference_has_is_shown_without_deviation(
    case: tuple[ForcedResponse, StudyRecord],
) -> None:
    response, study = case
    short = dataclasses.replace(study, mode_table=(study.mode_table[0], {"mode": 2, "reference_hz": 530.0}))
    section = page(response, short).partition("Natural frequencies, contact")[2].partition("</section>")[0]
    assert re.search(r"<tr><td>2</td><td[^>]*>–</td>(<td>–</td>){4}<td>530.00</td><td>–</td></tr>", section)


@pytest.mark.slow
def test_a_section_is_one_object_and_shows_where_it_applies(
    case: tuple[ForcedResponse, StudyRecord], monkeypatch: pytest.MonkeyPatch
) -> None:
    def values(view: View) -> dict[str, int]:
        return {"largest": int(view.response.moving_pairs.max())}

    def applies(which: bool) -> Callable[[View], bool]:
        return lambda view: which

    sections = [
        Section(f"Moving pairs {which}", "<p>at most {{ largest }}</p>", values, applies=applies(which))
        for which in (True, False)
    ]
    monkeypatch.setattr(page_module, "SECTIONS", (*page_module.SECTIONS, *sections))  # type: ignore[attr-defined]
    text = without_plotly(page(*case))
    assert f"<h2>Moving pairs True</h2>\n<p>at most {case[0].moving_pairs.max()}</p>" in text
    assert "Moving pairs False" not in text


@pytest.mark.slow
def test_states_of_other_laws_have_their_names(
    case: tuple[ForcedResponse, StudyRecord], monkeypatch: pytest.MonkeyPatch
) -> None:
    response, study = case
    names = {ContactState.STUCK: "elastic", ContactState.STICK_SLIP: "sliding"}
    monkeypatch.setattr(CoulombLaw, "states", names)
    data = page_data(View.of(response, study))
    assert [style["name"] for style in data["stateStyles"]] == ["elastic", "sliding", None]
    tiles = without_plotly(page(response, study))
    assert re.search(r"\d+ elastic · \d+ sliding<", tiles)
    assert '<th scope="row">Pairs sliding</th>' in tiles
