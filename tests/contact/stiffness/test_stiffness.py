"""Contact stiffness of a rough face: closed forms against quadrature, tabulated values, and its spread over pairs."""

from __future__ import annotations

import csv
from collections.abc import Callable
from itertools import pairwise
from math import exp, inf, log, pi, sqrt
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from rough_faces import MINDLIN, NOMINAL_AREA, RATIO, REDUCED_MODULUS, rough
from sentences import printed_sentence, rejects
from stickslip.contact.stiffness.asperities import (
    SpotPopulation,
    domain_extension_factor,
    fully_plastic_load,
    log_critical_area,
    spots_under_load,
)
from stickslip.contact.stiffness.fractal import (
    ContactStatus,
    Roughness,
    StiffnessMode,
    fractal_contact,
    published_contact,
    reduced_modulus,
)
from stickslip.core.errors import InputError

TABLE = Path(__file__).parents[2] / "data" / "fractal_stiffness.csv"
quick = settings(max_examples=60, deadline=None, derandomize=True)


def table() -> list[dict[str, float]]:
    """Rows of the tabulated values."""
    with TABLE.open(encoding="utf-8") as lines:
        next(lines)
        return [{name: float(text) for name, text in row.items()} for row in csv.DictReader(lines)]


class SpotBySpot:
    """A twin of the closed forms that knows one spot at a time and adds the spots up by quadrature in u = ln a'."""

    def __init__(self, roughness: Roughness, smallest: float, largest: float) -> None:
        self.roughness, self.smallest, self.largest = roughness, smallest, largest
        self.d = roughness.fractal_dimension - 1

    def interference(self, area: float) -> float:
        """delta of equation (6), with d."""
        r, d = self.roughness, self.d
        return float(2 * r.fractal_roughness ** (d - 1) * sqrt(log(RATIO)) * (2 * sqrt(area / pi)) ** (2 - d))

    def curvature_radius(self, area: float) -> float:
        return area / pi / (2 * self.interference(area))

    def elastic_load(self, area: float) -> float:
        """Hertz in load and interference."""
        root = sqrt(self.curvature_radius(area))
        return float(4 / 3 * self.roughness.reduced_modulus * root * self.interference(area) ** 1.5)

    def is_plastic(self, area: float) -> bool:
        return self.elastic_load(area) > self.roughness.hardness * area

    def fixed_curvature_stiffness(self, area: float) -> float:
        """dF/ddelta of Hertz at constant R."""
        return 2 * self.roughness.reduced_modulus * sqrt(self.curvature_radius(area) * self.interference(area))

    def family_stiffness(self, area: float) -> float:
        """(dF/da') / (ddelta/da') along the family of spots, by central differences."""
        step = 1e-5 * area
        load = self.elastic_load(area + step) - self.elastic_load(area - step)
        return load / (self.interference(area + step) - self.interference(area - step))

    def count(self, area: float) -> float:
        """n(a') a', the number of spots for each step of ln a'."""
        d, psi = self.d, self.roughness.domain_extension
        return float(d / 2 * psi ** ((2 - d) / 2) * (self.largest / area) ** (d / 2))

    def total(
        self, plastic: Callable[[float], float], elastic: Callable[[float], float], largest: float = inf
    ) -> float:
        """Sum over all spots up to ``largest``, Gauss quadrature in panels that end at the critical area."""
        log_high = log(min(self.largest, largest))
        log_low = log(self.smallest) if self.smallest else log_high - 400
        cut = min(max(self.critical_log_area(), log_low), log_high)
        nodes, weights = np.polynomial.legendre.leggauss(30)
        result = 0.0
        for law, low, high in ((plastic, log_low, cut), (elastic, cut, log_high)):
            for start, end in pairwise(np.linspace(low, high, 41)):
                areas = np.exp(0.5 * (start + end) + 0.5 * (end - start) * nodes)
                values = [law(area) * self.count(area) for area in areas]
                result += 0.5 * (end - start) * float(weights @ values)
        return result

    def critical_log_area(self) -> float:
        """Where Hertz's load meets H a', by bisection."""
        low, high = -200.0, 50.0
        for _ in range(200):
            middle = 0.5 * (low + high)
            low, high = (middle, high) if self.is_plastic(exp(middle)) else (low, middle)
        return 0.5 * (low + high)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("dimension", "scale", "smallest", "largest", "psi"),
    [
        (2.3, 1e-9, 0.0, 1.1e-7, 1.0),
        (2.4, 1e-8, 0.0, 1e-7, 2.0848507806760166),
        (2.49, 1e-8, 7.85e-13, 1.3e-7, 1.0),
        (2.5, 1e-8, 0.0, 1.4e-7, 1.0),
        (2.5, 1e-8, 7.85e-13, 1.4e-7, 1.5),
        (2.5 + 1e-12, 1e-8, 0.0, 1.4e-7, 1.0),
        (2.7, 1e-8, 1e-14, 1e-7, 1.0),
        (2.4, 1e-8, 1e-8, 1e-7, 1.0),  # a_s' above a_c': no plastic spots
        (2.3, 1e-8, 7.85e-13, 9e-8, 1.0),  # a_l' below a_c': only plastic spots
    ],
)
def test_closed_forms_equal_quadrature(
    dimension: float, scale: float, smallest: float, largest: float, psi: float
) -> None:
    face = rough(dimension, scale, domain_extension=psi)
    twin = SpotBySpot(face, smallest, largest)
    spots = SpotPopulation(face, log(smallest) if smallest else -inf, log(largest))
    zero = lambda area: 0.0  # noqa: E731
    hardness, modulus = face.hardness, face.reduced_modulus
    assert log_critical_area(face) == pytest.approx(twin.critical_log_area(), abs=1e-10)
    assert spots.plastic_load == pytest.approx(twin.total(lambda area: hardness * area, zero), rel=1e-9, abs=1e-30)
    assert spots.elastic_load == pytest.approx(twin.total(zero, twin.elastic_load), rel=1e-9, abs=1e-30)
    assert spots.real_area == pytest.approx(twin.total(lambda area: area, lambda area: 0.5 * area), rel=1e-9)
    exponent = (2 - dimension) / 2
    elastic = sqrt(2 / pi) * modulus * spots.elastic_moment(exponent)
    assert elastic == pytest.approx(twin.total(zero, twin.fixed_curvature_stiffness), rel=1e-9, abs=1e-30)
    if smallest:
        plastic = 2 / sqrt(pi) * modulus * spots.plastic_moment(exponent)
        expected = twin.total(lambda area: 2 * modulus * sqrt(area / pi), zero)
        assert plastic == pytest.approx(expected, rel=1e-9, abs=1e-30)
    median = exp(spots.log_median_area)
    part = twin.total(lambda area: hardness * area, twin.elastic_load, largest=median)
    assert part == pytest.approx(0.5 * spots.load, rel=1e-9)


@pytest.mark.slow
@pytest.mark.parametrize("dimension", [2.3, 2.4, 2.49, 2.5, 2.7])
def test_stiffness_equals_quadrature_over_single_spots(dimension: float) -> None:
    face = rough(dimension)
    load = 4 * max(fully_plastic_load(face), 100.0)
    actual, printed = fractal_contact(face, load), fractal_contact(face, load, "varying-curvature")
    twin = SpotBySpot(face, 0.0, actual.largest_area)
    zero = lambda area: 0.0  # noqa: E731
    assert actual.normal == pytest.approx(twin.total(zero, twin.fixed_curvature_stiffness), rel=1e-9)
    # The other mode is the derivative along the family of spots, whose curvature changes with the spot.
    assert printed.normal == pytest.approx(twin.total(zero, twin.family_stiffness), rel=1e-7)
    assert twin.total(lambda area: face.hardness * area, twin.elastic_load) == pytest.approx(load, rel=1e-9)


@pytest.mark.parametrize("row", table(), ids=lambda row: "D{:g} G{:g} {:g}N".format(*list(row.values())[:3]))
def test_tabulated_values(row: dict[str, float]) -> None:
    face = rough(row["fractal_dimension"], row["fractal_roughness_m"])
    actual = fractal_contact(face, row["load_n"], area=NOMINAL_AREA)
    printed = published_contact(face, row["load_n"], mode="varying-curvature")
    four_digits = 6e-4
    assert actual.critical_area == pytest.approx(row["critical_area_m2"], rel=four_digits)
    assert actual.largest_area == pytest.approx(row["largest_area_m2"], rel=four_digits)
    assert actual.plastic_load_share == pytest.approx(row["plastic_load_share"], rel=four_digits)
    assert actual.real_area / NOMINAL_AREA == pytest.approx(row["real_area_share"], rel=four_digits)
    published = published_contact(face, row["load_n"], area=NOMINAL_AREA)
    assert published.normal == pytest.approx(row["normal_consistent"], rel=four_digits)
    assert published.tangential == pytest.approx(row["tangential"], rel=four_digits)
    if row["normal_consistent"] > 0.0:
        assert actual == published
    else:
        assert actual.is_least
    assert printed.normal == pytest.approx(row["normal_varying_curvature"], rel=four_digits)
    assert printed.tangential == published.tangential
    assert (actual.status == ContactStatus.FULLY_PLASTIC) == (row["normal_consistent"] == 0.0)


def test_the_table_is_whole() -> None:
    rows = table()
    assert len(rows) == 48
    assert sum(row["normal_consistent"] == 0.0 for row in rows) == 20


@pytest.mark.parametrize(
    ("shortest", "dimension", "normal"),
    [
        (1e-5, 2.2, 27e7),
        (1e-5, 2.3, 32e7),
        (1e-5, 2.4, 44e7),
        (1e-5, 2.49, 74e7),
        (1e-6, 2.2, 56e7),
        (1e-6, 2.3, 76e7),
        (1e-6, 2.4, 130e7),
        (1e-6, 2.49, 250e7),
    ],
)
def test_unloading_stiffness(shortest: float, dimension: float, normal: float) -> None:
    actual = fractal_contact(rough(dimension, shortest_length=shortest), 500.0, "unloading")
    assert actual.normal == pytest.approx(normal, rel=0.02)  # two digits
    assert actual.tangential == pytest.approx(MINDLIN * actual.normal, rel=1e-14)


def test_unloading_needs_a_shortest_wave() -> None:
    with rejects(InputError, "mode"):
        fractal_contact(rough(), 500.0, "unloading")


@pytest.mark.parametrize(
    ("dimension", "ratio", "factor"),
    [(2.2, 0.549, 1.5), (2.3, 0.508, 1.619), (2.4, 0.463, 1.778), (2.49, 0.417, 1.974)],
)
def test_printed_stiffness_against_consistent(dimension: float, ratio: float, factor: float) -> None:
    face = rough(dimension, 1e-11)
    actual, printed = fractal_contact(face, 2000.0), fractal_contact(face, 2000.0, "varying-curvature")
    assert actual.tangential / actual.normal == pytest.approx(0.823529, abs=1e-6)
    assert printed.tangential / printed.normal == pytest.approx(ratio, abs=1e-3)
    assert printed.normal / actual.normal == pytest.approx(factor, abs=6e-4)


@pytest.mark.parametrize(
    ("dimension", "load", "slope"), [(2.4, 500.0, 0.869), (2.49, 500.0, 0.950), (2.2, 200.0, 1.83), (2.2, 2000.0, 0.92)]
)
def test_load_exponent(dimension: float, load: float, slope: float) -> None:
    face = rough(dimension, 1e-11)
    up, down = fractal_contact(face, 1.01 * load).normal, fractal_contact(face, load / 1.01).normal
    assert log(up / down) / (2 * log(1.01)) == pytest.approx(slope, abs=0.006)


@pytest.mark.parametrize(("dimension", "limit"), [(2.2, 1.2 / 1.8), (2.4, 0.875), (2.45, 1.45 / 1.55), (2.8, 1.0)])
def test_load_exponent_of_elastic_contact(dimension: float, limit: float) -> None:
    face = rough(dimension, 1e-22 if dimension < 2.3 else 1e-15)  # a_c' is far below every spot that carries load
    load = 1e-6 if dimension > 2.5 else 1e3
    up, down = fractal_contact(face, 1.01 * load).normal, fractal_contact(face, load / 1.01).normal
    assert log(up / down) / (2 * log(1.01)) == pytest.approx(limit, abs=0.01)


@pytest.mark.parametrize(
    ("dimension", "psi"), [(2.2, 2.3013675), (2.3, 2.1837146), (2.4, 2.0848508), (2.49, 2.0085564)]
)
def test_domain_extension_factor(dimension: float, psi: float) -> None:
    actual, d = domain_extension_factor(dimension), dimension - 1
    assert actual == pytest.approx(psi, abs=5e-8)
    assert actual ** ((2 - d) / 2) - (1 + actual ** (-d / 2)) ** (-(2 - d) / d) == pytest.approx((2 - d) / d, abs=1e-14)


def test_domain_extension_matters_only_near_full_plasticity() -> None:
    def change(face: Roughness, load: float) -> float:
        extended = rough(
            face.fractal_dimension,
            hardness=face.hardness,
            domain_extension=domain_extension_factor(face.fractal_dimension),
        )
        return fractal_contact(extended, load).normal / fractal_contact(face, load).normal - 1

    assert abs(change(rough(2.4), 500.0)) < 0.04
    assert abs(change(rough(2.49), 500.0)) < 0.04
    harder = rough(2.3, hardness=4e9)
    assert change(harder, 500.0) == pytest.approx(-0.7, abs=0.03)


def test_reduced_modulus() -> None:
    assert reduced_modulus(197e9, 0.3, 197e9, 0.3) == pytest.approx(REDUCED_MODULUS, rel=1e-9)
    assert reduced_modulus(200e9, 0.3, 1e30, 0.3) == pytest.approx(200e9 / 0.91, rel=1e-12)
    with rejects(InputError, "second_young_modulus"):
        reduced_modulus(1.0, 0.3, -1.0, 0.3)
    with rejects(InputError, "first_poisson_ratio"):
        reduced_modulus(1.0, 0.7, 1.0, 0.3)


faces = st.builds(
    lambda dimension, exponent, psi: rough(dimension, 10.0**exponent, domain_extension=psi),
    st.one_of(st.just(2.5), st.floats(2.15, 2.9)),
    st.floats(-12, -6),
    st.floats(1.0, 2.6),
)


@pytest.mark.slow
@quick
@given(faces, st.floats(-20, 3), st.floats(0.01, 3), st.one_of(st.just(-inf), st.floats(-35, -20)))
def test_load_rises_with_the_largest_spot(
    face: Roughness, log_largest: float, step: float, log_smallest: float
) -> None:
    smaller = SpotPopulation(face, log_smallest, log_largest)
    larger = SpotPopulation(face, log_smallest, log_largest + step)
    assert larger.load > smaller.load
    assert larger.real_area > smaller.real_area


@pytest.mark.slow
@quick
@given(faces, st.floats(-3, 5), st.one_of(st.just(-inf), st.floats(-35, -20)))
def test_the_spots_carry_the_load(face: Roughness, log_load: float, log_smallest: float) -> None:
    load = 10.0**log_load
    spots = spots_under_load(face, load, log_smallest)
    assert spots.load == pytest.approx(load, rel=1e-11)
    assert spots.log_largest >= log_smallest


@pytest.mark.slow
@quick
@given(faces, st.floats(-2, 4), st.sampled_from(["consistent", "varying-curvature"]))
def test_stiffness_is_never_negative_and_rises_with_load(face: Roughness, log_load: float, mode: StiffnessMode) -> None:
    load = 10.0**log_load
    lower, upper = published_contact(face, load, mode), published_contact(face, 1.5 * load, mode)
    assert 0.0 <= lower.normal <= upper.normal
    assert 0.0 <= lower.tangential <= upper.tangential
    assert 0.0 <= lower.plastic_load_share <= 1.0
    assert (lower.normal == 0.0) == (load <= fully_plastic_load(face))
    found = fractal_contact(face, load, mode)
    assert found.is_least == (lower.normal == 0.0)
    assert found == lower or found.is_least


def test_load_is_continuous_where_elastic_spots_begin() -> None:
    face = rough(2.3)
    threshold = fully_plastic_load(face)
    assert published_contact(face, threshold * (1 - 1e-9)).normal == 0.0
    above = fractal_contact(face, threshold * (1 + 1e-6))
    assert above.normal > 0.0
    assert above.largest_area == pytest.approx(exp(log_critical_area(face)), rel=1e-5)


@pytest.mark.parametrize("load", [0.0, -3.0])
def test_no_load_no_stiffness(load: float) -> None:
    actual = fractal_contact(rough(), load)
    assert (actual.normal, actual.tangential, actual.largest_area, actual.real_area) == (0.0, 0.0, 0.0, 0.0)
    assert actual.status == "no contact"


@pytest.mark.parametrize(
    ("face", "load", "status", "words"),
    [
        (rough(2.2), 500.0, ContactStatus.FULLY_PLASTIC, "no spot is elastic"),
        (rough(2.49, 1e-12), 9e3, ContactStatus.REAL_AREA_ABOVE_NOMINAL, "above the nominal area"),
        (rough(2.49, 1e-11), 2e3, ContactStatus.LARGE_REAL_AREA, "neighbouring spots merge"),
        (rough(2.8, 1e-15), 1e5, ContactStatus.REAL_AREA_ABOVE_NOMINAL, "does not fit"),
        (rough(sample_length=0.028, shortest_length=1e-7), 500.0, ContactStatus.STEEP_SURFACE, "Sdq = "),
        (rough(2.49, shortest_length=1e-8), 500.0, ContactStatus.SHORTEST_WAVE_BELOW_ROUGHNESS, "steeper than 1"),
        (rough(shortest_length=1e-4), 500.0, ContactStatus.NO_PLASTIC_SPOTS, "no spot is plastic"),
        (rough(2.3), 2000.0, ContactStatus.STEEP_ASPERITIES, "of their radius"),
        (rough(2.97), 500.0, ContactStatus.STEEP_ASPERITIES, "within 0.05 of its limit 3"),
        (rough(2.03, 1e-30), 500.0, ContactStatus.FULLY_PLASTIC, "within 0.05 of its limit 2"),
    ],
)
def test_every_doubtful_regime_has_a_sentence(face: Roughness, load: float, status: str, words: str) -> None:
    actual = fractal_contact(face, load, area=NOMINAL_AREA)
    assert any(words in message for message in actual.messages), (actual.status, actual.messages)
    assert actual.status == status  # the worst of what was found


def test_the_slope_is_that_of_the_spot_that_halves_the_load() -> None:
    face = rough(2.3)
    median = exp(spots_under_load(face, 2000.0).log_median_area)
    slope = SpotBySpot(face, 0.0, 1.0).interference(median) / sqrt(median / pi)
    printed_sentence(fractal_contact(face, 2000.0).messages[0], f"{slope:.2g}")


def test_the_status_is_the_worst_finding() -> None:
    valid = fractal_contact(rough(), 500.0, area=NOMINAL_AREA)
    assert (valid.status, valid.messages) == (ContactStatus.VALID, ())
    several = fractal_contact(rough(2.2, sample_length=0.028, shortest_length=1e-6), 500.0)
    assert several.status == ContactStatus.FULLY_PLASTIC
    as_text: Any = "fully plastic"
    assert several.status == as_text
    assert len(several.messages) == 3
    printed_sentence("\n".join(several.messages))
