"""Motions that neither damping nor friction bounds: resonances and unsupported motions that the solver must not follow.

A periodic motion at the natural frequency of mode j of the structure without contact needs a balance of the modal
forces there: without damping, the excitation ``F`` equals the first harmonic of the contact forces in the mode. A
tangential force that stays below ``mu N`` has at most ``4/pi mu N`` in one harmonic, that of gross slip (a square
wave). So there is no periodic motion at all for

    F > 4/pi sum_i mu_i N_i |B_i phi|

with constant normal loads, and the amplitude grows without bound towards the natural frequency. With a little viscous
damping c (of the mass-normalised mode) the remainder of the force moves the mode by ``(F - 4/pi ...) / (c w)``: den
Hartog's result for a mass that slides all period (J. P. Den Hartog, Trans. ASME 53 (1931) 107).
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from stickslip.contact.law.contact_pairs import ContactPairs
from stickslip.contact.law.friction_law import FrictionLaw
from stickslip.contact.law.hysteretic_law import HystereticLaw
from stickslip.core.errors import InputError
from stickslip.core.validation import FloatArray
from stickslip.solve.excitation import ExcitationForce
from stickslip.solve.harmonic.linear import LinearLimit

# chosen: a smaller damping ratio is none beside round-off; up to the second one a mode counts as nearly undamped
# (bolted steel structures have 1e-3, single crystals in vacuum 1e-6).
NO_DAMPING, HARDLY_DAMPED = 1e-13, 1e-7
# chosen: smaller motions of a contact, over the largest motion of the mode, are round-off.
NO_MOTION = 1e-8
# chosen: part of the largest normal displacement of a rigid motion below which a combination of them presses no pair.
PRESSES = 1e-9
SQUARE_WAVE = 4.0 / math.pi  # first harmonic of a square wave of height 1


@dataclass(frozen=True)
class Grip:
    """The resistance of the contacts to a motion of the structure: forces, N, at the point of its largest displacement.

    friction:
        the largest first harmonic of the friction forces in the motion, with the normal loads at rest.
    opens:
        whether the motion opens, closes or presses contacts, or moves ones whose force has no limit.
    load_varies:
        whether other motions can change the normal loads of the pairs that slide.
    """

    friction: float
    opens: bool
    load_varies: bool


def grip_of(pairs: ContactPairs, shape: NDArray[Any]) -> Grip:
    """The grip on a motion (n,) whose largest displacement is 1; a complex one whirls."""
    motion = np.abs(pairs.operator @ shape).reshape(-1, 3)
    motion[motion < NO_MOTION] = 0.0
    presses = np.abs(pairs.operator.reshape(pairs.n_pairs, 3, -1)[:, 2]).max(axis=1) > 0.0
    friction, opens, load_varies = 0.0, False, False
    for law, group in zip(pairs.laws, pairs.members, strict=True):
        here = motion[group]
        if isinstance(law, FrictionLaw):
            sliding = np.hypot(here[:, 0], here[:, 1])
            opens |= bool(here[:, 2].any())
            load_varies |= bool((presses[group] & (sliding > 0.0)).any())
        else:
            frictional = law.frictional()
            sliding = (here * frictional).sum(axis=1)
            if not isinstance(law, HystereticLaw):  # bonded along n, in which this mode would not be one
                opens |= bool(here[~frictional].any())
        friction += float(sliding @ law.largest_slip_force)
    return Grip(SQUARE_WAVE * friction, opens, load_varies)


def unbounded_motions(
    free: LinearLimit, closed: LinearLimit, pairs: ContactPairs, force: ExcitationForce, window: tuple[float, float]
) -> tuple[str, ...]:
    """Warnings on motions in the frequency range ``window`` (Hz) that hardly anything bounds.

    ``free`` is the structure without contact, ``closed`` that with the contacts that are closed at rest stuck. Raises
    InputError where certainly nothing bounds one.
    """
    low, high = (2.0 * math.pi * hertz for hertz in sorted(window))
    sentences = [
        *_undamped_modes(free, pairs, force, low, high),
        *_modes_that_only_press(closed, pairs, force, low, high),
        *_unsupported(free, pairs, force, low),
    ]
    return tuple(sentences)


def nearly_undamped(limit: LinearLimit, force: ExcitationForce, low: float, high: float) -> list[tuple[int, int]]:
    """(order, mode) of the nearly undamped modes that a harmonic of the force excites in the range (rad/s)."""
    orders, modes = np.nonzero(limit.moved_by(force) & ~limit.rigid & (limit.resonant.circular_frequency > 0.0))
    return [
        (int(order), int(mode))
        for order, mode in zip(1 + orders, modes, strict=True)
        if low <= limit.resonant.circular_frequency[mode] / order <= high and _ratio(limit, int(mode)) <= HARDLY_DAMPED
    ]


def _ratio(limit: LinearLimit, mode: int) -> float:
    return float(limit.resonant.damping_ratio(mode))


def _shape(limit: LinearLimit, mode: int) -> tuple[NDArray[Any], float]:
    """The mode, complex if it whirls, with a largest displacement of 1, and its modal mass in kg."""
    shape = limit.resonant.shapes[:, mode]
    size = float(np.abs(shape).max())
    return shape / size, size**-2


def _force_in(force: ExcitationForce, shape: NDArray[Any], order: int, omega: float) -> float:
    """Amplitude in N of harmonic ``order`` of the force in a motion with the largest displacement 1."""
    cosine, sine = force.coefficients(omega)[2 * order - 1 : 2 * order + 1] @ shape.conj()
    return float(abs(cosine - 1j * sine))


def _undamped_modes(
    free: LinearLimit, pairs: ContactPairs, force: ExcitationForce, low: float, high: float
) -> list[str]:
    """Modes of the structure without contact that exceed the friction limit."""
    sentences = []
    for order, mode in nearly_undamped(free, force, low, high):
        shape, mass = _shape(free, mode)
        omega = float(free.resonant.circular_frequency[mode])
        excitation, grip = _force_in(force, shape, order, omega / order), grip_of(pairs, shape)
        if grip.opens or excitation <= grip.friction:
            continue
        load_varies = grip.load_varies and _normal_loads_vary(free, pairs, force)
        hertz = omega / order / (2.0 * math.pi)
        name = f"Mode {mode + 1} of the structure without contact ({omega / (2.0 * math.pi):.3f} Hz"
        name += ")" if order == 1 else f", excited by harmonic {order} at {hertz:.3f} Hz)"
        holds = "no contact moves in it" if grip.friction == 0.0 else f"friction can carry {grip.friction:.4g} N"
        forces = f"the excitation has {excitation:.4g} N in it (at its largest displacement), and {holds}"
        advice = "give a damping matrix or modal_damping_ratio (0.001 is usual for metal), or a range without this mode"
        if _ratio(free, mode) > NO_DAMPING:
            height = (excitation - grip.friction) / (free.resonant.half_power_width[mode] * mass * omega)
            sentences.append(
                f"{name} has a damping ratio of only {_ratio(free, mode):.1e}: {forces}. Its peak is about "
                f"{height:.3g} m high; {advice}."
            )
        elif grip.friction > 0.0 and load_varies:
            sentences.append(
                f"{name} has no damping: {forces} at the normal loads at rest. Unless these grow, nothing bounds the "
                f"amplitude there: {advice}."
            )
        else:
            raise InputError(
                f"nothing bounds the amplitude at {hertz:.3f} Hz. {name} has no damping: {forces}. "
                f"{advice[0].upper()}{advice[1:]}.",
                arguments=["modal_damping_ratio"],
            )
    return sentences


def _normal_loads_vary(free: LinearLimit, pairs: ContactPairs, force: ExcitationForce) -> bool:
    """Whether the excitation or a tangential contact force can move a pair along its normal.

    Without that, every normal load remains that at rest. A mode that presses contacts and that nothing excites changes
    none, so each mode is examined by itself.
    """
    rows = pairs.operator.reshape(pairs.n_pairs, 3, -1)
    tangential = rows[:, :2].reshape(2 * pairs.n_pairs, -1) @ free.modes
    excited = np.vstack([np.abs(tangential), *(np.abs(array @ free.modes) for _, array in force.terms)])
    excited /= np.maximum(excited.max(axis=1, keepdims=True), np.finfo(float).tiny)
    presses = np.abs(rows[:, 2] @ free.modes)
    presses /= max(float(presses.max(initial=0.0)), np.finfo(float).tiny)
    both = excited.max(axis=0, initial=0.0) * presses.max(axis=0, initial=0.0)
    return bool((both > NO_MOTION).any())


def _modes_that_only_press(
    closed: LinearLimit, pairs: ContactPairs, force: ExcitationForce, low: float, high: float
) -> list[str]:
    """Modes with stuck contact in which no contact slides, so that friction dissipates nothing."""
    sentences = []
    for mode in dict.fromkeys(mode for _, mode in nearly_undamped(closed, force, low, high)):
        shape, _ = _shape(closed, mode)
        grip = grip_of(pairs, shape)
        if grip.opens and grip.friction == 0.0:
            sentences.append(
                f"Mode {mode + 1} with stuck contact ({closed.natural_hz[mode]:.3f} Hz) has no damping, and its "
                "contacts open and close but do not slide: nothing dissipates energy there, so only the change of "
                "stiffness of contacts that open limits the amplitude. Give a damping matrix or modal_damping_ratio."
            )
    return sentences


def sliding_shapes(free: LinearLimit, pairs: ContactPairs) -> FloatArray:
    """(n, r) mass-normalised rigid motions that press no pair, so that nothing but friction resists them.

    ``free`` is the structure without contact.
    """
    rigid = free.modes[:, free.rigid]
    normal = pairs.operator[2::3]
    _, sizes, motions = np.linalg.svd(normal @ rigid)
    # Round-off of a motion that presses nothing must not count: the largest of such sizes is no scale for the others.
    scale = float(np.abs(normal).max(initial=0.0)) * float(np.abs(rigid).max(initial=0.0))
    pressing = int((sizes > PRESSES * scale).sum())
    return np.asarray(rigid @ motions[pressing:].T)


def _unsupported(free: LinearLimit, pairs: ContactPairs, force: ExcitationForce, low: float) -> list[str]:
    """Rigid motions that only friction restrains, excited by more than the friction limit."""
    sliding = sliding_shapes(free, pairs)
    if not sliding.shape[1]:
        return []
    for order in range(1, force.harmonics + 1):
        modal = force.coefficients(low)[2 * order - 1 : 2 * order + 1] @ sliding
        if not modal.any():
            continue
        # The direction in which the two parts of the force together are largest.
        direction = sliding @ np.linalg.svd(modal)[2][0]
        size = float(np.abs(direction).max())
        shape = direction / size
        excitation, grip = _force_in(force, shape, order, low), grip_of(pairs, shape)
        if not grip.opens and excitation > grip.friction:
            height = (excitation - grip.friction) * size**2 / (order * low) ** 2
            return [
                "A body moves freely: no spring restrains one of its rigid motions, the excitation has "
                f"{excitation:.4g} N in it, and friction can carry {grip.friction:.4g} N. At the lowest frequency of "
                f"the range, {low / (2.0 * math.pi):.3f} Hz, it slides by about {height:.3g} m; constrain the body, or "
                "begin at a higher frequency."
            ]
    return []
