"""Measures of a periodic stress against closed forms, invariance and a dense sampling."""

from __future__ import annotations

import numpy as np
import pytest

from sentences import rejects
from stickslip.core.errors import InputError
from stickslip.core.fourier import synthesis_matrix
from stickslip.core.validation import FloatArray
from stickslip.structure.stress_cycle import largest_over_cycle, principal_stresses, stress_cycle, von_mises

XX, YY, ZZ, XY, YZ, ZX = range(6)


def tensors(stress: FloatArray) -> FloatArray:
    """(..., 3, 3) of (..., 6)."""
    rows = [[XX, XY, ZX], [XY, YY, YZ], [ZX, YZ, ZZ]]
    return stress[..., np.array(rows)]


def one_harmonic(mean: dict[int, float], cosine: dict[int, float], sine: dict[int, float]) -> FloatArray:
    coefficients = np.zeros((1, 6, 3))
    for column, part in enumerate((mean, cosine, sine)):
        for component, value in part.items():
            coefficients[0, component, column] = value
    return coefficients


def test_uniaxial_stress_about_a_mean() -> None:
    cycle = stress_cycle(one_harmonic({XX: 40e6}, {XX: 60e6}, {XX: 80e6}))  # 40 + 100 cos(w t - phase) MPa
    assert cycle.largest_von_mises == pytest.approx(140e6, rel=1e-12)
    assert cycle.smallest_von_mises == pytest.approx(0.0, abs=200.0)  # a kink: the search ends next to it
    assert cycle.largest_first_principal == pytest.approx(140e6)
    assert cycle.smallest_first_principal == pytest.approx(0.0, abs=1.0)
    assert cycle.largest_third_principal == pytest.approx(0.0, abs=1.0)
    assert cycle.smallest_third_principal == pytest.approx(-60e6)
    assert cycle.alternating == pytest.approx(100e6, rel=1e-10)
    assert cycle.mean == pytest.approx(40e6)


def test_tension_and_shear_a_quarter_of_a_period_apart() -> None:
    """s = a cos, t = b sin: von Mises^2 = a^2 cos^2 + 3 b^2 sin^2, an ellipse whose longer half axis is alternating."""
    tension, shear = 50e6, 45e6
    cycle = stress_cycle(one_harmonic({}, {XX: tension}, {XY: shear}))
    longer = np.sqrt(3.0) * shear
    assert cycle.largest_von_mises == pytest.approx(longer, rel=1e-12)
    assert cycle.smallest_von_mises == pytest.approx(tension, rel=1e-12)
    assert cycle.alternating == pytest.approx(longer, rel=1e-10)
    assert cycle.mean == pytest.approx(0.0, abs=1.0)
    # s_1 = h c + sqrt(b^2 - (b^2 - h^2) c^2) with h = a / 2 and c = cos; its slope is zero at c = h / sqrt(b^2 - h^2).
    assert cycle.largest_first_principal == pytest.approx(shear**2 / np.sqrt(shear**2 - 0.25 * tension**2))
    assert cycle.smallest_first_principal == pytest.approx(0.0, abs=1.0)


@pytest.mark.parametrize("mean", [0.0, 3.0])
def test_the_largest_stresses_of_many_rows_are_those_of_all_rows(mean: float) -> None:
    """Rows of any phase and with several harmonics; only some of them are computed."""
    rng = np.random.default_rng(4)
    coefficients = rng.normal(size=(400, 6, 7)) * rng.uniform(0.1, 1.0, size=(400, 1, 1)) * 1e8
    coefficients[..., 0] *= mean
    cycle = stress_cycle(coefficients)
    expected = (cycle.largest_von_mises.max(), cycle.alternating.max())
    assert largest_over_cycle(coefficients) == pytest.approx(expected, rel=1e-12)
    constant = float(von_mises(coefficients[0, :, 0]))
    assert largest_over_cycle(coefficients[:1, :, :1]) == pytest.approx((constant, 0.0))


def test_a_rotation_of_all_stress_directions_with_constant_von_mises_alternates() -> None:
    """(s, t) turns at constant von Mises stress: its range is zero, but the material sees an alternating stress."""
    cycle = stress_cycle(one_harmonic({}, {XX: 30e6, YY: -30e6}, {XY: 30e6}))
    assert cycle.largest_von_mises - cycle.smallest_von_mises == pytest.approx(0.0, abs=1.0)
    assert cycle.alternating == pytest.approx(np.sqrt(3.0) * 30e6)


@pytest.mark.slow
def test_a_constant_stress() -> None:
    constant = np.zeros((2, 6, 1))
    constant[1, :3, 0] = 10e6
    cycle = stress_cycle(constant)
    for values in vars(cycle).values():
        assert values.shape == (2,)
    assert cycle.largest_first_principal == pytest.approx([0.0, 10e6])
    assert cycle.alternating == pytest.approx(0.0, abs=1e-3)
    assert stress_cycle(np.empty((0, 6, 3))).mean.shape == (0,)


@pytest.mark.long
@pytest.mark.parametrize("harmonics", [1, 3, 7])
def test_a_dense_sampling_finds_no_larger_extreme(harmonics: int) -> None:
    rows, count = 12, 6000
    coefficients = np.random.default_rng(harmonics).standard_normal((rows, 6, 2 * harmonics + 1))
    cycle = stress_cycle(coefficients)
    samples = np.einsum("pic,tc->pti", coefficients, synthesis_matrix(harmonics, count))
    equivalent = von_mises(samples)
    principal = np.linalg.eigvalsh(tensors(samples))

    def close(expected: FloatArray) -> object:
        return pytest.approx(expected, rel=3e-5, abs=3e-3)

    assert (cycle.largest_von_mises >= equivalent.max(axis=1) * (1.0 - 1e-12)).all()
    assert cycle.largest_von_mises == close(equivalent.max(axis=1))
    assert cycle.smallest_von_mises == close(equivalent.min(axis=1))
    for values, eigenvalue in ((cycle.largest_first_principal, 2), (cycle.largest_third_principal, 0)):
        assert values == close(principal[:, :, eigenvalue].max(axis=1))
    for values, eigenvalue in ((cycle.smallest_first_principal, 2), (cycle.smallest_third_principal, 0)):
        assert values == close(principal[:, :, eigenvalue].min(axis=1))
    for row in range(rows):
        some = samples[row, ::10]
        difference = von_mises(some[:, None] - some[None])
        first, second = np.unravel_index(difference.argmax(), difference.shape)
        assert cycle.alternating[row] >= 0.5 * difference.max() * (1.0 - 1e-10)
        assert cycle.alternating[row] == pytest.approx(0.5 * difference.max(), rel=1e-3)
        assert cycle.mean[row] == pytest.approx(von_mises(0.5 * (some[first] + some[second])), rel=0.05, abs=0.05)


@pytest.mark.slow
def test_the_measures_do_not_depend_on_the_axes() -> None:
    coefficients = np.random.default_rng(5).standard_normal((6, 6, 7))
    turn, _ = np.linalg.qr(np.random.default_rng(6).standard_normal((3, 3)))
    turned = np.einsum("ia,pcab,jb->pcij", turn, tensors(coefficients.swapaxes(1, 2)), turn)
    pairs = [(0, 0), (1, 1), (2, 2), (0, 1), (1, 2), (2, 0)]
    other = np.stack([turned[..., i, j] for i, j in pairs], axis=1)
    first, second = stress_cycle(coefficients), stress_cycle(other)
    for name, values in vars(first).items():
        np.testing.assert_allclose(getattr(second, name), values, rtol=1e-6, atol=1e-7, err_msg=name)


def test_principal_stresses_of_equal_and_nearly_equal_ones() -> None:
    cases = np.array(
        [[5.0, 5.0, 5.0, 0, 0, 0], [0.0] * 6, [1.0, 1.0, 4.0, 1e-9, 0, 0], [2.0, 3.0, -1.0, 0.5, -4.0, 2.0]]
    )
    np.testing.assert_allclose(principal_stresses(cases), np.linalg.eigvalsh(tensors(cases))[:, ::-1], atol=1e-7)


def test_another_shape_is_rejected() -> None:
    for shape in ((3, 6), (3, 5, 3), (3, 6, 4)):
        with rejects(InputError, "coefficients"):
            stress_cycle(np.zeros(shape))
