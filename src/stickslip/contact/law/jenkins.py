"""The Jenkins element: a spring in series with a slider of constant friction force, along one direction."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import ClassVar

import numpy as np
from numpy.typing import ArrayLike

from stickslip.contact.constants import constant
from stickslip.contact.law.component_law import pairs_in, per_component, require_at_least_zero
from stickslip.contact.law.coulomb_linear import TOUCH
from stickslip.contact.law.hysteretic_law import HystereticLaw, RestingNormalForce, TangentialStep
from stickslip.contact.law.law import BoolArray, ContactState, IndexArray
from stickslip.contact.law.linear_steps import LinearSteps
from stickslip.contact.law.traction_at_rest import traction_of_pairs
from stickslip.core.compiled import njit
from stickslip.core.errors import InputError
from stickslip.core.short_repr import short_repr
from stickslip.core.validation import FloatArray, per_pair, require_positive, set_fields

# A trial force beyond the limit by this fraction of it is the round-off of an element that shakes down to its limit.
ROUND_OFF = 1e-13


@dataclass(frozen=True)
class SliderMemory:
    """The start of a step: displacement (p, 2) m and traction (p, 2) N along t1 and t2."""

    displacement: FloatArray
    traction: FloatArray


@dataclass(frozen=True)
class JenkinsElement(RestingNormalForce, HystereticLaw):
    """``T = k (s - w)``, ``|T| <= friction_limit``, the slider w moves where T is at the limit; along t1 and along t2.

    One-dimensional dry friction with a constant normal load (G. M. Jenkins, J. Appl. Phys. 33 (1962) 2055 for the
    element): the two directions are independent. In the cyclic state the slider is at the mean of the motion until it
    slips.

    Parameters
    ----------
    tangential_stiffness:
        (p,) or (p, 2) N/m, 0 or above; 0 where a direction has no element. A number applies to all pairs, also below.
    friction_limit:
        (p,) or (p, 2) N, above zero.
    normal_stiffness:
        (p,) N/m of a spring along n that never opens, by default 0.
    residual_traction:
        None ("released"): the slider starts each period at the mean of the motion. Or (p, 2) N along t1, t2 ("kept"):
        the traction at rest, at most ``friction_limit``; an element that never slips retains it.

    Raises
    ------
    InputError
        for a wrong shape, an entry that is not finite, or a value outside of these ranges.
    """

    name: ClassVar[str] = "jenkins"
    states: ClassVar[Mapping[ContactState, str]] = {
        ContactState.STUCK: "stuck",
        ContactState.STICK_SLIP: "stick-slip",
    }

    tangential_stiffness: FloatArray
    friction_limit: FloatArray = field(
        metadata=constant("N", of_face=True, components=2, description="force at which the slider moves")
    )
    normal_stiffness: FloatArray = 0.0  # type: ignore[assignment]
    residual_traction: FloatArray | None = None

    __repr__ = short_repr

    def __init__(
        self,
        tangential_stiffness: ArrayLike,
        friction_limit: ArrayLike,
        normal_stiffness: ArrayLike = 0.0,
        residual_traction: ArrayLike | None = None,
        *,
        rest_normal_force: ArrayLike = 0.0,
    ) -> None:
        set_fields(
            self,
            tangential_stiffness=tangential_stiffness,
            friction_limit=friction_limit,
            normal_stiffness=normal_stiffness,
            residual_traction=residual_traction,
            rest_normal_force=rest_normal_force,
        )
        self.__post_init__()

    def __post_init__(self) -> None:
        count = pairs_in(self.name, self.tangential_stiffness, self.friction_limit, self.normal_stiffness)
        self._take_normal_force(count)
        for name in ("tangential_stiffness", "friction_limit"):
            object.__setattr__(self, name, per_component(name, getattr(self, name), count, 2))
        object.__setattr__(self, "normal_stiffness", per_pair("normal_stiffness", self.normal_stiffness, count))
        require_at_least_zero("tangential_stiffness", self.tangential_stiffness)
        require_at_least_zero("normal_stiffness", self.normal_stiffness)
        require_positive("friction_limit", self.friction_limit, "An element requires a friction limit.")
        if self.residual_traction is not None:
            object.__setattr__(self, "residual_traction", self._admissible(self.residual_traction))

    def _admissible(self, traction: FloatArray) -> FloatArray:
        """A residual traction (p, 2) that the elements can retain. Raises InputError for another."""
        residual = traction_of_pairs(traction, self.n_pairs)
        largest = np.where(self.tangential_stiffness > 0.0, self.friction_limit, 0.0)
        beyond = np.argwhere(np.abs(residual) > largest)
        if beyond.size:
            pair, axis = beyond[0]
            raise InputError(
                f"residual_traction[{pair}, {axis}] is {residual[pair, axis]:.4g} N, but the element carries at most "
                f"{largest[pair, axis]:.4g} N (its friction limit, 0 without stiffness; elements above it: "
                f"{len(beyond)} of {residual.size}). Use the traction of static_preload.",
                arguments=["residual_traction"],
            )
        return residual

    @property
    def largest_slip_force(self) -> FloatArray:
        """(p,) N, the larger of the two limits."""
        return np.asarray(self.friction_limit.max(axis=1))

    def periods(self, paths: FloatArray) -> tuple[FloatArray, BoolArray, BoolArray, FloatArray]:
        """See :class:`HystereticLaw`."""
        force = np.empty_like(paths)
        deviates, slips = np.empty((2, *paths.shape[:2]), dtype=bool)
        energy = np.empty(paths.shape[:2])
        _march(paths, *self._constants(), self.released, force, deviates, slips, energy)
        return force, deviates, slips, np.asarray(energy.sum(axis=1))

    def path_tangent(self, paths: FloatArray, synthesis: FloatArray, select: IndexArray) -> FloatArray:
        """See :class:`HystereticLaw`."""
        tangent = np.empty((len(select), 2, *synthesis.shape))
        chosen = (constant[select] for constant in self._constants())
        _march_tangent(paths[select], *chosen, self.released, synthesis, tangent)
        return tangent

    def _constants(self) -> tuple[FloatArray, FloatArray, FloatArray]:
        """(p, 2) each: stiffness, limit, traction at rest."""
        return self.tangential_stiffness, self.friction_limit, self.resting_traction

    def memory_at_rest(self) -> SliderMemory:
        """See :class:`stickslip.contact.law.law.ContactLaw`: the traction at rest."""
        return SliderMemory(np.zeros((self.n_pairs, 2)), self.resting_traction)

    def slide(self, displacement: FloatArray, before: SliderMemory) -> TangentialStep:
        """See :class:`HystereticLaw`; exact for any straight step."""
        trial = before.traction + self.tangential_stiffness * (displacement - before.displacement)
        traction = np.clip(trial, -self.friction_limit, self.friction_limit)
        sticks = trial == traction
        slope = np.where(sticks, self.tangential_stiffness, 0.0)
        at_limit = np.abs(trial) >= self.friction_limit * (1.0 - ROUND_OFF)
        return TangentialStep(traction, slope, at_limit, SliderMemory(displacement, traction))

    def linear_steps(self, displacement: FloatArray) -> LinearSteps:
        """See :class:`stickslip.contact.law.linear_steps.SteppedLaw`."""
        samples, n_pairs = displacement.shape[:2]
        tangential = displacement[:, :, :2]
        before = np.roll(self.cycle(displacement).force[:, :, :2], 1, axis=0)
        trial = before + self.tangential_stiffness * (tangential - np.roll(tangential, 1, axis=0))
        # An element that has shaken down and touches its limit counts as slipping, as in coulomb_linear.py.
        sticks = (np.abs(trial) < self.friction_limit * (1.0 - TOUCH)).astype(float)
        keep, by_end = np.zeros((samples, n_pairs, 2, 2)), np.zeros((samples, n_pairs, 2, 3))
        keep[:, :, (0, 1), (0, 1)] = sticks
        by_end[:, :, (0, 1), (0, 1)] = sticks * self.tangential_stiffness
        return LinearSteps(keep, by_end, -by_end, np.broadcast_to(self.normal_stiffness, (samples, n_pairs)))

    def keeping(self, memory: SliderMemory) -> JenkinsElement:
        """See :class:`HystereticLaw`."""
        return replace(self, residual_traction=memory.traction)


@njit(cache=True, nogil=True, error_model="numpy")
def _march(
    paths: FloatArray,
    stiffness: FloatArray,
    limits: FloatArray,
    at_rest: FloatArray,
    released: bool,
    force: FloatArray,
    deviates: BoolArray,
    slips: BoolArray,
    energy: FloatArray,
) -> None:
    """Fill the last four arrays for paths (p, 2, n).

    A period moves the force by a clipped shift, ``T -> min(max(T, a), b)``, so the second one is periodic.
    """
    for pair in range(paths.shape[0]):
        for axis in range(2):
            path, k, limit = paths[pair, axis], stiffness[pair, axis], limits[pair, axis]
            n = path.shape[0]
            traction = k * (path[0] - path.mean()) if released else at_rest[pair, axis] + k * path[0]
            ever = abs(traction) > limit
            traction = min(max(traction, -limit), limit)
            lost = 0.0
            for step in range(1, 2 * n + 1):
                trial = traction + k * (path[step % n] - path[(step - 1) % n])
                traction = min(max(trial, -limit), limit)
                if step > n:
                    force[pair, axis, step % n] = traction
                    if k > 0.0 and abs(trial - traction) > ROUND_OFF * limit:
                        lost += abs(trial - traction) * limit / k
                ever = ever or trial != traction
            deviates[pair, axis], slips[pair, axis], energy[pair, axis] = ever, lost > 0.0, lost


@njit(cache=True, nogil=True, error_model="numpy")
def _march_tangent(
    paths: FloatArray,
    stiffness: FloatArray,
    limits: FloatArray,
    at_rest: FloatArray,
    released: bool,
    synthesis: FloatArray,
    tangent: FloatArray,
) -> None:
    """Fill ``tangent`` (p, 2, n, width): derivative of the periodic force by the coefficients of the path."""
    n, width = synthesis.shape
    derivative = np.empty(width)
    for pair in range(paths.shape[0]):
        for axis in range(2):
            path, k, limit = paths[pair, axis], stiffness[pair, axis], limits[pair, axis]
            traction = k * (path[0] - path.mean()) if released else at_rest[pair, axis] + k * path[0]
            derivative[:] = k * synthesis[0]
            if released:
                derivative[0] = 0.0  # the slider starts at the mean
            if abs(traction) > limit:
                traction, derivative[:] = min(max(traction, -limit), limit), 0.0
            for step in range(1, 2 * n + 1):
                j, i = step % n, (step - 1) % n
                trial = traction + k * (path[j] - path[i])
                traction = min(max(trial, -limit), limit)
                if trial != traction:
                    derivative[:] = 0.0
                else:
                    for q in range(width):
                        derivative[q] += k * (synthesis[j, q] - synthesis[i, q])
                if step > n:
                    tangent[pair, axis, j] = derivative
