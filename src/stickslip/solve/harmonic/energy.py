"""Measures of converged points: displacement, energies per cycle, and the residual of the equation of motion."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, fields
from functools import cached_property
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from stickslip.contact.law.law import ContactState
from stickslip.core.fourier import with_rows
from stickslip.core.validation import FloatArray
from stickslip.solve.harmonic.balance import Balance, Trial
from stickslip.solve.harmonic.operator_products import Rows, as_rows, at_unknowns
from stickslip.structure.superelement import Superelement

Orders = NDArray[np.int64]

# Points that are evaluated together, for long matrix products.
CHUNK = 32


@dataclass(frozen=True)
class CurveMeasures:
    """Measures of the points of a curve; the first axis is that of the points."""

    displacement: FloatArray  # (n_points, 2H+1, n) m
    dissipated_energy: FloatArray  # (n_points, n_pairs) J per cycle
    normal_work: FloatArray  # (n_points, n_pairs) J, the part of the normal forces, an error of sampling
    input_energy: FloatArray  # (n_points,)
    viscous_energy: FloatArray  # (n_points,)
    kinetic_energy: FloatArray  # (n_points,) J, twice the mean of the first harmonic over the period
    residual: FloatArray  # (n_points,)

    def first(self, count: int) -> CurveMeasures:
        """Those of the first ``count`` points."""
        return CurveMeasures(*(getattr(self, field.name)[:count] for field in fields(self)))


class EquationOfMotion(Protocol):
    """The terms of the equation of motion, from coefficients (n_points, 2H+1, n) of the unknowns."""

    def momentum(self, displacement: FloatArray) -> FloatArray:
        """``M u``."""

    def elastic_force(self, displacement: FloatArray) -> FloatArray:
        """``K u``."""

    def viscous_term(self, displacement: FloatArray) -> FloatArray:
        """``C u``."""

    def joint_force(self, contact: FloatArray) -> FloatArray:
        """``B^T f`` of forces (n_points, 2H+1, m) of the pairs."""

    def kinetic_energy(self, displacement: FloatArray, omega: FloatArray) -> FloatArray:
        """(n_points,) ``w^2 / 2 (c_1 . M c_1 + s_1 . M s_1)``."""


@dataclass(frozen=True)
class StructureEquation:
    """The equation of a structure, with the matrix (n, n) of its velocities, damping and Coriolis forces, or the root
    R (n, r) of a damping ``R R^T``, and the operator (m, n) of its pairs."""

    superelement: Superelement
    damping: FloatArray
    operator: FloatArray
    is_root: bool = False

    def momentum(self, displacement: FloatArray) -> FloatArray:
        """See :class:`EquationOfMotion`."""
        return _product(displacement, self.superelement.mass)

    def elastic_force(self, displacement: FloatArray) -> FloatArray:
        """See :class:`EquationOfMotion`."""
        force, on_mean = _product(displacement, self.superelement.stiffness), self.superelement.mean_structure()
        if on_mean is not self.superelement:
            force[:, 0] = displacement[:, 0] @ on_mean.stiffness
        return force

    def viscous_term(self, displacement: FloatArray) -> FloatArray:
        """See :class:`EquationOfMotion`."""
        if self.is_root:
            return np.asarray((displacement @ self.damping) @ self.damping.T)
        return _product(displacement, self.damping.T)

    def joint_force(self, contact: FloatArray) -> FloatArray:
        """See :class:`EquationOfMotion`."""
        return at_unknowns(contact, self._rows)

    def kinetic_energy(self, displacement: FloatArray, omega: FloatArray) -> FloatArray:
        """See :class:`EquationOfMotion`."""
        first = displacement[:, 1:3]
        energy: FloatArray = 0.5 * omega**2 * (_product(first, self.superelement.mass) * first).sum(axis=(1, 2))
        return energy

    @cached_property
    def _rows(self) -> Rows:
        return as_rows(self.operator)


def _product(displacement: FloatArray, matrix: FloatArray) -> FloatArray:
    """Rows times a matrix, as one product: one for each point would read the matrix for each."""
    return np.asarray((displacement.reshape(-1, displacement.shape[-1]) @ matrix).reshape(displacement.shape))


def measure_curve(
    trials: Sequence[Trial], balance_of: Callable[[int], Balance], equation: EquationOfMotion
) -> CurveMeasures:
    """Displacement, energies per cycle, and the residual of the equation of motion itself, of points.

    ``balance_of(h)`` is the balance of the points with ``h`` harmonics; the displacement has zeros in those that a
    point lacks.
    """
    parts = [_measure(chunk, balance_of(_harmonics(chunk[0])), equation) for chunk in _chunks(trials)]
    rows = max(2 * _harmonics(trial) + 1 for trial in trials)
    widened = [with_rows(part.displacement.swapaxes(0, 1), rows).swapaxes(0, 1) for part in parts]
    return CurveMeasures(
        np.concatenate(widened),
        np.concatenate([part.dissipated_energy for part in parts]),
        np.concatenate([part.normal_work for part in parts]),
        np.concatenate([part.input_energy for part in parts]),
        np.concatenate([part.viscous_energy for part in parts]),
        np.concatenate([part.kinetic_energy for part in parts]),
        np.concatenate([part.residual for part in parts]),
    )


def _harmonics(trial: Trial) -> int:
    return len(trial.amplitude) // 2


def _chunks(trials: Sequence[Trial]) -> Iterator[Sequence[Trial]]:
    """Successive points with one number of harmonics."""
    first = 0
    for end in range(1, len(trials) + 1):
        if end == len(trials) or end - first == CHUNK or _harmonics(trials[end]) != _harmonics(trials[first]):
            yield trials[first:end]
            first = end


def _measure(trials: Sequence[Trial], balance: Balance, equation: EquationOfMotion) -> CurveMeasures:
    displacement = balance.displacement(trials)
    omega = np.array([trial.omega for trial in trials])
    order = np.arange(1, balance.harmonics + 1)[:, None]
    contact = np.array([_contact_force(trial) for trial in trials])
    by_direction = _work(order, np.array([trial.relative for trial in trials]), contact).reshape(len(trials), -1, 3)
    means = np.array([trial.relative[0] for trial in trials])
    # A body that walks slides on against the mean traction; the static load, which the tractions at rest balance, works
    # on this way too.
    walk, at_rest = balance.pairs.walk(means)[:, :, :2], balance.pairs.resting_traction
    by_direction[:, :, :2] += (contact[:, 0].reshape(len(trials), -1, 3)[:, :, :2] + at_rest) * walk
    # Springs do no work in a period. A pair with friction that sticks but just reaches its limit creeps, and does.
    state = np.array([trial.contact.state for trial in trials])
    moves = np.array([trial.contact.moves.any(axis=1) for trial in trials])
    creeps = moves & balance.pairs.frictional().reshape(-1, 3).any(axis=1)
    by_direction[(state == ContactState.STUCK) & ~creeps] = 0.0
    quadratic = balance.compliance.gain.viscous_power(np.array([trial.amplitude for trial in trials]))
    viscous = np.pi * omega * (quadratic * order[:, 0] ** 2).sum(axis=1)
    applied = balance.applied(trials) + _self_excitation(trials, displacement, equation)
    residual = _equation_residuals(trials, displacement, contact, applied, balance, equation)
    # The input is the work of the force; its sign convention makes it positive where energy goes in.
    work_of_force = _work(order, displacement, applied).sum(axis=1) + (at_rest * walk).sum(axis=(1, 2))
    kinetic = equation.kinetic_energy(displacement, omega)
    return CurveMeasures(
        displacement, by_direction.sum(axis=2), by_direction[:, :, 2], work_of_force, viscous, kinetic, residual
    )


def work_per_cycle(trial: Trial) -> FloatArray:
    """(m,) J, work of a trial motion on its contact forces in one period."""
    motion, force = trial.relative[None], _contact_force(trial)[None]
    return np.asarray(_work(np.arange(1, _harmonics(trial) + 1)[:, None], motion, force)[0])


def _contact_force(trial: Trial) -> FloatArray:
    """(2H+1, m) N."""
    return np.asarray(trial.contact.force.reshape(trial.relative.shape[1], -1).T)


def _self_excitation(trials: Sequence[Trial], displacement: FloatArray, equation: EquationOfMotion) -> FloatArray:
    """(n_points, 2H+1, n) N, the force ``xi M u'`` that sustains nonlinear modes; zero for all other motions."""
    growth, omega = (np.array([getattr(trial, name) for trial in trials]) for name in ("growth", "omega"))
    force = np.zeros_like(displacement)
    if growth.any():
        momentum = equation.momentum(displacement)
        order = np.arange(1, displacement.shape[1] // 2 + 1)[:, None]
        factor = (growth * omega)[:, None, None] * order
        force[:, 1::2], force[:, 2::2] = factor * momentum[:, 2::2], -factor * momentum[:, 1::2]
    return force


def _work(order: Orders, motion: FloatArray, force: FloatArray) -> FloatArray:
    """Work (n_points, m) in one period of coefficients ``force`` on ``motion``, both (n_points, 2H+1, m):
    ``pi sum_h h (s_h f_ch - c_h f_sh)``."""
    product = motion[:, 2::2] * force[..., 1::2, :] - motion[:, 1::2] * force[..., 2::2, :]
    return np.asarray(np.pi * (order * product).sum(axis=1))


def _equation_residuals(
    trials: Sequence[Trial],
    displacement: FloatArray,
    contact: FloatArray,
    applied: FloatArray,
    balance: Balance,
    equation: EquationOfMotion,
) -> FloatArray:
    """``|Z u + B^T f - p| / (|p| + |B^T f|)`` of each point over all harmonics, in the unknowns of the superelement.

    A motion without a load has its inertial forces in the denominator too.
    """
    means = np.array([trial.relative[0] for trial in trials])
    contact = contact.copy()
    contact[:, 0].reshape(len(trials), -1, 3)[:, :, :2] += balance.compliance.restraint_force(means)
    joint = equation.joint_force(contact)
    order = np.arange(1, balance.harmonics + 1)[:, None] * np.array([trial.omega for trial in trials])[:, None, None]
    left = equation.elastic_force(displacement) + joint - applied
    inertia = equation.momentum(displacement)[:, 1:]
    viscous = equation.viscous_term(displacement)[:, 1:]
    left[:, 1::2] += -(order**2) * inertia[:, 0::2] + order * viscous[:, 1::2]
    left[:, 2::2] += -(order**2) * inertia[:, 1::2] - order * viscous[:, 0::2]
    scale = np.linalg.norm(applied, axis=(1, 2)) + np.linalg.norm(joint, axis=(1, 2))
    is_free = np.array([trial.load == 0.0 for trial in trials])
    scale += is_free * np.linalg.norm(np.repeat(order, 2, axis=1) ** 2 * inertia, axis=(1, 2))
    return np.asarray(np.linalg.norm(left, axis=(1, 2)) / scale)
