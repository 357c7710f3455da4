import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from stickslip.contact.pairing.clipping import clip, corner_weights
from stickslip.core.validation import FloatArray

SQUARE = np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]])
TRIANGLE = np.array([[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [0.0, 1.0]])


def area(polygon: FloatArray) -> float:
    x, y = polygon.T
    return 0.5 * float(x @ np.roll(y, -1) - y @ np.roll(x, -1))


def clipped(subject: FloatArray, window: FloatArray) -> FloatArray:
    polygon, count = clip(np.asarray(subject)[None], np.asarray(window)[None])
    return polygon[0, : count[0]]


@pytest.mark.parametrize(
    ("window", "corners", "expected"),
    [
        (SQUARE, 4, 1.0),
        (SQUARE + 0.25, 4, 0.5625),
        (0.5 * SQUARE + 0.25, 4, 0.25),
        (3.0 * SQUARE - 1.0, 4, 1.0),
        (TRIANGLE, 3, 0.5),
        (2.0 * TRIANGLE - 0.25, 5, 1.0 - 0.5 * 0.5**2),
        (SQUARE + np.array([1.0, 0.0]), 0, 0.0),
        (SQUARE + np.array([2.0, 0.0]), 0, 0.0),
        (SQUARE + np.array([1.0, 1.0]), 0, 0.0),
    ],
)
def test_known_overlaps(window: FloatArray, corners: int, expected: float) -> None:
    actual = clipped(SQUARE, window)
    assert len(actual) == corners
    if corners:
        assert area(actual) == pytest.approx(expected)


@pytest.mark.slow
@settings(max_examples=60, deadline=None)
@given(shift=st.tuples(st.floats(-1.5, 1.5), st.floats(-1.5, 1.5)), angle=st.floats(0.0, 6.3), size=st.floats(0.2, 2.0))
def test_the_parts_in_four_quadrants_add_up(shift: tuple[float, float], angle: float, size: float) -> None:
    turn = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
    subject = (SQUARE - 0.5) * size @ turn.T + shift
    quadrants = [10.0 * (SQUARE - [1.0 - i, 1.0 - j]) for i in (0, 1) for j in (0, 1)]
    polygon, count = clip(np.repeat(subject[None], 4, axis=0), np.array(quadrants))
    parts = [area(corners[:used]) if used else 0.0 for corners, used in zip(polygon, count, strict=True)]
    assert min(parts) >= 0.0
    assert sum(parts) == pytest.approx(size**2, rel=1e-8)


@pytest.mark.parametrize("corners", [SQUARE, TRIANGLE, np.array([[0.0, 0.0], [2.0, 0.2], [1.5, 1.4], [-0.3, 1.0]])])
def test_corner_weights_make_the_points(corners: FloatArray) -> None:
    share = np.random.default_rng(3).dirichlet(np.ones(4), 6)
    points = share @ corners
    weights = corner_weights(corners[None], points[None])[0]
    np.testing.assert_allclose(weights @ corners, points, atol=1e-14)
    np.testing.assert_allclose(weights.sum(axis=1), 1.0)
    assert weights.min() > -1e-12
