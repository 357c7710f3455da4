"""Statics of a cylinder between two platforms: loads of its lines, whether friction locks it, when it rolls.

The platforms have the angles ``a`` and ``b`` to the plane normal to the force F that presses the cylinder outwards. F
acts at the axis, so the moments of the friction forces about the axis are in balance: **both friction forces are
equal**, T. While the cylinder slides outwards, the line with the smaller normal load, that of the larger angle (say a),
slides, and the other one rolls or sticks: T = mu N_a, and

    N_a = F sin b / D,   N_b = F (sin a + mu (cos b - cos a)) / D,   D = sin(a + b) + mu (1 - cos(a + b)).

Squeezed inwards by the platforms, mu has the other sign. D is then zero for mu = cot((a + b) / 2): the cylinder is
locked where a wedge is, because both need the line between the contacts inside both friction cones. For equal angles
the loads are those of a wedge.

A cylinder that is not squeezed, but whose platforms move in opposite directions along their slopes, can roll: equal
friction forces at both lines then turn it in the same sense, which only its inertia balances. So T is nearly zero, and
such a motion dissipates nothing.
"""

from __future__ import annotations

from math import cos, pi, sin, tan


def line_loads(force: float, angles: tuple[float, float], friction: float = 0.0) -> tuple[float, float]:
    """Normal loads in N of both lines of a cylinder that slides outwards with a friction coefficient, or without.

    ``angles`` in rad, left and right.
    """
    return _loads(force, angles, friction)


def squeezed_line_loads(force: float, angles: tuple[float, float], friction: float) -> tuple[float, float] | None:
    """Normal loads in N of both lines that make the cylinder slide inwards; None if it is locked."""
    return None if friction >= holding_friction(angles) else _loads(force, angles, -friction)


def holding_friction(angles: tuple[float, float]) -> float:
    """Friction coefficient from which the platforms clamp the cylinder without any force F, cot((a + b) / 2)."""
    return 1.0 / tan(0.5 * sum(angles)) if sum(angles) < pi else 0.0


def _loads(force: float, angles: tuple[float, float], friction: float) -> tuple[float, float]:
    total, (small, large) = sum(angles), sorted(angles)
    divisor = sin(total) + friction * (1.0 - cos(total))
    sliding = force * sin(small) / divisor
    other = force * (sin(large) + friction * (cos(small) - cos(large))) / divisor
    return (other, sliding) if angles[0] <= angles[1] else (sliding, other)
