"""Constants of a rough face and arguments of its stiffness that are out of range."""

from typing import Any

import numpy as np
import pytest

from rough_faces import pair_stiffness, rough
from sentences import rejects
from stickslip.contact.stiffness.fractal import Roughness, fractal_contact
from stickslip.contact.stiffness.fractal_law import FractalStiffness
from stickslip.contact.stiffness.stiffness_law import springs_of_pairs
from stickslip.core.errors import InputError, RoughnessError


@pytest.mark.parametrize(
    ("changes", "expected"),
    [
        ({"fractal_dimension": 2.0}, (InputError, "fractal_dimension")),
        ({"fractal_dimension": 3.0}, (InputError, "fractal_dimension")),
        ({"fractal_dimension": 1.4}, (InputError, "fractal_dimension")),
        ({"fractal_dimension": float("nan")}, (InputError, "fractal_dimension")),
        ({"fractal_roughness": 0.0}, (InputError, "fractal_roughness")),
        ({"fractal_roughness": float("inf")}, (InputError, "fractal_roughness")),
        ({"hardness": -1.0}, (InputError, "hardness")),
        ({"reduced_modulus": 0.0}, (InputError, "reduced_modulus")),
        ({"poisson_ratio": 0.6}, (InputError, "poisson_ratio")),
        ({"domain_extension": 0.5}, (InputError, "domain_extension")),
        ({"frequency_ratio": 1.0}, (InputError, "frequency_ratio")),
        ({"shortest_length": 0.0}, (InputError, "shortest_length")),
        ({"sample_length": 1e-6, "shortest_length": 1e-3}, (InputError, "shortest_length")),
        ({"fractal_dimension": 2.001}, (RoughnessError, "fractal_dimension")),
    ],
)
def test_roughness_out_of_range(changes: dict[str, float], expected: tuple[Any, ...]) -> None:
    values = {"fractal_dimension": 2.4, "fractal_roughness": 1e-8, "hardness": 3e9, "reduced_modulus": 1e11}
    with rejects(*expected):
        Roughness(**(values | {"poisson_ratio": 0.3} | changes))


def test_arguments_out_of_range() -> None:
    wrong: Any = "printed"
    with rejects(InputError, "mode"):
        fractal_contact(rough(), 1.0, wrong)
    with rejects(InputError, "load"):
        fractal_contact(rough(), float("nan"))
    with rejects(InputError, "area"):
        fractal_contact(rough(), 1.0, area=0.0)
    wrong = "pair"
    with rejects(InputError, "allocation"):
        pair_stiffness(rough(), np.ones(2), 1.0, allocation=wrong)
    with rejects(InputError, "area"):
        pair_stiffness(rough(), [1.0, 0.0], 1.0)
    with rejects(InputError, "preload"):
        pair_stiffness(rough(), [1.0, 1.0], [1.0, 1.0, 1.0])
    with rejects(InputError, "face"):
        springs_of_pairs(FractalStiffness(rough(), 1.0), [1.0, 1.0], 1.0, face=[0.5, 1.0])
