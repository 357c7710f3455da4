"""A spring that stiffens or softens with its stretch, f = k x + k3 x^3."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import ClassVar

import numpy as np
from numpy.typing import ArrayLike

from stickslip.contact.constants import constant
from stickslip.contact.law.component_law import ElasticLaw, pairs_in, per_component, require_at_least_zero
from stickslip.contact.law.law import ContactState
from stickslip.core.short_repr import short_repr
from stickslip.core.validation import FloatArray, set_fields


@dataclass(frozen=True)
class CubicSpring(ElasticLaw):
    """``f = stiffness x + cubic_stiffness x^3`` along t1, t2 and n.

    Under ``x = X cos(w t)`` its first harmonic is ``(k + 3/4 k3 X^2) X`` (Duffing; A. H. Nayfeh and D. T. Mook,
    "Nonlinear Oscillations", 1979, sec. 4.1).

    Parameters
    ----------
    stiffness:
        N/m, 0 or above: (p, 3) along t1, t2, n; a number or (p,) applies to all three.
    cubic_stiffness:
        N/m3, the same shapes; below zero it softens.
    rest_displacement:
        m, the same shapes: stretch of the state at rest, see :class:`ElasticLaw`. Small motions about it feel
        ``k + 3 k3 rest_displacement^2``.

    Raises
    ------
    InputError
        for a wrong shape, an entry that is not finite, or a stiffness below zero.
    """

    name: ClassVar[str] = "cubic"
    states: ClassVar[Mapping[ContactState, str]] = {ContactState.STUCK: "elastic"}

    stiffness: FloatArray = field(
        metadata=constant("N/m", of_face=True, components=3, description="linear part; one value, or along t1, t2, n")
    )
    cubic_stiffness: FloatArray = field(
        metadata=constant("N/m^3", of_face=True, components=3, description="of the cube of the stretch")
    )

    __repr__ = short_repr

    def __init__(self, stiffness: ArrayLike, cubic_stiffness: ArrayLike, *, rest_displacement: ArrayLike = 0.0) -> None:
        set_fields(self, stiffness=stiffness, cubic_stiffness=cubic_stiffness, rest_displacement=rest_displacement)
        self.__post_init__()

    def __post_init__(self) -> None:
        count = pairs_in(self.name, self.stiffness, self.cubic_stiffness)
        for name in ("stiffness", "cubic_stiffness"):
            object.__setattr__(self, name, per_component(name, getattr(self, name), count))
        require_at_least_zero("stiffness", self.stiffness)
        super().__post_init__()

    @property
    def n_pairs(self) -> int:
        """Number p of pairs."""
        return len(self.stiffness)

    @property
    def largest_motion(self) -> FloatArray:
        """(p, 3) m, the displacement from rest at which a softening spring no longer resists; infinite for others."""
        softens = self.cubic_stiffness < 0.0
        square = np.divide(
            -self.stiffness, 3.0 * self.cubic_stiffness, out=np.zeros_like(self.stiffness), where=softens
        )
        reach = np.sqrt(square) - np.abs(self.rest_displacement)
        return np.where(softens, np.maximum(reach, 0.0), np.inf)

    def force_and_slope(self, displacement: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Force (p, 3, n) N and slope (p, 3, n) N/m."""
        linear, cubic = self.stiffness[:, :, None], self.cubic_stiffness[:, :, None]
        square = displacement**2
        return displacement * (linear + cubic * square), np.asarray(linear + 3.0 * cubic * square)
