"""Contact laws from plain numbers, for tests under the strict type check: the fields of a law are arrays."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

import stickslip as ss
from stickslip.core.validation import FloatArray


def _array(value: ArrayLike) -> FloatArray:
    return np.asarray(value, dtype=float)


def cubic(stiffness: ArrayLike, cubic_stiffness: ArrayLike, rest: ArrayLike = 0.0) -> ss.CubicSpring:
    return ss.CubicSpring(_array(stiffness), _array(cubic_stiffness), rest_displacement=_array(rest))


def stop(stiffness: ArrayLike, gap: ArrayLike, spring: ArrayLike = 0.0, two_sided: bool = False) -> ss.ElasticStop:
    return ss.ElasticStop(_array(stiffness), _array(gap), _array(spring), two_sided)


def jenkins(
    stiffness: ArrayLike, limit: ArrayLike, normal: ArrayLike = 0.0, kept: ArrayLike | None = None
) -> ss.JenkinsElement:
    traction = None if kept is None else _array(kept)
    return ss.JenkinsElement(_array(stiffness), _array(limit), _array(normal), traction)


def iwan(
    stiffness: ArrayLike, slip_force: ArrayLike, exponent: ArrayLike, ratio: ArrayLike, normal: ArrayLike = 0.0
) -> ss.IwanJoint:
    return ss.IwanJoint(_array(stiffness), _array(slip_force), _array(exponent), _array(ratio), _array(normal))


def coulomb(
    normal: ArrayLike, tangential: ArrayLike, friction: ArrayLike, load: ArrayLike, gap: ArrayLike
) -> ss.CoulombLaw:
    return ss.CoulombLaw(_array(normal), _array(tangential), _array(friction), _array(load), _array(gap))


def exponential(
    normal: ArrayLike, tangential: ArrayLike, friction: ArrayLike, load: ArrayLike
) -> ss.ExponentialContact:
    return ss.ExponentialContact(_array(normal), _array(tangential), _array(friction), _array(load))
