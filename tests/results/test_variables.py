"""What a results file holds: the variables of format 2, and pairs of any law."""

from __future__ import annotations

import dataclasses
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, ClassVar

import h5netcdf
import h5py
import numpy as np
import pytest

from sentences import rejects
from sketches import shaken, stacked_boxes
from stickslip.contact.law import registry as laws
from stickslip.contact.law.contact_pairs import ContactPairs
from stickslip.contact.law.coulomb import CoulombLaw
from stickslip.contact.law.law import ContactState
from stickslip.core.errors import InputError, ResultsFileError
from stickslip.results.response import ForcedResponse
from stickslip.results.storage import load_results, save_results
from stickslip.results.stored import UnreadableError
from stickslip.results.variables import Count, Labelled, Numbers, stored
from synthetic import synthetic_response, synthetic_study

# Written by the version before variables were declared at their fields, with every group and variable of format 2.
OLD_FILE = Path(__file__).parents[1] / "data" / "results_of_version_0_1.nc"
# Group -> variables of format 2; readers of other programs rely on them.
VARIABLES = {
    "": "closure contact_state displacement_cosine displacement_mean displacement_sine dissipated_energy force_cosine "
    "force_mean force_sine frequency harmonic input_energy iterations message normal_work provenance residual settings "
    "viscous_energy warnings",
    "linear": "free_cosine free_frequency free_mean free_sine frequency stuck_cosine stuck_frequency stuck_mean "
    "stuck_sine",
    "pairs": "friction_coefficient normal_stiffness operator preload tangential_stiffness",
    "study": "derived description face_names inputs mode_contact mode_table output_names output_rows pair_area "
    "pair_face pair_position rough_height rough_numbers signal_groups title warnings",
    "sketch": "body body_names constant face held load_names load_places loads mesh_sides points response_names "
    "response_places sides",
}
# Variables that older files of the format do not have.
STABILITY = {f"/{name}" for name in ("stable", "doubtful", "multipliers_real", "multipliers_imaginary", "bifurcations")}
YOUNGER = {
    "/amplitude",
    "/load_factor",
    "/kinetic_energy",
    "/part",
    "/stability_message",
    "study/mode_reference",
    "study/notes",
    "sketch/motion_frequency",
}
YOUNGER |= STABILITY | {
    f"sketch/motion_of_{of}_{part}" for of in ("points", "loads", "responses") for part in ("mean", "cosine", "sine")
}


@pytest.fixture(scope="module")
def response() -> ForcedResponse:
    return synthetic_response(columns=4, rows=3, n_points=20)


def listing(path: Path) -> dict[str, Any]:
    """Every variable with its dimensions, kind and labels, and the labels of each group.

    Of a ``long_name`` only whether there is one: it explains a variable to a reader, and its words may improve. Without
    the checksums of texts, which old files do not have.
    """
    actual: dict[str, Any] = {}
    with h5netcdf.File(path, "r") as file:
        for name in ("", *file.groups):
            group = file[name] if name else file
            actual[name] = {label: str(value) for label, value in group.attrs.items()}
            for variable, values in group.variables.items():
                labels = dict(values.attrs)
                labels.pop("crc32", None)
                if "long_name" in labels:
                    labels["long_name"] = bool(labels["long_name"])
                actual[f"{name}/{variable}"] = (values.dimensions, str(values.dtype), labels)
    return actual


@pytest.mark.slow
def test_a_file_has_the_variables_of_its_format(response: ForcedResponse, tmp_path: Path) -> None:
    study = dataclasses.replace(synthetic_study(4, 3), sketch=shaken(stacked_boxes()))
    points = response.n_points
    flags = np.ones(points, dtype=bool)
    response = dataclasses.replace(
        response, stable=flags, doubtful=flags, multipliers=np.ones((points, 4), dtype=complex)
    )
    save_results(tmp_path / "new.nc", response, study)
    now, before = listing(tmp_path / "new.nc"), listing(OLD_FILE)
    expected = {f"{group}/{name}" for group, names in VARIABLES.items() for name in names.split()}
    assert {name for name in before if "/" in name} == expected
    assert {name for name in now if "/" in name} == expected | YOUNGER
    assert {name: now[name] for name in before} == before


def test_a_file_of_an_older_version_is_read() -> None:
    old = load_results(OLD_FILE)
    assert old.study is not None
    assert old.study.sketch is not None
    assert old.study.sketch.motion is None
    assert old.study.rough_patch is not None
    assert old.response.load_factor.tolist() == [1.0] * 4
    assert old.response.kinetic_energy.tolist() == [0.0] * 4
    assert old.study.mode_table[0]["reference_hz"] == 506.83
    assert old.study.mode_reference == "the frequencies to which the default geometry was fitted"
    assert not any("table2_hz" in row for row in old.study.mode_table)
    synthetic = synthetic_response(columns=4, rows=3, n_points=20)
    np.testing.assert_allclose(old.response.frequency_hz, synthetic.frequency_hz[8:12], rtol=1e-12)
    assert old.response.pairs.law_names == ("coulomb",)
    assert old.response.warnings == ("too few harmonics",)


@pytest.mark.slow
def test_load_factors_come_back(response: ForcedResponse, tmp_path: Path) -> None:
    changed = dataclasses.replace(response, load_factor=np.linspace(0.5, 2.0, response.n_points))
    changed.save(tmp_path / "held.nc")
    assert ForcedResponse.load(tmp_path / "held.nc") == changed


@pytest.mark.slow
def test_pairs_with_gaps_and_another_return_come_back_to_the_last_digit(
    response: ForcedResponse, tmp_path: Path
) -> None:
    law = response.pairs.coulomb
    opened = np.arange(law.n_pairs) % 3 == 0
    gap = np.where(opened, np.random.default_rng(7).uniform(1e-6, 9e-6, law.n_pairs), 0.0)
    changed = dataclasses.replace(law, gap=gap, normal_load=np.where(opened, 0.0, law.normal_load), update="radial")
    pairs = ContactPairs.with_laws(response.pairs.operator, [changed])
    dataclasses.replace(response, pairs=pairs).save(tmp_path / "gap.nc")
    again = ForcedResponse.load(tmp_path / "gap.nc")
    assert again.pairs.coulomb.update == "radial"
    np.testing.assert_array_equal(again.pairs.gap, gap)
    assert again == dataclasses.replace(response, pairs=pairs)
    # Files before the variable "gap" have the force that would close it.
    with h5py.File(tmp_path / "gap.nc", "r+") as file:
        del file["pairs/gap"]
    np.testing.assert_allclose(ForcedResponse.load(tmp_path / "gap.nc").pairs.gap, gap, rtol=1e-14)


@dataclass(frozen=True)
class _Springs(CoulombLaw):
    """A law with constants of every kind; what it does is that of Coulomb."""

    name: ClassVar[str] = "springs of a test"
    states: ClassVar[Mapping[ContactState, str]] = {ContactState.STUCK: "held"}

    table: np.ndarray = field(default_factory=lambda: np.zeros((2, 3)))
    order: np.ndarray = field(default_factory=lambda: np.zeros(1, dtype=np.int64))
    active: np.ndarray = field(default_factory=lambda: np.zeros(1, dtype=bool))
    exponent: float = 1.0
    label: str = ""
    limit: float | None = None


@pytest.fixture
def mixed(response: ForcedResponse, monkeypatch: pytest.MonkeyPatch) -> ForcedResponse:
    """A response of pairs of two laws, every other pair of the second one, which is registered."""
    monkeypatch.setattr(laws._LAWS, "_makers", dict(laws._LAWS._makers))
    laws.register_contact_law(_Springs.name, _Springs)
    law = response.pairs.coulomb
    parts = [np.arange(start, law.n_pairs, 2) for start in (0, 1)]
    constants: list[dict[str, Any]] = [
        {name: value[part] for name, value in laws.law_constants(law).items() if isinstance(value, np.ndarray)}
        for part in parts
    ]
    other = _Springs(
        **constants[1],
        table=np.arange(6.0).reshape(2, 3),
        order=np.array([3, 1, 2]),
        active=np.array([True, False]),
        exponent=2.5,
        label="β-titanium",
    )
    pairs = ContactPairs.with_laws(response.pairs.operator, [CoulombLaw(**constants[0]), other], parts)
    return dataclasses.replace(response, pairs=pairs)


@pytest.mark.slow
def test_pairs_of_any_law_come_back(mixed: ForcedResponse, tmp_path: Path) -> None:
    mixed.save(tmp_path / "mixed.nc")
    again = ForcedResponse.load(tmp_path / "mixed.nc")
    assert again == mixed
    actual = again.pairs.laws[1]
    assert isinstance(actual, _Springs)
    assert actual.order.dtype == np.int64
    assert actual.active.dtype == bool
    assert actual.limit is None
    assert again.pairs.state_names == {0: "stuck or held", 1: "stick-slip", 2: "separating"}


@pytest.mark.slow
def test_a_law_that_is_not_known_here_is_named(mixed: ForcedResponse, tmp_path: Path) -> None:
    mixed.save(tmp_path / "mixed.nc")
    del laws._LAWS._makers[_Springs.name]
    with rejects(ResultsFileError):
        load_results(tmp_path / "mixed.nc")


@pytest.mark.parametrize(
    "constant",
    [{"label": ("a", "b")}, {"exponent": np.inf}],
)
def test_a_constant_that_no_file_can_store_is_rejected(mixed: ForcedResponse, tmp_path: Path, constant: Any) -> None:
    changed = dataclasses.replace(mixed.pairs.laws[1], **constant)  # type: ignore[type-var]
    pairs = ContactPairs.with_laws(mixed.pairs.operator, [mixed.pairs.laws[0], changed], mixed.pairs.members)
    with rejects(InputError):
        dataclasses.replace(mixed, pairs=pairs).save(tmp_path / "mixed.nc")
    assert not list(tmp_path.iterdir())


@pytest.mark.slow
def test_damage_to_the_pairs_of_a_law_is_noticed(mixed: ForcedResponse, tmp_path: Path) -> None:
    mixed.save(tmp_path / "mixed.nc")
    with h5py.File(tmp_path / "mixed.nc", "r+") as file:
        file["pairs/law_1/members"][0] = 0
    with rejects(ResultsFileError):
        load_results(tmp_path / "mixed.nc")


def test_a_new_number_is_one_line() -> None:
    @dataclass(frozen=True, eq=False)
    class Made(Labelled):
        count: int = field(metadata=stored(Count("how many")))
        heat: np.ndarray = field(metadata=stored(Numbers(("point",), "W", "heat at each point")))
        later: np.ndarray | None = field(default=None, metadata=stored(Numbers(("point",), "1", "", optional=True)))

    made = Made(3, np.array([1.0, 2.0]))
    dataset = made.to_dataset()
    assert dataset["heat"].attrs == {"units": "W", "long_name": "heat at each point"}
    assert set(dataset.variables) == {"count", "heat"}
    with rejects(InputError, "heat"):
        made._require_sizes({"point": 3})
    assert made == Made(3, np.array([1.0, 2.0])) != Made(3, np.array([1.0, 2.5]))


@pytest.mark.slow
def test_a_count_that_is_a_list_is_damage(tmp_path: Path, response: ForcedResponse) -> None:
    study = dataclasses.replace(synthetic_study(4, 3), sketch=stacked_boxes())
    save_results(tmp_path / "a.nc", response, study)
    with h5py.File(tmp_path / "a.nc", "r+") as file:
        del file["sketch/mesh_sides"]
        file["sketch"].create_dataset("mesh_sides", data=[12, 1])
    with rejects(ResultsFileError) as caught:
        load_results(tmp_path / "a.nc")
    assert isinstance(caught.value.__cause__, UnreadableError)


def test_to_xarray_labels_the_curve_and_what_follows_from_it(response: ForcedResponse) -> None:
    data = response.to_xarray()
    assert {name: data.sizes[name] for name in ("point", "pair", "unknown", "harmonic")} == {
        "point": 20,
        "pair": 24,
        "unknown": 10,
        "harmonic": 3,
    }
    assert "frequency" in data.coords
    np.testing.assert_array_equal(data["friction_energy"], response.friction_energy)
    np.testing.assert_array_equal(data["moving_pairs"], (response.contact_state > 0).sum(axis=1))
    assert data["moving_pairs"].dims == ("point",)
    assert data["load_factor"].attrs["units"] == "1"
