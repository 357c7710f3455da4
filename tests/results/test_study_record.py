"""What a record of a study rejects before it is written, and the versions that it names."""

import dataclasses
from typing import Any

import numpy as np
import pytest

from sentences import rejects
from stickslip.core.errors import InputError
from stickslip.results.record import run_provenance
from synthetic import synthetic_study


@pytest.mark.parametrize(
    ("change", "key"),
    [
        ({"outputs": {}}, "outputs"),
        ({"outputs": {"a": np.ones(3), "b": np.ones(4)}, "signal_groups": {}}, "outputs"),
        ({"signal_groups": {"Damper": ("nowhere",)}}, "signal_groups"),
        ({"pair_area": np.ones(3)}, "pair_face"),
        ({"face_names": ("only one",)}, "pair_face"),
        ({"mode_table": ({"freq": 1.0},)}, "mode_table"),
        ({"mode_reference": ""}, "mode_reference"),
        ({"mode_table": ({"reference_hz": 0.0},)}, "mode_table"),
    ],
)
def test_wrong_study_records_are_rejected(change: dict[str, Any], key: str) -> None:
    with rejects(InputError, key):
        dataclasses.replace(synthetic_study(4, 3), **change)


def test_provenance_names_the_versions() -> None:
    provenance = run_provenance()
    assert provenance["numpy"] == np.__version__
    assert provenance["date"].endswith("+00:00")


@pytest.mark.parametrize(
    ("change", "keys"),
    [
        ({"height": np.zeros(5)}, ("height",)),
        ({"height": np.zeros((1, 5))}, ("height",)),
        ({"height": np.full((3, 3), np.nan)}, ("height",)),
        ({"length": 0.0}, ("length", "width")),
    ],
)
def test_a_rough_face_that_is_no_grid_is_rejected(change: dict[str, Any], keys: tuple[str, ...]) -> None:
    with rejects(InputError, *keys):
        dataclasses.replace(synthetic_study(4, 3).rough_patch, **change)  # type: ignore[type-var]
