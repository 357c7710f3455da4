"""Motions and pairs that several friction tests share."""

from __future__ import annotations

import numpy as np

from stickslip.contact.law.contact_pairs import ContactPairs
from stickslip.core.validation import FloatArray


def make_pairs(
    n_pairs: int,
    normal_stiffness: FloatArray | float = 1.0,
    tangential_stiffness: FloatArray | float = 3.0,
    friction_coefficient: FloatArray | float = 0.4,
    preload: FloatArray | float = 2.0,
) -> ContactPairs:
    """Pairs for the friction law alone: the operator is not used there."""
    return ContactPairs(
        np.zeros((3 * n_pairs, 1)), normal_stiffness, tangential_stiffness, friction_coefficient, preload
    )


def random_case(seed: int, n_pairs: int, harmonics: int = 3) -> tuple[FloatArray, ContactPairs]:
    """Coefficients (n_pairs, 3, 2 H + 1) and pairs over all regimes: amplitudes over two decades, gaps, one direction
    only, circles, weak normal motion, equal stiffness in the first half of the pairs and unequal in the second."""
    rng = np.random.default_rng(seed)
    width = 2 * harmonics + 1
    x = rng.normal(size=(n_pairs, 3, width)) * 10.0 ** rng.uniform(-1.5, 0.7, size=(n_pairs, 3, 1))
    x[:, :, 3:] *= 0.3
    spring = 10.0 ** rng.uniform(-0.3, 0.3, size=(n_pairs, 2))
    spring[: n_pairs // 2, 1] = spring[: n_pairs // 2, 0]
    family = rng.integers(0, 8, n_pairs)
    x[family == 1, 2, 1:] = 0.0
    x[family == 2, 1] = 0.0
    x[family == 3, 2, 1:] *= 0.1
    circle = family == 4
    x[circle, :2, 3:], x[circle, 2] = 0.0, 0.0
    x[circle, 1, 1], x[circle, 1, 2] = -x[circle, 0, 2], x[circle, 0, 1]
    preload = rng.normal(size=n_pairs) + 1.0
    return x, make_pairs(n_pairs, 1.0, spring, rng.uniform(0.2, 1.0, n_pairs), preload)


def kept_case(seed: int, n_pairs: int) -> tuple[FloatArray, ContactPairs]:
    """As :func:`random_case`, smaller motions, with a traction at rest inside the limit."""
    x, pairs = random_case(seed, n_pairs)
    rng = np.random.default_rng(seed + 10)
    angle = rng.uniform(0.0, 2.0 * np.pi, n_pairs)
    size = rng.uniform(0.0, 1.0, n_pairs) * pairs.friction_coefficient * pairs.normal_load
    traction = size[:, None] * np.column_stack([np.cos(angle), np.sin(angle)])
    constants = (pairs.normal_stiffness, pairs.tangential_stiffness, pairs.friction_coefficient, pairs.preload)
    return 0.4 * x, ContactPairs(pairs.operator, *constants, traction)


def near_shakedown(seed: int, n_pairs: int, samples: int) -> tuple[FloatArray, ContactPairs]:
    """Closed pairs whose motion just about reaches the limit: the slowest ones to become periodic."""
    from stickslip.core.fourier import synthesis_matrix

    x, pairs = random_case(seed, n_pairs)
    rng = np.random.default_rng(seed + 1)
    synthesis = synthesis_matrix(x.shape[2] // 2, samples)
    normal = x[:, 2] @ synthesis.T
    preload = -normal.min(axis=1) + rng.uniform(0.2, 3.0, n_pairs)
    least = pairs.friction_coefficient * (preload + normal.min(axis=1))
    path = pairs.tangential_springs[:, :, None] * (x[:, :2, 1:] @ synthesis[:, 1:].T)
    x[:, :2] *= (least / np.hypot(path[:, 0], path[:, 1]).max(axis=1) * rng.uniform(0.9, 1.3, n_pairs))[:, None, None]
    return x, make_pairs(n_pairs, 1.0, pairs.tangential_stiffness, pairs.friction_coefficient, preload)


def sampled(coefficients: FloatArray, samples: int) -> FloatArray:
    """(samples, n_pairs, 3) signal of coefficients, by the definition of the series."""
    t = 2.0 * np.pi * np.arange(samples) / samples
    signal = np.zeros((samples, *coefficients.shape[:2])) + coefficients[:, :, 0]
    for k in range(1, coefficients.shape[2] // 2 + 1):
        signal += np.multiply.outer(np.cos(k * t), coefficients[:, :, 2 * k - 1])
        signal += np.multiply.outer(np.sin(k * t), coefficients[:, :, 2 * k])
    return signal
