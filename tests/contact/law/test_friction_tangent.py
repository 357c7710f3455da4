"""The tangent of the periodic state against central differences, regime by regime and over random pairs."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest
from friction_cases import kept_case, make_pairs, random_case, sampled

from stickslip.contact.law.contact_pairs import ContactPairs
from stickslip.contact.law.coulomb import CoulombLaw
from stickslip.contact.law.coulomb_harmonics import Update, contact_cycle, harmonic_force, harmonic_tangent
from stickslip.core.threads import solver_threads
from stickslip.core.validation import FloatArray

SAMPLES = 64
# Round-off of the state after C cycles is some 1e-12 of the force, so steps are not shorter than this; the tangent is
# that of the last cycle, 1/C from the period after it.
STEP, TOLERANCE = 1e-5, 3e-6
UPDATES: list[Update] = ["tractrix", "radial"]


def coefficients(**entries: list[float]) -> FloatArray:
    """(1, 3, 7) from lists for t1, t2, n; the rest is zero."""
    array = np.zeros((1, 3, 7))
    for row, name in enumerate(("t1", "t2", "n")):
        values = entries.get(name, [])
        array[0, row, : len(values)] = values
    return array


def differences(x: FloatArray, pairs: ContactPairs, update: Update, step: float) -> FloatArray:
    """Central differences of harmonic_force, all pairs at once."""
    n_pairs, rows, width = x.shape
    tangent = np.zeros((n_pairs, rows, width, rows, width))
    for b in range(rows):
        for q in range(width):
            shift = np.zeros_like(x)
            shift[:, b, q] = step
            plus, minus = (harmonic_force(x + s * shift, pairs, SAMPLES, update).force for s in (1.0, -1.0))
            tangent[:, :, :, b, q] = (plus - minus) / (2.0 * step)
    return tangent


def relative(first: FloatArray, second: FloatArray, scale: FloatArray) -> FloatArray:
    error: FloatArray = np.abs(first - second).max(axis=(1, 2, 3, 4)) / scale
    return error


def assert_close(errors: FloatArray) -> None:
    """All but few: a sample within 1/C of a switch may be beyond it in the last cycle and before it in the period."""
    assert np.quantile(errors, 0.99) < TOLERANCE
    assert errors.max() < 1e-3


# name: (coefficients, keyword arguments of the pair, state, deviates)
REGIMES: dict[str, tuple[FloatArray, dict[str, object], int, bool]] = {
    "stuck": (coefficients(t1=[0.2, 0.1, 0.05], t2=[0.0, 0.02], n=[0.1, 0.3]), {}, 0, False),
    "stick-slip, one direction": (coefficients(t1=[0.3, 1.1, 0.13, 0.05]), {}, 1, True),
    "stick-slip, two directions": (
        coefficients(t1=[0.0, 0.9, 0.1, 0.05], t2=[0.4, 0.2, 0.3, 0.0, 0.1], n=[0.1, 0.5, 0.61]), {}, 1, True,
    ),
    "always slipping": (coefficients(t1=[0.0, 1.1, 0.02], t2=[0.0, 0.0, 1.1], n=[0.0, 0.1]), {}, 1, True),
    "shakedown, one-sided slip": (
        coefficients(t1=[0.1, 0.2, 0.01, 0.1], t2=[0.0, 0.02, 0.03], n=[0.0, -0.21, 0.1]), {}, 0, True,
    ),
    "shakedown from the start": (coefficients(t1=[0.0, 0.25, 0.02], n=[0.0, -0.3, 0.1]), {}, 0, True),
    "microslip": (coefficients(t1=[0.0, 0.28, 0.01], t2=[0.0, 0.03, 0.04], n=[0.0, 0.02, 0.07]), {}, 1, True),
    "slip, separation, touchdown": (
        coefficients(t1=[0.0, 1.1, 0.1], t2=[0.1, 0.0, 0.4, 0.1], n=[0.0, 2.2, 1.1]), {}, 2, True,
    ),
    "stick after touchdown": (coefficients(t1=[0.0, 0.06, 0.03], t2=[0.0, 0.01], n=[0.0, 2.2, 1.3]), {}, 2, True),
    "gap at rest": (
        coefficients(t1=[0.0, 0.8, 0.1], t2=[0.0, 0.1, 0.3], n=[0.13, 2.2, 0.4]), {"preload": -0.5}, 2, True,
    ),
    "mostly open": (
        coefficients(t1=[0.0, 0.8, 0.1], t2=[0.0, 0.1, 0.3], n=[0.0, 2.2, 0.4]), {"preload": -2.0}, 2, True,
    ),
    "always open": (coefficients(t1=[0.0, 0.8, 0.1], n=[0.0, 1.0]), {"preload": -2.0}, 2, False),
    "unequal stiffness, slip": (
        coefficients(t1=[0.0, 0.9, 0.1], t2=[0.0, 0.2, 0.7], n=[0.1, 0.5, 0.6]),
        {"tangential_stiffness": np.array([[3.0, 1.3]])}, 1, True,
    ),
    "unequal stiffness, separation": (
        coefficients(t1=[0.0, 0.9, 0.1], t2=[0.0, 0.2, 0.7], n=[0.1, 2.5, 0.6]),
        {"tangential_stiffness": np.array([[1.0, 4.0]])}, 2, True,
    ),
    "unequal stiffness, shakedown": (
        coefficients(t1=[0.1, 0.2, 0.01, 0.1], t2=[0.0, 0.02, 0.03], n=[0.0, -0.21, 0.1]),
        {"tangential_stiffness": np.array([[3.0, 2.0]])}, 0, True,
    ),
}  # fmt: skip


@pytest.mark.slow
@pytest.mark.parametrize("update", UPDATES)
@pytest.mark.parametrize("name", REGIMES)
def test_tangent_of_each_regime(name: str, update: Update) -> None:
    x, constants, state, deviates = REGIMES[name]
    pairs = make_pairs(1, **constants)  # type: ignore[arg-type]
    actual = harmonic_force(x, pairs, SAMPLES, update)
    assert (actual.state[0], actual.deviates[0]) == (state, deviates)
    tangent = harmonic_tangent(x, pairs, SAMPLES, [0], update)
    expected = differences(x, pairs, update, STEP)
    scale = np.abs(expected).max() + np.full(1, 1e-300)
    assert relative(tangent, expected, scale)[0] < TOLERANCE


@pytest.mark.parametrize("case", [random_case, kept_case])
def test_a_pair_has_the_same_digits_beside_others_and_in_threads(
    case: Callable[[int, int], tuple[FloatArray, ContactPairs]],
) -> None:
    x, pairs = case(3, 60)
    force, select = harmonic_force(x, pairs, SAMPLES), np.arange(60)
    tangent = harmonic_tangent(x, pairs, SAMPLES, select)
    with solver_threads(3):
        for _ in range(5):
            again = harmonic_force(x, pairs, SAMPLES)
            for name, array in vars(force).items():
                np.testing.assert_array_equal(getattr(again, name), array)
            np.testing.assert_array_equal(harmonic_tangent(x, pairs, SAMPLES, select), tangent)
    some = np.isin(select, [5, 31, 44])
    law = pairs.laws[0]
    assert isinstance(law, CoulombLaw)
    alone = law.subset(some)
    np.testing.assert_array_equal(harmonic_force(x[some], alone, SAMPLES).force, force.force[some])
    np.testing.assert_array_equal(harmonic_tangent(x[some], alone, SAMPLES, np.arange(3)), tangent[some])


@pytest.mark.slow
@pytest.mark.parametrize("update", UPDATES)
@pytest.mark.parametrize("seed", [1, 2])
def test_tangent_of_random_pairs(seed: int, update: Update) -> None:
    """Pairs whose two differences disagree have a sample on a switch within the step and are left out, not many."""
    x, pairs = random_case(seed, 250)
    tangent = harmonic_tangent(x, pairs, SAMPLES, np.arange(250), update)
    scale = np.maximum(np.abs(tangent).max(axis=(1, 2, 3, 4)), 1e-300)
    first, second = differences(x, pairs, update, STEP), differences(x, pairs, update, 2.3 * STEP)
    smooth = relative(first, second, scale) < TOLERANCE
    assert smooth.mean() > 0.9
    assert_close(relative(tangent, first, scale)[smooth])


def lifting_off(seed: int, springs: float, along: float) -> tuple[FloatArray, ContactPairs]:
    """Pairs that stick at the last sample before they lift off, with the motion across t1 times ``along``.

    ``springs``: ratio of the tangential springs. Some of them touch down into stick, others into slip.
    """
    random, count = np.random.default_rng(seed), 400
    x = random.normal(size=(count, 3, 7)) / np.array([1.0, 1.0, 1.0, 2.0, 2.0, 3.0, 3.0])
    x[:, :2] *= 10.0 ** random.uniform(-1.5, 0.3, (count, 1, 1))
    x[:, 1] *= along
    x[:, 2] *= random.uniform(1.0, 4.0, (count, 1))
    spring = random.uniform(0.5, 3.0, count)
    friction, preload = random.uniform(0.1, 4.0, count), random.uniform(-1.0, 3.0, count)
    constants = np.full(count, 1.5), np.column_stack([spring, springs * spring]), friction, preload
    force = contact_cycle(sampled(x, SAMPLES), make_pairs(count, *constants)).force
    inside = np.hypot(force[..., 0], force[..., 1]) < 0.999 * friction * force[..., 2]
    chosen = (inside & (np.roll(force[..., 2], -1, axis=0) == 0.0)).any(axis=0)
    assert chosen.sum() > 100
    return x[chosen], make_pairs(int(chosen.sum()), *(value[chosen] for value in constants))


def changed(pairs: ContactPairs, name: str, factor: float) -> ContactPairs:
    """The pairs with one constant times ``factor``."""
    names = ("normal_stiffness", "tangential_stiffness", "friction_coefficient", "preload")
    values = {each: getattr(pairs, each) for each in names}
    return make_pairs(pairs.n_pairs, **values | {name: factor * values[name]})


@pytest.mark.slow
@pytest.mark.parametrize("update", UPDATES)
@pytest.mark.parametrize(("springs", "along"), [(1.0, 0.0), (1.0, 1.0), (0.4, 1.0)])
def test_tangent_of_pairs_that_stick_until_they_lift_off(springs: float, along: float, update: Update) -> None:
    """Along a random motion, and by the constants: the law depends on K s, mu N0 and mu kn n alone."""
    x, pairs = lifting_off(7, springs, along)
    tangent = harmonic_tangent(x, pairs, SAMPLES, np.arange(pairs.n_pairs), update)[:, :2]
    scale = np.abs(tangent).max(axis=(1, 2, 3, 4)) * np.abs(x).max(axis=(1, 2))

    def checked(work: FloatArray, forces: Callable[[float], FloatArray]) -> None:
        first, second = ((forces(step) - forces(-step)) / (2.0 * step) for step in (1e-6, 2.3e-6))
        smooth = np.abs(first - second).max(axis=(1, 2)) < TOLERANCE * scale
        assert smooth.mean() > 0.98
        assert (np.abs(work - first).max(axis=(1, 2)) / scale)[smooth].max() < TOLERANCE

    way = np.random.default_rng(8).normal(size=x.shape) * np.abs(x).max(axis=(1, 2))[:, None, None]
    way[:, 1] *= along

    def moved(step: float) -> FloatArray:
        return harmonic_force(x + step * way, pairs, SAMPLES, update).force[:, :2]

    checked(np.einsum("iapbq,ibq->iap", tangent, way), moved)
    by_tangential = np.einsum("iapbq,ibq->iap", tangent[:, :, :, :2], x[:, :2])
    by_normal = np.einsum("iapq,iq->iap", tangent[:, :, :, 2], x[:, 2])
    by_preload = tangent[:, :, :, 2, 0] * (pairs.preload / pairs.normal_stiffness)[:, None, None]
    for name, work in {
        "tangential_stiffness": by_tangential,
        "normal_stiffness": by_normal,
        "preload": by_preload,
        "friction_coefficient": by_normal + by_preload,
    }.items():

        def by_constant(step: float, name: str = name) -> FloatArray:
            return harmonic_force(x, changed(pairs, name, 1.0 + step), SAMPLES, update).force[:, :2]

        checked(work, by_constant)


@pytest.mark.slow
@pytest.mark.parametrize("seed", [3, 4])
def test_tangent_with_residual_traction(seed: int) -> None:
    """The mean tangential displacement counts where the start is remembered: stuck and shaken-down pairs."""
    x, pairs = kept_case(seed, 250)
    tangent = harmonic_tangent(x, pairs, SAMPLES, np.arange(250))
    scale = np.maximum(np.abs(tangent).max(axis=(1, 2, 3, 4)), 1e-300)
    first = differences(x, pairs, "tractrix", STEP)
    smooth = relative(first, differences(x, pairs, "tractrix", 2.3 * STEP), scale) < TOLERANCE
    assert smooth.mean() > 0.85  # 0.89 to 0.92: the walk of a cycle decides at more samples whether they slip
    assert relative(tangent, first, scale)[smooth].max() < 2 * TOLERANCE
    by_mean = np.abs(tangent[:, :2, :, :2, 0]).max(axis=(1, 2, 3))
    stuck = ~harmonic_force(x, pairs, SAMPLES).deviates & pairs.closed_at_rest
    assert stuck.sum() > 10
    np.testing.assert_allclose(by_mean[stuck], pairs.tangential_springs[stuck].max(axis=1))
    assert (by_mean[~stuck] > 1e-3 * scale[~stuck]).any()  # shaken down: the mean is remembered


def test_tangent_of_selected_pairs() -> None:
    x, pairs = random_case(3, 20)
    everything = harmonic_tangent(x, pairs, SAMPLES, np.arange(20))
    mask = np.zeros(20, dtype=bool)
    mask[[4, 11]] = True
    np.testing.assert_array_equal(harmonic_tangent(x, pairs, SAMPLES, [4, 11]), everything[[4, 11]])
    np.testing.assert_array_equal(harmonic_tangent(x, pairs, SAMPLES, mask), everything[[4, 11]])
    assert harmonic_tangent(x, pairs, SAMPLES, np.zeros(20, dtype=bool)).shape == (0, 3, 7, 3, 7)


def test_stuck_tangent_is_the_springs() -> None:
    x, constants, _, _ = REGIMES["stuck"]
    tangent = harmonic_tangent(x, make_pairs(1, **constants), SAMPLES, [0])[0]  # type: ignore[arg-type]
    expected = np.zeros((3, 7, 3, 7))
    for row, spring in enumerate((3.0, 3.0, 1.0)):
        expected[row, :, row, :] = spring * np.eye(7)
    expected[0, 0, 0, 0] = expected[1, 0, 1, 0] = 0.0  # the slider follows the mean
    np.testing.assert_allclose(tangent, expected, atol=1e-14)
