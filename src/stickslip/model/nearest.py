"""The node nearest to a point of a study file: one rule for every kind of structure."""

from __future__ import annotations

import numpy as np

from stickslip.core.errors import InputError
from stickslip.core.validation import FloatArray

# chosen: largest distance of a point of the study file from the nearest node, as a fraction of the structure's size.
POINT_FRACTION = 0.05
# Two nodes coincide if their distance is below this fraction of the structure's size. Files have coordinates with six
# or more digits, so equal positions differ by less; the smallest elements are far larger.
SAME_PLACE_FRACTION = 1e-6


def nearest_node(positions: FloatArray, point: FloatArray) -> int:
    """Index in ``positions`` (n, 3) m of the node nearest to ``point`` (3,) m.

    Raises InputError if the nearest one is far, and if another node is at its position, as on two sides of a joint.
    """
    distance = np.linalg.norm(positions - point, axis=1)
    size = float(np.linalg.norm(np.ptp(positions, axis=0)))
    nearest = int(distance.argmin())
    x, y, z = 1e3 * positions[nearest]
    if distance[nearest] > POINT_FRACTION * size:
        raise InputError(
            f"the nearest node is {1e3 * distance[nearest]:.4g} mm away, at ({x:.4g}, {y:.4g}, {z:.4g}) "
            f"mm; at most {1e3 * POINT_FRACTION * size:.4g} mm is allowed. Check the point and the unit of length."
        )
    apart = np.linalg.norm(positions - positions[nearest], axis=1)
    apart[nearest] = np.inf
    if apart.min() <= SAME_PLACE_FRACTION * size:
        raise InputError(
            f"two nodes are at ({x:.4g}, {y:.4g}, {z:.4g}) mm, the position nearest to the point, as on both sides of "
            "a joint. Give a set or a node."
        )
    return nearest
