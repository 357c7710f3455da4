"""The linear mode from which a nonlinear one starts."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal, get_args

import numpy as np

from stickslip.contact.law.contact_pairs import ContactPairs
from stickslip.core.errors import InputError
from stickslip.core.validation import FloatArray, finite_array, require_choice, whole_number
from stickslip.solve.harmonic.compliance import require_one_size
from stickslip.solve.harmonic.damping import stuck_stiffness_matrix
from stickslip.solve.harmonic.linear import LinearLimit
from stickslip.solve.harmonic.mode_shapes import sliding_limit
from stickslip.structure.superelement import Superelement, require_no_gyroscopic

Limit = Literal["stuck", "sliding"]

# chosen: relative distance of two natural frequencies that is round-off of the matrices.
EQUAL_FREQUENCIES = 1e-9


def checked_amplitudes(amplitude: tuple[float, float]) -> tuple[float, float]:
    """(lowest, highest) modal amplitude. Raises InputError unless both are above zero and rise."""
    values = finite_array("amplitude", amplitude)
    if values.shape != (2,) or not 0.0 < values[0] < values[1]:
        raise InputError(
            f"amplitude is {amplitude}, but it must be (lowest, highest): two modal amplitudes in m kg^0.5 above 0, "
            "the second above the first.",
            arguments=["amplitude"],
        )
    return float(values[0]), float(values[1])


def require_allowed_amplitude(
    pairs: ContactPairs, start: LinearMode, highest: float, shown: float | None = None
) -> None:
    """Raise InputError if a law has no restoring force at the ``highest`` modal amplitude, in the shape of the linear
    mode; ``shown`` is the amplitude of the first output, m, for a modal amplitude of 1, which the message then has."""
    motion = highest * np.abs(pairs.operator @ start.shape).reshape(-1, 3)
    ratio = motion / np.maximum(pairs.largest_motion, np.finfo(float).tiny)
    pair, axis = (int(place) for place in np.unravel_index(ratio.argmax(), ratio.shape))
    if ratio[pair, axis] > 1.0:
        unit, scale = ("m kg^0.5", 1.0) if shown is None else ("m of the first output", shown)
        raise InputError(
            f"at the largest amplitude of the mode, {scale * highest:.4g} {unit}, pair {pair} moves by "
            f"{1e6 * motion[pair, axis]:.4g} um, but its softening law resists only up to "
            f"{1e6 * pairs.largest_motion[pair, axis]:.4g} um. Use at most "
            f"{scale * highest / ratio[pair, axis]:.4g} {unit}.",
            arguments=["amplitude"],
        )


@dataclass(frozen=True)
class LinearMode:
    """The linear mode from which a branch starts.

    omega, shape, motion:
        its circular frequency, rad/s, its mass-normalised shape (n,), and the modal amplitudes (n,) of the stuck modes
        in it, of norm 1.
    load_mode, load_shape:
        index and shape (n,) of the stuck mode whose inertia is the load (:mod:`stickslip.solve.harmonic.mode_curve`).
    """

    number: int
    limit: Limit
    omega: float
    shape: FloatArray
    motion: FloatArray
    load_mode: int
    load_shape: FloatArray

    @classmethod
    def of(
        cls,
        superelement: Superelement,
        pairs: ContactPairs,
        number: int,
        limit: Limit,
        stuck: LinearLimit | None = None,
    ) -> LinearMode:
        """The mode with a ``number`` in a linear limit; ``stuck`` may be the stuck limit. Raises InputError."""
        require_choice("limit", limit, get_args(Limit))
        whole_number("mode", number, 1)
        require_one_size(superelement, pairs)
        require_no_gyroscopic(superelement, "a mode")
        undamped = np.zeros_like(superelement.mass)
        if stuck is None:
            stuck = LinearLimit.of_matrices(superelement.mass, stuck_stiffness_matrix(superelement, pairs), undamped)
        chosen = stuck if limit == "stuck" else sliding_limit(superelement, pairs, undamped)
        moving = np.flatnonzero(~chosen.rigid)
        if number > moving.size:
            raise InputError(
                f"mode is {number}, but it must be at most {moving.size}, the number of modes of this structure with "
                f"its pairs {limit}.",
                arguments=["mode"],
            )
        index = int(moving[number - 1])
        omega = float(chosen.circular_frequency[index])
        twins = np.abs(chosen.circular_frequency[moving] - omega) <= EQUAL_FREQUENCIES * omega
        if twins.sum() > 1:
            raise InputError(
                f"mode {number} has the same frequency as another mode with the pairs {limit}, "
                f"{omega / (2.0 * np.pi):.3f} Hz, so its shape is not unique. Choose another mode, or remove the "
                "symmetry of the structure.",
                arguments=["mode"],
            )
        shape = chosen.modes[:, index]
        motion = stuck.modes.T @ superelement.mass @ shape
        # The stuck mode that a static load in the shape of the motion would move most.
        flexible = np.where(stuck.rigid, np.inf, stuck.circular_frequency)
        load_mode = int((np.abs(motion) * np.minimum(1.0, (omega / flexible) ** 2)).argmax())
        return cls(number, limit, omega, shape, motion, load_mode, stuck.modes[:, load_mode])
