"""Linear limits against direct solves, with damping that couples the modes."""

from __future__ import annotations

import numpy as np

from helpers import Blade
from stickslip.solve.harmonic.damping import modal_basis
from stickslip.solve.harmonic.gain import to_complex
from stickslip.solve.harmonic.linear import LinearLimit


def test_response_equals_direct_solves(blade: Blade) -> None:
    mass, stiffness = blade.superelement.mass, blade.superelement.stiffness
    for dashpot in (0.0, 0.5, 500.0):  # the largest makes the iteration fail, so the full system is solved
        assert blade.superelement.damping is not None
        damping = blade.superelement.damping.copy()
        damping[2, 2] += dashpot
        limit = LinearLimit.of_matrices(mass, stiffness, damping)
        force = np.zeros((5, mass.shape[0]))
        force[1], force[2], force[4] = blade.force_cos, blade.force_sin, blade.force_cos
        omega = 2 * np.pi * np.array([470.0, blade.free_hz, 1040.0])
        actual = limit.response(omega, force)
        for k, w in enumerate(omega):
            for order in (1, 2):
                x = order * w
                expected = np.linalg.solve(stiffness - x**2 * mass + 1j * x * damping, to_complex(force[1:])[order - 1])
                got = actual[k, :, 2 * order - 1] - 1j * actual[k, :, 2 * order]
                assert np.abs(got - expected).max() < 1e-8 * np.abs(expected).max()


def test_the_root_of_the_damping_gives_the_limit_of_the_damping(blade: Blade) -> None:
    mass, stiffness = blade.superelement.mass, blade.superelement.stiffness
    root = np.random.default_rng(0).standard_normal((len(mass), 3))
    expected = LinearLimit.of_matrices(mass, stiffness, root @ root.T)
    limit = LinearLimit.undamped(*modal_basis(mass, stiffness), stiffness).with_damping_root(root)
    force = np.zeros((3, len(mass)))
    force[1], force[2] = blade.force_cos, blade.force_sin
    omega = 2 * np.pi * np.array([470.0, 1040.0])
    answer = expected.response(omega, force)
    np.testing.assert_allclose(limit.response(omega, force), answer, rtol=0.0, atol=1e-9 * np.abs(answer).max())
    np.testing.assert_array_equal(limit.rigid, expected.rigid)
    np.testing.assert_allclose(limit.resonant.half_power_width, expected.resonant.half_power_width, rtol=1e-9)


def test_frequencies_below_one_hertz_are_those_of_a_structure_and_free_bodies_have_none() -> None:
    """Everything below 1 Hz was left out as a body that moves freely."""
    soft = np.array([[2.0, -1.0, 0.0], [-1.0, 1.0, 0.0], [0.0, 0.0, 0.0]])  # two masses on springs and a free one
    limit = LinearLimit.of_matrices(np.eye(3), soft, np.zeros((3, 3)))
    np.testing.assert_array_equal(limit.rigid, [True, False, False])
    np.testing.assert_allclose(limit.natural_hz[~limit.rigid], [0.0984, 0.2575], atol=1e-4)
