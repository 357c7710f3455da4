"""Closed forms to check a friction law and contact stiffness against; the tests of stickslip use them.

The motions are ``s = X cos(t)`` with spring stiffness k and friction coefficient mu; a spring force T
on the left-hand side of the equation of motion. The formulas are valid for the
periodic state in which the pair slips in both directions.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from stickslip.core.errors import InputError
from stickslip.core.validation import FloatArray, positive_number, require_allowed


@dataclass(frozen=True)
class FrictionLoop:
    """One period of a friction force: ``T(t) = constant + cosine cos t + sine sin t`` on each piece.

    Attributes
    ----------
    amplitude:
        X of the motion ``s = X cos t``, m.
    start:
        (n_pieces + 1,) angle where each piece starts and, last, where the period ends, rad.
    pieces:
        (n_pieces, 3) N: constant, cosine and sine of each piece.
    """

    amplitude: float
    start: FloatArray
    pieces: FloatArray

    def force(self, angle: ArrayLike) -> FloatArray:
        """T in N at the angles t (rad, any shape)."""
        t = np.asarray(angle, dtype=float)
        t = self.start[0] + np.mod(t - self.start[0], 2.0 * np.pi)
        piece = np.clip(np.searchsorted(self.start, t, side="right") - 1, 0, len(self.pieces) - 1)
        constant, cosine, sine = np.moveaxis(self.pieces[piece], -1, 0)
        signal: FloatArray = constant + cosine * np.cos(t) + sine * np.sin(t)
        return signal

    @property
    def coefficients(self) -> FloatArray:
        """(3,) N: mean, cosine and sine of the first harmonic, integrated exactly piece by piece."""
        begin, end = self.start[:-1], self.start[1:]
        constant, cosine, sine = self.pieces.T

        def between(primitive: FloatArray) -> FloatArray:
            difference: FloatArray = primitive[1] - primitive[0]
            return difference

        t = np.array([begin, end])
        one, cos, sin = t[1] - t[0], between(np.sin(t)), between(-np.cos(t))
        cos_cos, sin_sin = 0.5 * one + between(np.sin(2 * t)) / 4, 0.5 * one - between(np.sin(2 * t)) / 4
        cos_sin = between(np.sin(t) ** 2) / 2
        mean = np.sum(constant * one + cosine * cos + sine * sin) / (2.0 * np.pi)
        first = np.sum(constant * cos + cosine * cos_cos + sine * cos_sin) / np.pi
        second = np.sum(constant * sin + cosine * cos_sin + sine * sin_sin) / np.pi
        return np.array([mean, first, second])

    @property
    def dissipated_energy(self) -> float:
        """Energy per period, J: ``-pi X b1`` with b1 the sine coefficient of T."""
        return float(-np.pi * self.amplitude * self.coefficients[2])


@dataclass(frozen=True)
class CircularForce:
    """Friction force of a circular motion: components along s and along its velocity, N; energy per period, J."""

    radial: float
    tangential: float
    dissipated_energy: float


@dataclass(frozen=True)
class HertzContact:
    """Elastic sphere on a flat: contact radius m, approach m, normal stiffness dF/d(approach) N/m, peak pressure Pa."""

    contact_radius: float
    approach: float
    normal_stiffness: float
    peak_pressure: float


def jenkins_loop(stiffness: float, friction_coefficient: float, preload: float, amplitude: float) -> FrictionLoop:
    """Constant normal load: spring and slider in series under ``s = X cos t`` (Jenkins element).

    The parallelogram: stick for an angle ``acos(1 - 2 mu N / (k X))`` after each reversal, slip at mu N otherwise, so
    ``W = 4 mu N (X - mu N / k)``. Raises InputError unless ``k X > mu N``.
    """
    return in_phase_loop(stiffness, friction_coefficient, preload, 0.0, amplitude)


def in_phase_loop(
    stiffness: float, friction_coefficient: float, preload: float, normal_amplitude: float, amplitude: float
) -> FrictionLoop:
    """Normal load ``N = max(N0 + N1 cos t, 0)`` in phase with ``s = X cos t``; N1 may be negative or zero.

    For ``|N1| < N0`` the loop is a quadrilateral: stick ends at ``cos t1 = (kX - mu (2 N0 + N1)) / (kX + mu N1)`` and
    ``cos t2 = (mu (2 N0 - N1) - kX) / (kX - mu N1)``, t2 in (pi, 2 pi). For ``N1 > N0`` the pair opens where
    ``cos ts = -N0 / N1`` and slips at once when it closes again.

    Raises InputError unless ``k X > mu N0`` (both slips exist), ``k X > mu |N1|`` (slip lasts to the reversal) and,
    with a negative N1, ``-N1 < N0``.
    """
    _positive(stiffness=stiffness, friction_coefficient=friction_coefficient, preload=preload, amplitude=amplitude)
    spring = stiffness * amplitude
    mean, change = friction_coefficient * preload, friction_coefficient * normal_amplitude
    if spring <= max(mean, abs(change)) or change <= -mean:
        raise InputError(
            f"The closed-form loop requires stiffness * amplitude ({spring:g} N) above friction_coefficient * preload "
            f"({mean:g} N) and above friction_coefficient * |normal_amplitude| ({abs(change):g} N), and "
            "normal_amplitude above -preload. Use a larger amplitude, or shift the motion by half a period."
        )
    stick_end = math.acos((spring - 2.0 * mean - change) / (spring + change))
    unload, slip_back = (mean + change - spring, spring, 0.0), (-mean, -change, 0.0)
    if change >= mean:
        lift_off = math.acos(-mean / change)
        angles = [0.0, stick_end, lift_off, 2.0 * math.pi - lift_off, 2.0 * math.pi]
        pieces = [unload, slip_back, (0.0, 0.0, 0.0), (mean, change, 0.0)]
    else:
        second_end = 2.0 * math.pi - math.acos((2.0 * mean - change - spring) / (spring - change))
        angles = [0.0, stick_end, math.pi, second_end, 2.0 * math.pi]
        pieces = [unload, slip_back, (spring - mean + change, spring, 0.0), (mean, change, 0.0)]
    return FrictionLoop(amplitude, np.array(angles), np.array(pieces))


def quadrature_loop(
    stiffness: float, friction_coefficient: float, preload: float, normal_amplitude: float, amplitude: float
) -> FrictionLoop:
    """Normal load ``N = N0 + N1 sin t`` a quarter period from ``s = X cos t``.

    With ``R = hypot(k X, mu N1)``, ``a = atan(mu N1 / (k X))`` and ``b = acos(1 - 2 mu N0 / R)`` the pair sticks from
    ``-a`` to ``a + b`` and from ``pi + a`` to ``pi - a + b``, and slips between.

    Raises InputError unless ``|N1| < N0``, ``R > mu N0`` and ``b > 2 |a|`` (both stick phases exist).
    """
    _positive(stiffness=stiffness, friction_coefficient=friction_coefficient, preload=preload, amplitude=amplitude)
    spring = stiffness * amplitude
    mean, change = friction_coefficient * preload, friction_coefficient * normal_amplitude
    radius = math.hypot(spring, change)
    a = math.atan(change / spring)
    b = math.acos(1.0 - 2.0 * mean / radius) if radius > mean else 0.0
    if abs(normal_amplitude) >= preload or b <= 2.0 * abs(a):
        raise InputError(
            f"The closed-form loop requires |normal_amplitude| ({abs(normal_amplitude):g} N) below preload "
            f"({preload:g} N) and two stick phases. The pair sticks twice if stiffness * amplitude ({spring:g} N) is "
            f"well above friction_coefficient * preload ({mean:g} N). Use a larger amplitude or a smaller "
            "normal_amplitude."
        )
    turning = spring * math.cos(a)
    least = mean - change * math.sin(a)
    angles = [-a, a + b, math.pi + a, math.pi - a + b, 2.0 * math.pi - a]
    pieces = [
        (least - turning, spring, 0.0),
        (-mean, 0.0, -change),
        (turning - least, spring, 0.0),
        (mean, 0.0, change),
    ]
    return FrictionLoop(amplitude, np.array(angles), np.array(pieces))


def circular_force(stiffness: float, friction_coefficient: float, preload: float, amplitude: float) -> CircularForce:
    """Steady sliding on a circle ``s = X (cos t, sin t)`` under constant normal load.

    ``|T| = mu N`` and T leads s by ``acos(c)``, ``c = mu N / (k X)``: radial part ``mu N c``, part along the velocity
    ``mu N sqrt(1 - c^2)``, ``W = 2 pi mu N sqrt(X^2 - (mu N / k)^2)``. Raises InputError unless ``c < 1``.
    """
    _positive(stiffness=stiffness, friction_coefficient=friction_coefficient, preload=preload, amplitude=amplitude)
    limit = friction_coefficient * preload
    share = limit / (stiffness * amplitude)
    if share >= 1.0:
        raise InputError(
            f"The pair slides on a circle only if stiffness * amplitude ({stiffness * amplitude:g} N) is above "
            f"friction_coefficient * preload ({limit:g} N). Use a larger amplitude."
        )
    tangential = limit * math.sqrt(1.0 - share**2)
    return CircularForce(limit * share, tangential, 2.0 * math.pi * amplitude * tangential)


def hertz_sphere(load: float, radius: float, reduced_modulus: float) -> HertzContact:
    """Hertz: ``F = 4/3 E* sqrt(R) delta^1.5``, ``a = sqrt(R delta)``, ``dF/d delta = 2 E* a``.

    Peak pressure ``p0 = 1.5 F / (pi a^2)``. load N, radius m, reduced_modulus Pa with
    ``1 / E* = (1 - nu1^2) / E1 + (1 - nu2^2) / E2``. Source: K. L. Johnson, Contact Mechanics (1985), chapter 4.
    Raises InputError for a value that is not above zero.
    """
    _positive(load=load, radius=radius, reduced_modulus=reduced_modulus)
    contact_radius = (0.75 * load * radius / reduced_modulus) ** (1.0 / 3.0)
    peak = 1.5 * load / (math.pi * contact_radius**2)
    return HertzContact(contact_radius, contact_radius**2 / radius, 2.0 * reduced_modulus * contact_radius, peak)


def mindlin_stiffness(contact_radius: float, reduced_modulus: float, poisson_ratio: float) -> float:
    """Tangential stiffness of a circular contact without slip, N/m: ``2 E* a * 2 (1 - nu) / (2 - nu)``.

    For two bodies of one Poisson ratio, ``8 G* a``. Source: K. L. Johnson, Contact Mechanics (1985), section 7.2.
    Raises InputError for a radius or modulus that is not above zero or a Poisson ratio outside (-1, 0.5].
    """
    _positive(contact_radius=contact_radius, reduced_modulus=reduced_modulus)
    require_allowed(
        "poisson_ratio", poisson_ratio, -1.0 < poisson_ratio <= 0.5, "above -1 and at most 0.5 (steel: 0.3)"
    )
    return 4.0 * reduced_modulus * contact_radius * (1.0 - poisson_ratio) / (2.0 - poisson_ratio)


def _positive(**values: float) -> None:
    for name, value in values.items():
        positive_number(name, value)
