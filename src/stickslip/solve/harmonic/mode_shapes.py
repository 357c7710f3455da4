"""Shapes of a nonlinear mode beside those of the linear modes: which mode it is, and where its shape is exchanged.

The modal assurance criterion (MAC) contains the mass, so it is 0 between different linear modes and 1 between equal
shapes: ``|a^H M b|^2 / (a^H M a  b^H M b)``.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from stickslip.contact.law.contact_pairs import ContactPairs
from stickslip.contact.law.law import CodeArray, ContactState
from stickslip.core.validation import FloatArray
from stickslip.solve.harmonic.balance import Trial
from stickslip.solve.harmonic.compliance import StuckStructure
from stickslip.solve.harmonic.gain import ComplexArray, to_complex
from stickslip.solve.harmonic.linear import LinearLimit
from stickslip.structure.superelement import Superelement

# chosen: linear modes that are compared with the nonlinear one, and so many above it.
LISTED_MODES, MODES_ABOVE = 12, 3
# chosen: places that a warning lists.
LISTED_TURNS = 4
# chosen: the usual limit of modal correlation, below which two shapes count as different.
LEAST_MAC = 0.9
# chosen: a branch begins at its linear mode if its first point has this frequency, and this MAC at least.
START_FREQUENCY, START_MAC = 0.01, 0.98


def sliding_stiffness(pairs: ContactPairs) -> FloatArray:
    """(3 * n_pairs,) N/m, the springs of the pairs that are closed at rest, without those along which friction acts."""
    return np.asarray(pairs.resting_stiffness() * ~pairs.frictional().ravel())


def sliding_limit(superelement: Superelement, pairs: ContactPairs, damping: FloatArray) -> LinearLimit:
    """The structure with the pairs that are closed at rest in contact without friction."""
    springs, operator = sliding_stiffness(pairs), pairs.operator
    stiffness = superelement.stiffness + operator.T @ (springs[:, None] * operator)
    return LinearLimit.of_matrices(superelement.mass, stiffness, damping)


@dataclass(frozen=True)
class ShapesOfMode:
    """MACs of the first harmonics of points."""

    stuck: FloatArray  # (n_points, n_modes)
    sliding: FloatArray  # (n_points, n_modes)
    step: FloatArray  # (n_points,), against the point before; 1 at the first


def first_harmonic(trial: Trial) -> ComplexArray:
    """(n,) complex amplitudes ``c - i s`` of the stuck modes."""
    return np.asarray(to_complex(trial.amplitude[:2])[0])


def shapes_of(
    trials: Sequence[Trial], superelement: Superelement, stuck: StuckStructure, sliding: LinearLimit, listed: int
) -> ShapesOfMode:
    """The MACs with the ``listed`` lowest linear modes of both limits; bodies that move freely are no modes."""
    motions = np.array([first_harmonic(trial) for trial in trials])
    motions /= np.linalg.norm(motions, axis=1)[:, None]
    in_stuck_modes = stuck.modes.T @ superelement.mass @ sliding.modes[:, ~sliding.rigid][:, :listed]
    step = np.abs((motions[1:] * motions[:-1].conj()).sum(axis=1)) ** 2
    return ShapesOfMode(
        np.abs(motions[:, :listed]) ** 2, np.abs(motions @ in_stuck_modes) ** 2, np.concatenate([[1.0], step])
    )


def exchange_warnings(
    macs: FloatArray, frequency_hz: FloatArray, linear_hz: FloatArray, mode: int, limit: str
) -> Iterator[str]:
    """A warning at each point from which on the shape is closest to another linear mode of the ``limit``.

    ``macs`` (n_points, n_modes) are those with the modes of this limit; ``mode`` is the number of the mode from 1.
    """
    closest = macs.argmax(axis=1) + 1
    changes = np.flatnonzero(np.diff(closest, prepend=mode))
    for point in changes:
        number = int(closest[point])
        before = mode if point == 0 else int(closest[point - 1])
        yield (
            f"The mode exchanges its shape: at {frequency_hz[point]:.2f} Hz it is closer to the linear {limit} mode "
            f"{number} ({linear_hz[number - 1]:.2f} Hz, MAC {macs[point, number - 1]:.2f}) than to mode {before} "
            f"(MAC {macs[point, before - 1]:.2f})."
        )


def start_warnings(
    mac: float, frequency_hz: float, linear_hz: float, amplitude: float, states: CodeArray, mode: int, limit: str
) -> Iterator[str]:
    """A warning where the first point of a branch is not close to its linear mode, with the reason.

    ``mac`` is that of the point with this mode, ``amplitude`` its modal amplitude, ``states`` (n_pairs,) its codes.
    """
    change = frequency_hz / linear_hz - 1.0
    if abs(change) <= START_FREQUENCY and mac >= START_MAC:
        return
    moving = int((states != ContactState.STUCK).sum())
    reason = "its pairs still stick for a part of the cycle, or separate, there. Give a larger largest amplitude"
    if limit == "stuck":
        reason = f"{moving} of {states.size} pairs slip or separate there. Give a smaller smallest amplitude"
        if not moving:
            reason = "no pair slips there, so the branch is that of another mode. Give another mode"
    yield (
        f"The mode does not begin at the linear {limit} mode {mode} of {linear_hz:.2f} Hz: at {amplitude:.3g} m kg^0.5 "
        f"it has {frequency_hz:.2f} Hz ({100 * change:+.2g} %) and a MAC of {mac:.2f} (required: within "
        f"{100 * START_FREQUENCY:g} % and {START_MAC:g}); {reason}."
    )


def step_warnings(step: FloatArray, frequency_hz: FloatArray, amplitude: FloatArray) -> Iterator[str]:
    """A warning where the shape changes much from one point to the next: the mode may have changed between them."""
    worst = int(step.argmin())
    if step[worst] >= LEAST_MAC:
        return
    yield (
        f"From {frequency_hz[worst - 1]:.2f} to {frequency_hz[worst]:.2f} Hz (modal amplitude {amplitude[worst]:.3g} m "
        f"kg^0.5) the shape changes in one step, with a MAC of {step[worst]:.2f} (required: {LEAST_MAC:g}): the points "
        "may belong to different modes. Give a smaller largest_step in continuation."
    )


def fold_warnings(amplitude: FloatArray) -> Iterator[str]:
    """A warning where the branch turns back in amplitude, so that several modes exist at one amplitude."""
    steps = np.diff(amplitude)
    turns = amplitude[1:-1][steps[:-1] * steps[1:] < 0.0]
    if turns.size:
        places = ", ".join([f"{turn:.3g}" for turn in turns[:LISTED_TURNS]] + ["..."] * (turns.size > LISTED_TURNS))
        yield (
            f"The mode turns back in amplitude ({places} m kg^0.5): beside these points several modes exist at one "
            "amplitude."
        )
