"""The four-parameter Iwan joint: microslip of a lap joint by a continuous distribution of Jenkins elements.

D. J. Segalman, "A four-parameter Iwan model for lap-type joints", J. Appl. Mech. 72 (2005) 752. Elements that begin to
slip at a stretch phi have the density ``rho(phi) = R phi^chi`` up to ``phi_max``, and a spike ``S`` there. On a
periodic path all elements obey Masing's rules, so the force follows from the backbone and the turning points alone;
nothing is discretised but the time.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import ClassVar

import numpy as np
from numpy.typing import ArrayLike

from stickslip.contact.constants import constant
from stickslip.contact.law.component_law import pairs_in, per_component, require_at_least_zero
from stickslip.contact.law.hysteretic_law import HystereticLaw, RestingNormalForce, TangentialStep
from stickslip.contact.law.iwan_path import PathMemory, backbone_force, follow_from_rest, loop_energy, step_along
from stickslip.contact.law.law import BoolArray, ContactState, IndexArray
from stickslip.core.compiled import njit
from stickslip.core.errors import InputError
from stickslip.core.short_repr import short_repr
from stickslip.core.validation import FloatArray, finite_array, per_pair, require_positive, set_fields

# Towards -1 the backbone is a difference of nearly equal terms: its error is 1e-5 at -1 + 1e-9 and 1e-4 at -1 + 1e-12.
# Measured joints have -0.9 to -0.2 (Segalman 2005).
LOWEST_EXPONENT = -0.99


@dataclass(frozen=True)
class IwanJoint(RestingNormalForce, HystereticLaw):
    """A patch of a bolted or riveted joint, along t1 and along t2, with a spring along n that never opens.

    The backbone is ``F(x) = K_T x - R x^(chi+2) / ((chi+1)(chi+2))`` up to ``phi_max`` and ``F_S`` beyond, and a cycle
    of amplitude X below ``phi_max`` dissipates ``4 R X^(chi+3) / ((chi+2)(chi+3))``.

    Parameters
    ----------
    tangential_stiffness:
        K_T, (p,) or (p, 2) N/m, above zero: of small motions. For this and the others, a number applies to all pairs.
    slip_force:
        F_S, (p,) or (p, 2) N, above zero: at which the complete patch slides.
    exponent:
        chi, (p,), above -1 and at most 0: dissipation grows with the amplitude to the power chi + 3.
    ratio:
        beta, (p,), 0 or above: stiffness of the elements that slip last over that of the others.
    normal_stiffness:
        (p,) N/m along n, by default 0.
    path_to_rest:
        None ("released"): the elements start each period at the mean of the motion, without force. Or (p, 2, m) m
        ("kept"): displacements from rest along t1, t2 where the motion began without force, and then turned, on its
        way to the state at rest; elements that do not slip in vibration retain their force from there.

    Raises
    ------
    InputError
        for a wrong shape, an entry that is not finite, or a value outside of these ranges.
    """

    name: ClassVar[str] = "iwan"
    states: ClassVar[Mapping[ContactState, str]] = {
        ContactState.STUCK: "at rest",
        ContactState.STICK_SLIP: "microslip",
    }

    tangential_stiffness: FloatArray
    slip_force: FloatArray = field(
        metadata=constant("N", of_face=True, components=2, description="F_S, at which the complete patch slides")
    )
    exponent: FloatArray = field(metadata=constant(description="chi, -0.99 to 0"))
    ratio: FloatArray = field(
        metadata=constant(description="beta, ratio of stiffness: elements that slip last to the others")
    )
    normal_stiffness: FloatArray = 0.0  # type: ignore[assignment]
    path_to_rest: FloatArray | None = None

    __repr__ = short_repr

    def __init__(
        self,
        tangential_stiffness: ArrayLike,
        slip_force: ArrayLike,
        exponent: ArrayLike,
        ratio: ArrayLike,
        normal_stiffness: ArrayLike = 0.0,
        path_to_rest: ArrayLike | None = None,
        *,
        rest_normal_force: ArrayLike = 0.0,
    ) -> None:
        set_fields(
            self,
            tangential_stiffness=tangential_stiffness,
            slip_force=slip_force,
            exponent=exponent,
            ratio=ratio,
            normal_stiffness=normal_stiffness,
            path_to_rest=path_to_rest,
            rest_normal_force=rest_normal_force,
        )
        self.__post_init__()

    def __post_init__(self) -> None:
        constants = (self.tangential_stiffness, self.slip_force, self.exponent, self.ratio, self.normal_stiffness)
        count = pairs_in(self.name, *constants)
        self._take_normal_force(count)
        for name in ("exponent", "ratio", "normal_stiffness"):
            object.__setattr__(self, name, per_pair(name, getattr(self, name), count))
        for name in ("tangential_stiffness", "slip_force"):
            values = per_component(name, getattr(self, name), count, 2)
            require_positive(name, values, "An Iwan joint has a stiffness and a force at which it slides.")
            object.__setattr__(self, name, values)
        if not ((self.exponent >= LOWEST_EXPONENT) & (self.exponent <= 0.0)).all():
            raise InputError(
                f"exponent runs from {self.exponent.min():g} to {self.exponent.max():g}, but chi of an Iwan joint is "
                f"from {LOWEST_EXPONENT} to 0 (measured joints: -0.9 to -0.2).",
                ("exponent",),
            )
        require_at_least_zero("ratio", self.ratio)
        require_at_least_zero("normal_stiffness", self.normal_stiffness)
        if self.path_to_rest is not None:
            path = finite_array("path_to_rest", self.path_to_rest)
            if path.ndim != 3 or path.shape[:2] != (count, 2) or path.shape[2] == 0:
                raise InputError(
                    f"path_to_rest must have shape ({count}, 2, m) with at least one displacement for t1 and t2 of "
                    f"each pair, but its shape is {path.shape}. Use the path of static_preload.",
                    ("path_to_rest",),
                )
            object.__setattr__(self, "path_to_rest", path)

    @property
    def released(self) -> bool:
        """True if no traction at rest is remembered."""
        return self.path_to_rest is None

    @cached_property
    def _origin(self) -> FloatArray:
        """(p, 2) m from rest, where the elements carry nothing."""
        return np.zeros((self.n_pairs, 2)) if self.path_to_rest is None else self.path_to_rest[:, :, 0]

    @cached_property
    def _rest(self) -> tuple[PathMemory, FloatArray]:
        """The memory at rest and the whole force (p, 2) N there, from the path that led to it."""
        memory, force = PathMemory.without_force(self.n_pairs), np.zeros((self.n_pairs, 2))
        if self.path_to_rest is not None:
            turns = np.moveaxis(self.path_to_rest[:, :, 1:], 2, 0)
            for displacement in (*turns, np.zeros_like(self._origin)):
                force, _, memory = step_along(displacement - self._origin, memory, self._constants())
        return memory, force

    @property
    def resting_traction(self) -> FloatArray:
        """(p, 2) N along t1, t2 at rest; zero if released."""
        return self._rest[1]

    @property
    def largest_slip_force(self) -> FloatArray:
        """(p,) N, the larger of the two directions."""
        return np.asarray(self.slip_force.max(axis=1))

    @cached_property
    def macroslip_displacement(self) -> FloatArray:
        """phi_max, (p, 2) m: at larger displacements the whole patch slides."""
        share = self.ratio + (self.exponent + 1.0) / (self.exponent + 2.0)
        return self.slip_force * ((1.0 + self.ratio) / share)[:, None] / self.tangential_stiffness

    @cached_property
    def _density(self) -> FloatArray:
        """R, (p, 2) N / m^(chi+2)."""
        chi = self.exponent[:, None]
        share = (self.ratio + (self.exponent + 1.0) / (self.exponent + 2.0))[:, None]
        return np.asarray(self.slip_force * (chi + 1.0) / (self.macroslip_displacement ** (chi + 2.0) * share))

    def backbone(self, displacement: ArrayLike) -> FloatArray:
        """Force (p, 2) N on first loading to a displacement (p, 2) m, not negative."""
        x = np.minimum(np.asarray(displacement, dtype=float), self.macroslip_displacement)
        chi = self.exponent[:, None]
        return np.asarray(
            self.tangential_stiffness * x - self._density * x ** (chi + 2.0) / ((chi + 1.0) * (chi + 2.0))
        )

    def dissipation(self, amplitude: ArrayLike) -> FloatArray:
        """Energy (p, 2) J of a cycle between -X and X, amplitude X (p, 2) m."""
        size = np.asarray(amplitude, dtype=float)
        x, chi = np.minimum(size, self.macroslip_displacement), self.exponent[:, None]
        micro = self._density * x ** (chi + 3.0) / ((chi + 2.0) * (chi + 3.0))
        return np.asarray(4.0 * (micro + self.slip_force * (size - x)))

    def _constants(self) -> FloatArray:
        """(p, 2, 4): K_T, R, chi, phi_max."""
        chi = np.broadcast_to(self.exponent[:, None], self.slip_force.shape)
        return np.stack([self.tangential_stiffness, self._density, chi, self.macroslip_displacement], axis=2)

    def periods(self, paths: FloatArray) -> tuple[FloatArray, BoolArray, BoolArray, FloatArray]:
        """See :class:`HystereticLaw`."""
        force, energy = np.empty_like(paths), np.empty(paths.shape[:2])
        nothing = np.zeros((paths.shape[2], 0))
        _walk(paths, self._constants(), nothing, force, energy, np.empty((*paths.shape, 0)))
        moving = np.ptp(paths, axis=2) > 0.0
        if self.path_to_rest is not None:
            follow_from_rest(*self._from_path(slice(None), paths), nothing, force, np.empty((*paths.shape, 0)))
            # Also a shift of the mean leaves the springs: the joint continues along its backbone.
            return force, (paths != 0.0).any(axis=2), moving, np.asarray(energy.sum(axis=1))
        return force, moving, moving, np.asarray(energy.sum(axis=1))

    def path_tangent(self, paths: FloatArray, synthesis: FloatArray, select: IndexArray) -> FloatArray:
        """See :class:`HystereticLaw`."""
        chosen = paths[select]
        tangent = np.zeros((*chosen.shape, synthesis.shape[1]))
        if self.path_to_rest is not None:
            follow_from_rest(*self._from_path(select, chosen), synthesis, np.empty_like(chosen), tangent)
            return tangent
        _walk(chosen, self._constants()[select], synthesis, np.empty_like(chosen), np.empty(chosen.shape[:2]), tangent)
        return tangent

    def _from_path(self, select: IndexArray | slice, paths: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Paths, turning points on the way to rest, from where there is no force, and constants of chosen pairs."""
        assert self.path_to_rest is not None
        origin = self._origin[select][:, :, None]
        return paths - origin, self.path_to_rest[select][:, :, 1:] - origin, self._constants()[select]

    def memory_at_rest(self) -> PathMemory:
        """See :class:`stickslip.contact.law.law.ContactLaw`."""
        return self._rest[0]

    def slide(self, displacement: FloatArray, before: PathMemory) -> TangentialStep:
        """See :class:`HystereticLaw`; exact, by the turning points of the path."""
        force, slope, memory = step_along(displacement - self._origin, before, self._constants())
        return TangentialStep(force, slope, slope < self.tangential_stiffness, memory)

    def keeping(self, memory: PathMemory) -> IwanJoint:
        """See :class:`HystereticLaw`."""
        return replace(self, path_to_rest=memory.path_to_here())


@njit(cache=True, nogil=True, error_model="numpy")
def _walk(
    paths: FloatArray,
    constants: FloatArray,
    synthesis: FloatArray,
    force: FloatArray,
    energy: FloatArray,
    tangent: FloatArray,
) -> None:
    """Fill force (p, 2, n), energy (p, 2) and tangent (p, 2, n, width) of the periodic state; no tangent at width 0.

    The walk starts at the largest displacement. The force there is that of the backbone F at half the range A plus that
    of elements that stick: starting at the mean of the path, which is d below the middle of the range, they carry ``F(A
    + d) - F(A)``.

    Turning points are on a stack: on a branch from one at (x_r, F_r) the force is ``F_r -+ 2 F(|x - x_r| / 2)``. Where
    a branch passes the turning point before its own, this loop is closed, its energy counts, and the interrupted branch
    continues.
    """
    n, width = paths.shape[2], synthesis.shape[1]
    turn_x, turn_force, turn_sample = np.empty(n + 2), np.empty(n + 2), np.empty(n + 2, dtype=np.int64)
    turn_derivative, derivative = np.empty((n + 2, width)), np.empty(width)
    for pair in range(paths.shape[0]):
        for axis in range(2):
            path = paths[pair, axis]
            k, density, chi, largest = constants[pair, axis]
            top, bottom = path.argmax(), path.argmin()
            half = 0.5 * (path[top] - path[bottom])
            value, slope = backbone_force(half, k, density, chi, largest)
            # Elements that no longer slip carry the force that they had when they started from the mean.
            shift = 0.5 * (path[top] + path[bottom]) - path.mean()
            side = 1.0 if shift > 0.0 else -1.0
            outer, outer_slope = backbone_force(half + abs(shift), k, density, chi, largest)
            value += side * (outer - value)
            for q in range(width):
                by_half = 0.5 * (synthesis[top, q] - synthesis[bottom, q])
                by_shift = 0.5 * (synthesis[top, q] + synthesis[bottom, q]) - (1.0 if q == 0 else 0.0)
                derivative[q] = slope * by_half + outer_slope * by_shift + side * (outer_slope - slope) * by_half
            force[pair, axis, top], tangent[pair, axis, top] = value, derivative
            turn_x[0], turn_force[0], turn_sample[0], turn_derivative[0] = path[top], value, top, derivative
            depth, direction, before, lost = 1, -1.0, top, 0.0
            for step in range(1, n + 1):
                j = (top + step) % n
                if (path[j] - path[before]) * direction < 0.0:
                    turn_x[depth], turn_force[depth], turn_sample[depth] = path[before], value, before
                    turn_derivative[depth] = derivative
                    depth, direction = depth + 1, -direction
                while depth > 1 and (path[j] - turn_x[depth - 2]) * direction >= 0.0:
                    lost += loop_energy(0.5 * abs(turn_x[depth - 1] - turn_x[depth - 2]), k, density, chi, largest)
                    depth -= 2
                if step == n or depth == 0:  # back at the largest displacement
                    if step == n:
                        break
                    depth, direction = 1, -1.0
                    value, before = turn_force[0], j
                    derivative[:] = turn_derivative[0]
                    force[pair, axis, j], tangent[pair, axis, j] = value, derivative
                    continue
                anchor = depth - 1
                part, slope = backbone_force(0.5 * abs(path[j] - turn_x[anchor]), k, density, chi, largest)
                value = turn_force[anchor] + 2.0 * direction * part
                for q in range(width):
                    change = synthesis[j, q] - synthesis[turn_sample[anchor], q]
                    derivative[q] = turn_derivative[anchor, q] + slope * change
                force[pair, axis, j], tangent[pair, axis, j], before = value, derivative, j
            energy[pair, axis] = lost
