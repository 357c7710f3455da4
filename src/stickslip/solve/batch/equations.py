"""The balances of many curves as one: ``R(x) = x - r(w) + A(w) d(x)`` of B curves, each at its own frequency.

The arrays are those of :mod:`stickslip.solve.harmonic.balance` with a leading axis of curves and the coefficients last:
B curves, P pairs and m = 3 P rows of each, n modes, H harmonics, W = 2H+1 coefficients. One law contains the pairs of
all curves, so its compiled functions are called once. No operation joins numbers of different curves.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from stickslip.contact.law.coulomb import CoulombLaw
from stickslip.contact.law.law import BoolArray, LawPeriod
from stickslip.core.validation import FloatArray
from stickslip.solve.batch.gains import CoupledStiffness, DiagonalStiffness, Gain, Stiffness
from stickslip.solve.harmonic.gain import ComplexArray
from stickslip.solve.harmonic.harmonic_modes import IndexArray
from stickslip.solve.setting_up import Balances


@dataclass(frozen=True)
class StackedTrial:
    """Trial solutions of B curves, see :class:`stickslip.solve.harmonic.balance.Trial`."""

    omega: FloatArray  # (B,) rad/s
    relative: FloatArray  # (B, m, W) m
    deviation: FloatArray  # (B, m, W) N
    contact: LawPeriod  # of the B P pairs
    moves: BoolArray  # (B, m)
    gain: Gain
    amplitude: ComplexArray  # (B, n, H) modal amplitudes
    residual: FloatArray  # (B, m, W) m
    error: FloatArray  # (B,)


@dataclass(frozen=True)
class Structures:
    """The structures of B curves with all contacts stuck, and the forces on them.

    shapes:
        (B, m, n) relative displacements of the mass-normalised modes.
    mean:
        (B, m, m) m/N, compliance of the pairs on the mean.
    terms:
        the modal forces (B, n, H), complex, of each power of the frequency.
    """

    shapes: FloatArray
    mean: FloatArray
    terms: dict[int, ComplexArray]

    def take(self, chosen: IndexArray) -> Structures:
        """Those of some curves."""
        terms = {power: term[chosen] for power, term in self.terms.items()}
        return Structures(self.shapes[chosen], self.mean[chosen], terms)

    def modal(self, force: FloatArray) -> ComplexArray:
        """(B, n, H) modal forces of forces (B, m, W) on the pairs."""
        turned = force[:, :, 1:] * _signs(force.shape[2])
        return np.asarray((self.shapes.transpose(0, 2, 1) @ turned).view(complex))

    def vibration(self, amplitude: ComplexArray) -> FloatArray:
        """(B, m, W) relative displacements of amplitudes, without mean."""
        answer = np.zeros((*self.mean.shape[:2], 2 * amplitude.shape[2] + 1))
        answer[:, :, 1:] = (self.shapes @ amplitude.view(float)) * _signs(answer.shape[2])
        return answer

    def mean_under(self, force: FloatArray) -> FloatArray:
        """(B, m) mean relative displacements under the mean of forces (B, m, W) on the pairs."""
        return np.asarray((self.mean @ force[:, :, :1])[:, :, 0])

    def relative(self, amplitude: ComplexArray, deviation: FloatArray) -> FloatArray:
        """(B, m, W) relative displacements of amplitudes, with the mean under a deviation (B, m, W)."""
        answer = self.vibration(amplitude)
        answer[:, :, 0] = -self.mean_under(deviation)
        return answer

    def external(self, omega: FloatArray) -> ComplexArray:
        """(B, n, H) modal forces at frequencies (B,)."""
        return np.asarray(sum((omega**power)[:, None, None] * term for power, term in self.terms.items()))

    def external_slope(self, omega: FloatArray) -> ComplexArray | None:
        """Derivative (B, n, H) of the modal forces by the frequency; None if they do not depend on it."""
        slopes = [power * (omega ** (power - 1))[:, None, None] * term for power, term in self.terms.items() if power]
        return np.asarray(sum(slopes)) if slopes else None


@dataclass(frozen=True)
class StackedBalance:
    """The equations of B curves.

    law:
        the pairs of all curves, curve by curve.
    structures:
        their modes, means and forces.
    stiffness:
        of the modes.
    springs:
        (B, m, W) N/m at rest, without those that do not act on the mean.
    undetermined, walking:
        (B, m) rows whose mean no force depends on, or which friction alone resists.
    """

    law: CoulombLaw
    structures: Structures
    stiffness: Stiffness
    springs: FloatArray
    undetermined: BoolArray
    walking: BoolArray
    samples: int

    @classmethod
    def of(cls, curves: Sequence[Balances], harmonics: int) -> StackedBalance:
        """The equations of curves with equal numbers of pairs and modes, all with retained tractions or none, and with
        damping that couples the modes or none."""
        balances = [each.with_harmonics(harmonics) for each in curves]
        laws = [each.pairs.coulomb for each in curves]
        stuck = [each.stuck for each in curves]
        count, rows = len(curves), balances[0].rows
        squares = np.array([each.circular_frequency**2 for each in stuck])
        kind = DiagonalStiffness if stuck[0].modal_damping.ndim == 1 else CoupledStiffness
        damping = np.array([each.modal_damping for each in stuck])
        terms: dict[int, ComplexArray] = {}
        for place, balance in enumerate(balances):
            for power, array in balance.force.terms:
                modal = balance.compliance.external(array).modal.T
                whole = terms.setdefault(power, np.zeros((count, squares.shape[1], harmonics), dtype=complex))
                whole[place] += modal[:, 0::2] - 1j * modal[:, 1::2]
        return cls(
            law=_joined(laws),
            structures=Structures(
                np.array([each.contact_modes for each in stuck]), np.array([each.mean_contact for each in stuck]), terms
            ),
            stiffness=kind(squares, damping, harmonics),
            springs=np.array([each.springs.T for each in balances]),
            undetermined=np.array([law.undetermined() for law in laws]).reshape(count, rows),
            walking=np.array([law.frictional() for law in laws]).reshape(count, rows),
            samples=balances[0].samples,
        )

    @property
    def count(self) -> int:
        """Number B of curves."""
        return len(self.springs)

    @property
    def pairs(self) -> int:
        """Number P of pairs of a curve."""
        return int(self.springs.shape[1] // 3)

    def take(self, chosen: IndexArray) -> StackedBalance:
        """The equations of some curves; one of them may be there more than once."""
        members = (chosen[:, None] * self.pairs + np.arange(self.pairs)).ravel()
        return StackedBalance(
            self.law.of_members(members),
            self.structures.take(chosen),
            self.stiffness.take(chosen),
            self.springs[chosen],
            self.undetermined[chosen],
            self.walking[chosen],
            self.samples,
        )

    def evaluate(self, relative: FloatArray, omega: FloatArray) -> StackedTrial:
        """Forces and residuals of relative displacements (B, m, W) at frequencies (B,).

        As :meth:`stickslip.solve.harmonic.balance.Balance.evaluate`: means that no force depends on follow.
        """
        shape = relative.shape
        contact = self.law.period(relative.reshape(-1, 3, shape[2]), self.samples)
        moves = contact.moves.reshape(shape[:2])
        deviation = contact.force.reshape(shape) - self.springs * relative
        deviation *= moves[:, :, None]
        gain = self.stiffness.at(omega)
        amplitude = gain.answer(self.structures.external(omega) - self.structures.modal(deviation))
        answer = self.structures.relative(amplitude, deviation)
        residual = relative - answer
        residual[:, :, 0][self.undetermined] = 0.0
        relative = relative.copy()
        np.copyto(relative[:, :, 0], answer[:, :, 0], where=self.undetermined)
        few_digits = np.finfo(float).eps * ratio(norm(relative[:, :, :1]), norm(relative[:, :, 1:]))
        wrong = ratio(norm(residual), norm(self.determined(relative)))
        error = np.maximum(np.maximum(wrong, few_digits), self._closing_error(residual, contact))
        return StackedTrial(omega, relative, deviation, contact, moves, gain, amplitude, residual, error)

    def linear(self, omega: FloatArray) -> FloatArray:
        """(B, m, W) relative displacements with every contact stuck."""
        return self.structures.vibration(self.stiffness.at(omega).answer(self.structures.external(omega)))

    def determined(self, relative: FloatArray) -> FloatArray:
        """A copy (B, m, W) without the means that friction alone resists; no norm and no plane contains them."""
        part = relative.copy()
        part[:, :, 0][self.walking] = 0.0
        return part

    def _closing_error(self, residual: FloatArray, contact: LawPeriod) -> FloatArray | float:
        """(B,) see ``Balance.evaluate``: residual times the springs of gaps that close, over the contact force."""
        springs = self.law.hidden_springs(contact)
        if not springs.any():
            return 0.0
        force = springs.reshape(*residual.shape[:2], 1) * residual
        return ratio(norm(force), norm(contact.force.reshape(residual.shape)))


def product(first: FloatArray | ComplexArray, second: FloatArray | ComplexArray) -> FloatArray:
    """(B,) inner products of arrays (B, ...), of complex ones as of their parts."""
    flat = [each.view(float).reshape(len(each), math.prod(each.view(float).shape[1:])) for each in (first, second)]
    return np.asarray(np.einsum("bi,bi->b", *flat))


def norm(array: FloatArray | ComplexArray) -> FloatArray:
    """(B,) Euclidean norms of an array (B, ...)."""
    return np.sqrt(product(array, array))


def ratio(part: FloatArray, whole: FloatArray) -> FloatArray:
    """Quotients (B,); the part itself where the whole is zero."""
    return part / np.where(whole > 0.0, whole, 1.0)


def _signs(width: int) -> FloatArray:
    """(2H,) 1, -1, 1, ...: coefficients ``c, s`` times these are the parts of complex amplitudes ``c - i s``."""
    return np.tile([1.0, -1.0], (width - 1) // 2)


def _joined(laws: Sequence[CoulombLaw]) -> CoulombLaw:
    """One law with the pairs of all laws, all with retained tractions or none."""

    def joined(name: str) -> FloatArray:
        return np.concatenate([getattr(law, name) for law in laws])

    return CoulombLaw(
        joined("normal_stiffness"),
        joined("tangential_springs"),
        joined("friction_coefficient"),
        joined("normal_load"),
        joined("gap"),
        None if laws[0].released else joined("resting_traction"),
        laws[0].update,
    )
