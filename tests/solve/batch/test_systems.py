"""The stacked equations are those of the ordinary balance, curve by curve: residuals, Newton steps, directions."""

from __future__ import annotations

import numpy as np
import pytest

from batch_inputs import row_of_masses
from stickslip.solve.batch.equations import StackedBalance
from stickslip.solve.batch.systems import Planes, solutions, steps_and_directions
from stickslip.solve.excitation import Excitation
from stickslip.solve.harmonic.curves import FrequencyCurve
from stickslip.solve.path.problem import Plane
from stickslip.solve.setting_up import Balances, prepare_balances
from stickslip.solve.solver_input import SolverInput

HARMONICS, SAMPLES = 3, 32
COUPLED = 2.0 * np.array([[4.0, 1.0, 0.0], [1.0, 5.0, 2.0], [0.0, 2.0, 6.0]])


def balances_of(given: SolverInput) -> Balances:
    return prepare_balances(
        given.superelement, given.pairs, given.excitation, 1500.0, HARMONICS, SAMPLES, given.modal_damping_ratio,
        "tractrix", lambda words: None,
    )  # fmt: skip


@pytest.mark.parametrize("kind", ["diagonal", "coupled", "unbalance", "kept", "gap"])
def test_a_step_of_newton_is_that_of_each_curve(kind: str) -> None:
    options: dict[str, dict[str, object]] = {
        "diagonal": {},
        "coupled": {"damping": COUPLED, "damping_ratio": None},
        "unbalance": {"excitation": Excitation.unbalance([1.0, 0.0, 0.0], [0.0, 1.0, 0.0], 1e-4)},
        "kept": {"residual_traction": np.array([[2.0, -1.0]])},
        "gap": {"preload": -1.0},
    }
    inputs = [row_of_masses(force=force, mass=mass, **options[kind]) for force, mass in ((60.0, 1.0), (90.0, 1.1))]  # type: ignore[arg-type]
    curves = [balances_of(each) for each in inputs]
    together = StackedBalance.of(curves, HARMONICS)
    omega = np.array([1000.0, 1100.0])
    relative = together.linear(omega)
    trial = together.evaluate(relative, omega)
    assert trial.moves.any(axis=1).all()
    weights = together.determined(np.random.default_rng(0).standard_normal(relative.shape)) * 1e4
    planes = Planes(weights, np.array([0.01, 0.02]), np.array([0.1, 0.2]), 1.01 * omega)
    step, along = steps_and_directions(together, trial, np.arange(2), planes)
    for i, each in enumerate(curves):
        curve = FrequencyCurve(each.exact(HARMONICS, SAMPLES))
        point = curve.at(relative[i].T, omega[i])
        assert trial.error[i] == pytest.approx(point.error, rel=1e-12)
        np.testing.assert_allclose(trial.residual[i].T, point.residual, atol=1e-13 * np.abs(point.residual).max())
        plane = Plane(weights[i].T, planes.weight[i], np.zeros_like(relative[i].T), planes.anchor_omega[i])
        system = curve.linearised(point, plane)
        defect = float(planes.defect(trial.relative, omega)[i])
        for changes, wanted in (
            (step, system.solve(point.residual, point.conditions, defect, 1e-12)),
            (along, system.solve(np.zeros_like(point.residual), point.conditions, -1.0, 1e-12)),
        ):
            size = np.abs(wanted.unknowns).max()
            np.testing.assert_allclose(changes.relative[i].T, wanted.unknowns, atol=1e-11 * size)
            assert changes.omega[i] == pytest.approx(float(wanted.parameters[0]), rel=1e-10)
            motion = curve.measured_change(point, wanted)
            complex_motion = (motion[0::2] - 1j * motion[1::2]).T
            np.testing.assert_allclose(changes.amplitude[i], complex_motion, atol=1e-11 * np.abs(motion).max())


def test_a_singular_system_spoils_no_other() -> None:
    matrix = np.stack([np.eye(2), np.zeros((2, 2)), 2.0 * np.eye(2)])
    solution = solutions(matrix, np.ones((3, 2, 1)))
    np.testing.assert_array_equal(solution[:, 0, 0], [1.0, np.nan, 0.5])
