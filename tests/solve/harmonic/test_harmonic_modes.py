import numpy as np
import pytest

from stickslip.solve.harmonic import harmonic_modes
from stickslip.solve.harmonic.harmonic_modes import NewtonCompliance, SharedModes

ROWS, MODES = 12, 20
COLUMNS = np.array([0, 1, 4, 7, 8])


def newton_of(near: int) -> NewtonCompliance:
    random = np.random.default_rng(0)
    modes, contact = random.standard_normal((MODES, MODES)), random.standard_normal((ROWS, MODES))
    shared = SharedModes(modes, contact, np.linspace(1.0, 5.0, MODES), near)
    gain = random.standard_normal((2, near)) + 1j * random.standard_normal((2, near))
    mean = random.standard_normal((ROWS, ROWS))
    return shared.newton(mean + mean.T, COLUMNS, gain)


@pytest.mark.parametrize("near", [0, 6])
def test_a_large_matrix_has_its_static_parts_in_single_precision(near: int, monkeypatch: pytest.MonkeyPatch) -> None:
    double = newton_of(near)
    monkeypatch.setattr(harmonic_modes, "SINGLE_COLUMNS", len(COLUMNS))
    single = newton_of(near)
    assert (double.far.dtype, double.mean.dtype) == (np.float64, np.float64)
    assert (single.far.dtype, single.mean.dtype) == (np.float32, np.float32)
    random = np.random.default_rng(1)
    forces, weights = random.standard_normal((5, len(COLUMNS))), random.standard_normal((5, ROWS))
    for answer, expected in (
        (single.apply(forces), double.apply(forces)),
        (single.apply_transposed(weights), double.apply_transposed(weights)),
        (single.block(2, np.arange(ROWS)), double.block(2, np.arange(ROWS))),
    ):
        assert answer.dtype == expected.dtype
        difference = np.abs(answer - expected).max() / np.abs(expected).max()
        assert 0.0 < difference < 1e-6


def test_both_products_are_transposes_of_each_other_in_single_precision(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(harmonic_modes, "SINGLE_COLUMNS", 0)
    newton, random = newton_of(6), np.random.default_rng(2)
    forces, weights = random.standard_normal((5, len(COLUMNS))), random.standard_normal((5, ROWS))
    assert np.vdot(weights, newton.apply(forces)) == pytest.approx(
        np.vdot(newton.apply_transposed(weights), forces), rel=1e-5
    )


def test_a_matrix_with_all_modes_stays_in_double_precision(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(harmonic_modes, "SINGLE_COLUMNS", 0)
    assert newton_of(MODES).mean.dtype == np.float64
