"""What is kept of a converged point: displacement, energies per cycle, and the residual of the equation of motion."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from stickslip.solve.balance import Balance, Trial
from stickslip.solve.compliance import StuckStructure
from stickslip.structure.superelement import Superelement
from stickslip.validation import FloatArray

Orders = NDArray[np.int64]


@dataclass(frozen=True)
class PointMeasures:
    """What is kept of a converged point."""

    displacement: FloatArray  # (2H+1, n) m
    dissipated_energy: FloatArray  # (n_pairs,) J per cycle
    input_energy: float
    viscous_energy: float
    residual: float


def measure_point(trial: Trial, balance: Balance, superelement: Superelement, stuck: StuckStructure) -> PointMeasures:
    """Displacement, energies per cycle, and the residual of the equation of motion itself."""
    omega, force = trial.omega, balance.force
    displacement = balance.displacement(trial)
    contact = trial.contact.force.reshape(balance.rows, -1).T
    order = np.arange(1, balance.harmonics + 1)[:, None]
    # Work of a force on a motion in one period: pi * sum_h h (s_h . fc_h - c_h . fs_h).
    work = _work(order, trial.relative, contact)
    per_pair = work.reshape(-1, 3).sum(axis=1)
    per_pair[trial.contact.state == 0] = 0.0
    viscous = np.pi * omega * (order**2 * _damping_form(displacement, stuck.damping)).sum()
    residual = _equation_residual(trial, displacement, contact, balance, superelement, stuck)
    # The input is the work of the force; its sign convention makes it positive where energy goes in.
    return PointMeasures(
        displacement, per_pair, float(_work(order, displacement, force).sum()), float(viscous), residual
    )


def _work(order: Orders, motion: FloatArray, force: FloatArray) -> FloatArray:
    """Work (m,) in one period of coefficients ``force`` on ``motion``, both (2H+1, m)."""
    return np.asarray(np.pi * (order * (motion[2::2] * force[1::2] - motion[1::2] * force[2::2])).sum(axis=0))


def _damping_form(displacement: FloatArray, damping: FloatArray) -> FloatArray:
    """``c_h C c_h + s_h C s_h`` (H, 1)."""
    quadratic: FloatArray = (displacement[1:] * (displacement[1:] @ damping)).sum(axis=1)
    return (quadratic[0::2] + quadratic[1::2])[:, None]


def _equation_residual(
    trial: Trial,
    displacement: FloatArray,
    contact: FloatArray,
    balance: Balance,
    superelement: Superelement,
    stuck: StuckStructure,
) -> float:
    """``|Z u + B^T f - p| / (|p| + |B^T f|)`` over all harmonics, in the unknowns of the superelement."""
    omega, operator = trial.omega, balance.pairs.operator
    restraint = stuck.compliance.mean_restraint * balance.pairs.tangential_springs
    contact = contact.copy()
    contact[0].reshape(-1, 3)[:, :2] += restraint * trial.relative[0].reshape(-1, 3)[:, :2]
    joint = contact @ operator
    order = np.arange(1, balance.harmonics + 1)[:, None] * omega
    left = displacement @ superelement.stiffness + joint - trial.load * balance.force
    inertia, viscous = displacement[1:] @ superelement.mass, displacement[1:] @ stuck.damping
    left[1::2] += -(order**2) * inertia[0::2] + order * viscous[1::2]
    left[2::2] += -(order**2) * inertia[1::2] - order * viscous[0::2]
    return float(np.linalg.norm(left) / (np.linalg.norm(balance.force) + np.linalg.norm(joint)))
