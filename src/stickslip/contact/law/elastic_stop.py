"""An elastic stop behind a gap: a spring that acts once a pair has closed by its gap, beside one that always acts."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import ClassVar

import numpy as np
from numpy.typing import ArrayLike

from stickslip.contact.constants import constant
from stickslip.contact.law.component_law import ElasticLaw, pairs_in, require_at_least_zero
from stickslip.contact.law.law import CodeArray, ContactState
from stickslip.core.errors import InputError
from stickslip.core.short_repr import short_repr
from stickslip.core.validation import FloatArray, per_pair, require_positive, set_fields


@dataclass(frozen=True)
class ElasticStop(ElasticLaw):
    """``f = spring n + stiffness max(n - gap, 0)`` along n, bilinear; on both sides ``+ stiffness min(n + gap, 0)``.

    Under ``n = X cos(w t)``, ``X > gap``, the first harmonic of the stop on one side is
    ``k X (b - sin(b) cos(b)) / pi`` with ``cos b = gap / X`` (S. W. Shaw and P. J. Holmes, J. Sound Vib. 90 (1983) 129,
    for the piecewise linear oscillator); on both sides it is twice that.

    Parameters
    ----------
    stiffness:
        (p,) N/m of the stop, above zero; a number applies to all pairs, also below.
    gap:
        (p,) m of the unloaded pair, above zero.
    spring:
        (p,) N/m of the spring that always acts, by default 0.
    two_sided:
        whether there is a stop on each side.
    rest_displacement:
        m, see :class:`ElasticLaw`; beyond the gap along n the stop is closed at rest and its spring acts there.

    Raises
    ------
    InputError
        for a wrong shape, an entry that is not finite, or a value outside of these ranges.
    """

    name: ClassVar[str] = "elastic-stop"
    states: ClassVar[Mapping[ContactState, str]] = {
        ContactState.STUCK: "no impact",
        ContactState.SEPARATING: "hits the stop",
    }

    stiffness: FloatArray = field(metadata=constant("N/m", of_face=True, description="of the stop, along n"))
    gap: FloatArray
    spring: FloatArray = field(
        default=0.0,  # type: ignore[arg-type]
        metadata=constant("N/m", of_face=True, description="of the spring along n that always acts"),
    )
    two_sided: bool = field(
        default=False, metadata=constant(is_switch=True, description="whether there is a stop on each side")
    )

    __repr__ = short_repr

    def __init__(
        self,
        stiffness: ArrayLike,
        gap: ArrayLike,
        spring: ArrayLike = 0.0,
        two_sided: bool = False,
        *,
        rest_displacement: ArrayLike = 0.0,
    ) -> None:
        set_fields(
            self, stiffness=stiffness, gap=gap, spring=spring, two_sided=two_sided, rest_displacement=rest_displacement
        )
        self.__post_init__()

    def __post_init__(self) -> None:
        count = pairs_in(self.name, self.stiffness, self.gap, self.spring)
        for name in ("stiffness", "gap", "spring"):
            object.__setattr__(self, name, per_pair(name, getattr(self, name), count))
        require_positive("stiffness", self.stiffness, "A stop requires a stiffness.")
        require_positive("gap", self.gap, "A stop that touches at rest is a contact with a normal load of 0.")
        require_at_least_zero("spring", self.spring)
        if not isinstance(self.two_sided, bool | np.bool_):
            raise InputError(f"two_sided is {self.two_sided!r}, but it must be true or false.", ("two_sided",))
        super().__post_init__()

    @property
    def n_pairs(self) -> int:
        """Number p of pairs."""
        return len(self.stiffness)

    def force_and_slope(self, displacement: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Force (p, 3, n) N and slope (p, 3, n) N/m."""
        force, slope = np.zeros_like(displacement), np.zeros_like(displacement)
        closing = displacement[:, 2]
        stiffness, gap = self.stiffness[:, None], self.gap[:, None]
        beyond = np.maximum(closing - gap, 0.0)
        if self.two_sided:
            beyond += np.minimum(closing + gap, 0.0)
        force[:, 2] = self.spring[:, None] * closing + stiffness * beyond
        slope[:, 2] = self.spring[:, None] + stiffness * (beyond != 0.0)
        return force, slope

    def states_of(self, slope: FloatArray) -> CodeArray:
        """(p,) separating where the stiffness changes within the period; a stop that stays closed is a spring."""
        hits = (slope[:, 2] != self.resting_springs()[:, 2, None]).any(axis=1)
        return np.where(hits, ContactState.SEPARATING, ContactState.STUCK).astype(np.int8)
