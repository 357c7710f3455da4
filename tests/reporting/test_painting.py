"""Which sides are seen and in what order they are painted, where closed forms tell."""

import numpy as np
import pytest

from sketches import ABOVE, BOX_SIDES, FRONT, RIGHT, box
from stickslip.reporting.painting import PIXEL, paint, signed_areas
from stickslip.reporting.sketch_view import Camera, Window

CAMERA = Camera.at(-60.0, 30.0)


def seen(*boxes: np.ndarray, scale: float = 150.0) -> tuple[np.ndarray, np.ndarray]:
    """Places in px and sides of boxes around the origin, in a view of 400 x 400 px."""
    window = Window(CAMERA, np.zeros(2), scale, 400, 400)
    sides = np.vstack([BOX_SIDES + 8 * number for number in range(len(boxes))])
    return window.places(np.vstack(boxes)), sides


def order_of(*boxes: np.ndarray, opaque: np.ndarray | None = None, scale: float = 150.0) -> list[int]:
    places, sides = seen(*boxes, scale=scale)
    solid = np.ones(len(sides), dtype=bool) if opaque is None else opaque
    return paint(places, sides, solid, 400, 400).order.tolist()


def test_of_a_cube_three_sides_are_drawn() -> None:
    assert sorted(order_of(box((-0.5, -0.5, -0.5), (0.5, 0.5, 0.5)))) == sorted([ABOVE, FRONT, RIGHT])


def test_area_in_the_view_is_that_of_the_side_times_the_cosine() -> None:
    places, sides = seen(box((-0.5, -0.5, -0.5), (0.5, 0.5, 0.5)))
    normals = np.array([[0, 0, -1], [0, 0, 1], [0, -1, 0], [1, 0, 0], [0, 1, 0], [-1, 0, 0]])
    assert signed_areas(places, sides) == pytest.approx(150.0**2 * normals @ CAMERA.axes[2])


def test_covered_pixels_are_the_outline_of_the_cube() -> None:
    places, sides = seen(box((-0.5, -0.5, -0.5), (0.5, 0.5, 0.5)))
    covered = paint(places, sides, np.ones(6, dtype=bool), 400, 400).covered
    assert covered.sum() * PIXEL**2 == pytest.approx(signed_areas(places, sides).clip(0.0).sum(), rel=0.01)


def test_a_hidden_body_is_not_drawn_and_shows_through_glass() -> None:
    inner, outer = box((-0.2, -0.2, -0.2), (0.2, 0.2, 0.2)), box((-0.5, -0.5, -0.5), (0.5, 0.5, 0.5))
    assert sorted(order_of(inner, outer)) == [6 + ABOVE, 6 + FRONT, 6 + RIGHT]
    glass = np.repeat([True, False], 6)
    order = order_of(inner, outer, opaque=glass)
    assert set(order) == {ABOVE, FRONT, RIGHT, 6 + ABOVE, 6 + FRONT, 6 + RIGHT}
    # the glass is painted over what is behind it
    assert max(map(order.index, (ABOVE, FRONT, RIGHT))) < min(order.index(6 + side) for side in (ABOVE, FRONT, RIGHT))


def test_a_long_side_does_not_hide_a_short_one_before_it() -> None:
    """The middle of the floor is nearer to the eye than the post that stands on its far end."""
    floor = box((-0.3, -4.0, -0.5), (0.3, 1.0, -0.45))
    post = box((-0.1, 0.6, -0.45), (0.1, 0.8, 0.0))
    places, sides = seen(floor, post, scale=80.0)
    depth = places[sides][:, :, 2].mean(axis=1)
    assert depth[ABOVE] > depth[6 + FRONT]  # sorting by the middle would fail
    order = order_of(floor, post, scale=80.0)
    assert order.index(ABOVE) < min(order.index(6 + side) for side in (FRONT, RIGHT))


def test_at_every_pixel_the_nearest_side_is_painted_last() -> None:
    """Boxes at random, which do not overlap: what is painted is what a ray meets first."""
    rng = np.random.default_rng(7)
    grid = np.stack(np.meshgrid(*[np.arange(4)] * 3, indexing="ij"), axis=-1).reshape(-1, 3) - 2.0
    low = grid + rng.uniform(0.0, 0.4, grid.shape)
    boxes = [box(tuple(a), tuple(b)) for a, b in zip(low, low + rng.uniform(0.1, 0.6, grid.shape), strict=True)]
    places, sides = seen(*boxes, scale=55.0)
    order = paint(places, sides, np.ones(len(sides), dtype=bool), 400, 400).order
    x, y = (axis.ravel() + 0.37 for axis in np.meshgrid(np.arange(0, 400, 4.0), np.arange(0, 400, 4.0)))
    front, nearest, painted = np.full(x.size, -1), np.full(x.size, -np.inf), np.full(x.size, -1)
    rank = {side: position for position, side in enumerate(order.tolist())}
    for side in np.flatnonzero(signed_areas(places, sides) > 0.0):
        corner = places[sides[side]]
        axes = np.stack([corner[1, :2] - corner[0, :2], corner[3, :2] - corner[0, :2]], axis=1)
        share = np.linalg.solve(axes, np.stack([x, y]) - corner[0, :2, None])
        inside = ((share > 0.0) & (share < 1.0)).all(axis=0)
        depth = corner[0, 2] + share[0] * (corner[1] - corner[0])[2] + share[1] * (corner[3] - corner[0])[2]
        better = inside & (depth > nearest)
        front[better], nearest[better] = side, depth[better]
        over = inside & (np.array([rank.get(old, -1) for old in painted]) < rank.get(int(side), -1))
        painted[over] = side
    assert (front >= 0).sum() > 1000
    wrong = (front != painted).mean()
    assert wrong < 0.001  # slivers between two pixels


def test_sides_that_hide_each_other_in_a_circle_are_all_painted() -> None:
    """Three bars, each over the next: no order is right, and none is lost."""
    bars = []
    for number in range(3):
        turn = 2.0 * np.pi * number / 3.0
        rotation = np.array([[np.cos(turn), -np.sin(turn)], [np.sin(turn), np.cos(turn)]])
        flat = np.array([[-60.0, 20.0], [90.0, 20.0], [90.0, 45.0], [-60.0, 45.0]]) @ rotation.T
        depth = np.array([-20.0, 20.0, 20.0, -20.0])
        bars.append(np.column_stack([200.0 + flat[:, 0], 200.0 - flat[:, 1], depth]))
    sides = np.arange(12).reshape(3, 4)
    assert sorted(paint(np.vstack(bars), sides, np.ones(3, dtype=bool), 400, 400).order.tolist()) == [0, 1, 2]


def test_what_lies_outside_of_the_view_is_left_out() -> None:
    assert order_of(box((9.0, 9.0, 9.0), (9.5, 9.5, 9.5))) == []
