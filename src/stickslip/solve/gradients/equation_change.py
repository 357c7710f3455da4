"""Change of the equation of motion with a parameter at a fixed motion, as its virtual work on adjoint motions.

A value q of a point of a curve changes with a parameter p by

    dq/dp = v . (P' - Z' u - B'^T f - B^T f') + (z - k B v) . B' u + q_o . o' + q_f . f'

with the motion u, the contact force f at fixed x = B u, the springs k, the output row o, the adjoint motion v and the
multipliers z (``adjoint.py``). A prime is the derivative at fixed x and w: no term requires another solution.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from stickslip.contact.law.contact_pairs import ContactPairs
from stickslip.core.validation import FloatArray
from stickslip.solve.gradients.adjoint import Adjoint, Motions
from stickslip.solve.harmonic.balance import Trial
from stickslip.solve.harmonic.damping import DAMPED_RANGE, modal_damping_change
from stickslip.solve.setting_up import Balances
from stickslip.solve.solver_input import SolverInput

# chosen: on the full mesh, the derivative of modal damping contains the stuck modes up to this multiple of the damped
# range; higher ones are quasi-static in the motion and have no damping.
MODES_ON_MESH = 2.0


class ChangedEquation:
    """Derivatives of values of points by parameters, from the input for two values of each parameter.

    Parameters
    ----------
    balances:
        those of the curve.
    base:
        the input from which they were made.
    adjoints:
        values of points.
    """

    def __init__(self, balances: Balances, base: SolverInput, adjoints: Sequence[Adjoint]) -> None:
        self._balances, self._base, self._adjoints = balances, base, adjoints
        self._keeps_traction = base.pairs.released and not balances.pairs.released
        self._spaces: dict[bool, Motions] = {}
        self._samples = adjoints[0].place.balance.samples
        # Points of several adjoints are evaluated once.
        self._places = {adjoint.place.place: adjoint.place for adjoint in adjoints}

    def derivative(self, first: SolverInput, second: SolverInput, distance: float) -> FloatArray:
        """(k,) derivative of each value, from inputs for two values of the parameter that differ by ``distance``."""
        work = np.zeros(len(self._adjoints))
        work -= self._work_of_matrices(first, second, distance)
        if second.excitation is not first.excitation or second.superelement is not first.superelement:
            work += self._work_of_excitation(first, second, distance)
        if second.pairs is not first.pairs:
            work += self._work_of_contact(first.pairs, second.pairs, distance)
        change = (second.output - first.output) / distance
        if change.any():
            work += [self._by_output(adjoint, change) for adjoint in self._adjoints]
        return work

    @staticmethod
    def _by_output(adjoint: Adjoint, change: FloatArray) -> float:
        weights = adjoint.value.by_coefficients
        if not weights.size:
            return 0.0
        place = adjoint.place
        return float(weights @ (place.balance.displacement([place.point.trial])[0] @ change))

    def _work_of_excitation(self, first: SolverInput, second: SolverInput, distance: float) -> FloatArray:
        harmonics = self._adjoints[0].place.balance.harmonics
        forces = [each.excitation.on(each.superelement, harmonics) for each in (first, second)]

        def work(adjoint: Adjoint) -> float:
            before, after = (force.coefficients(adjoint.place.point.trial.omega) for force in forces)
            return float((adjoint.motion * (after - before)).sum()) / distance

        return np.array([work(adjoint) for adjoint in self._adjoints])

    def _work_of_contact(self, first: ContactPairs, second: ContactPairs, distance: float) -> FloatArray:
        first, second = self._as_solved(first), self._as_solved(second)
        operator = (second.operator - first.operator) / distance
        turns = bool(operator.any())
        changes = {
            at: (self._force(second, place.point.trial) - self._force(first, place.point.trial)) / distance
            for at, place in self._places.items()
        }

        def work(adjoint: Adjoint) -> float:
            place, base = adjoint.place, self._balances.pairs.operator
            change, at_pairs = changes[place.place], adjoint.motion @ base.T
            total = float(((adjoint.value.by_force - at_pairs) * change).sum())
            if turns:
                motion = place.balance.displacement([place.point.trial])[0] @ operator.T
                force = place.point.trial.contact.force.reshape(base.shape[0], -1).T
                total -= float(((adjoint.motion @ operator.T) * force).sum())
                total += float(((adjoint.multipliers - place.balance.springs * at_pairs) * motion).sum())
            return total

        return np.array([work(adjoint) for adjoint in self._adjoints])

    def _as_solved(self, pairs: ContactPairs) -> ContactPairs:
        """Pairs with the return and the treatment of tractions of the curve."""
        pairs = pairs.with_update(self._balances.update)
        return pairs.retaining() if self._keeps_traction else pairs

    def _force(self, pairs: ContactPairs, trial: Trial) -> FloatArray:
        """(2H+1, m) N, the contact force of pairs under the relative displacements of a trial."""
        coefficients = np.ascontiguousarray(trial.relative.T).reshape(pairs.n_pairs, 3, -1)
        force = pairs.period(coefficients, self._samples).force
        return np.asarray(force.reshape(3 * pairs.n_pairs, -1).T)

    def _work_of_matrices(self, first: SolverInput, second: SolverInput, distance: float) -> FloatArray:
        """``v . Z' u`` of the structure and its damping."""
        on_mesh = first.structure is not None
        motions = self._motions(first.structure)
        work = np.zeros(len(self._adjoints))
        forms: dict[str, FloatArray] = {}
        ratio = self._base.modal_damping_ratio
        for place, name in enumerate(("stiffness", "mass")):
            before, after = (
                getattr(each.structure if on_mesh else each.superelement, name) for each in (first, second)
            )
            change = None if before is after else (after - before) / distance
            if change is None or not abs(change).max() > 0.0:
                continue
            work += motions.static_work(change) if name == "stiffness" else motions.inertial_work(change)
            if on_mesh:
                factor = first.rayleigh[1 - place]
                work += factor * motions.viscous_work(change) if factor else 0.0
            if ratio:
                forms[name] = motions.modal_form(change)
        before, after = first.superelement.damping, second.superelement.damping
        if before is not after and before is not None and after is not None:
            work += self._motions(None).viscous_work((after - before) / distance)
        if ratio is None:
            return work
        if second.pairs is not first.pairs:
            springs = self._springs_in_modes(first.pairs, second.pairs, distance, len(motions.modes))
            forms["stiffness"] = forms.get("stiffness", 0.0) + springs
        if ratio and forms:
            omega, highest = self._balances.stuck.circular_frequency, self._balances.stuck.highest_omega
            change = modal_damping_change(omega[: len(motions.modes)], ratio, highest, **forms)
            work += motions.modal_viscous_work(change)
        assert first.modal_damping_ratio is not None
        assert second.modal_damping_ratio is not None
        more = (second.modal_damping_ratio - first.modal_damping_ratio) / distance
        if more:
            omega = self._balances.stuck.circular_frequency[: len(motions.modes)]
            damped = omega <= DAMPED_RANGE * self._balances.stuck.highest_omega
            work += motions.modal_viscous_work(np.diag(2.0 * more * omega * damped))
        return work

    def _motions(self, structure: Any) -> Motions:
        """The motions in the unknowns, or in those of a full structure."""
        on_mesh = structure is not None
        if on_mesh not in self._spaces:
            stuck, base = self._balances.stuck, self._base
            modes = stuck.modes.T
            if on_mesh:
                highest = MODES_ON_MESH * DAMPED_RANGE * stuck.highest_omega
                modes = modes[: int(np.searchsorted(stuck.circular_frequency, highest))]

            def lift(rows: FloatArray, squares: FloatArray) -> FloatArray:
                return np.asarray(base.superelement.recovery.vibrating(rows.T, squares).T) if on_mesh else rows

            self._spaces[on_mesh] = Motions(self._adjoints, modes, lift)
        return self._spaces[on_mesh]

    def _springs_in_modes(self, first: ContactPairs, second: ContactPairs, distance: float, count: int) -> FloatArray:
        """(count, count) derivative of ``phi^T B^T k B phi`` for the springs at rest."""
        forms = []
        for pairs in (first, second):
            rows = pairs.operator @ self._balances.stuck.modes[:, :count]
            forms.append(rows.T @ (pairs.resting_stiffness()[:, None] * rows))
        return np.asarray((forms[1] - forms[0]) / distance)
