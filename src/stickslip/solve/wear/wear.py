"""Wear of the pairs of a joint under vibration: depth against the number of cycles.

Each cycle removes from a pair of area ``A_i`` the volume ``alpha_i E_i``, so that its depth ``h_i`` grows by

    d h_i / d n = alpha_i E_i(h) / A_i,

with the friction energy ``E_i`` of a cycle in the periodic motion. By Archard the volume is ``K`` times the integral
of normal force times slip; friction is ``mu_i N`` while a pair slips, which is the same with ``alpha_i = K / mu_i``.
Material that is removed opens the joint: with the gaps ``h`` the joint is at rest under other normal loads, from its
static equilibrium. Many cycles pass in one step of a Runge-Kutta method, with an estimate of its error; nothing is
assumed of the motion but that it is periodic at each stage (docs/theory_wear.md).
"""

from __future__ import annotations

import time
from collections.abc import Iterator
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import ArrayLike
from scipy.integrate import RK23

from stickslip.contact.law.contact_pairs import ContactPairs
from stickslip.contact.law.coulomb import CoulombLaw
from stickslip.contact.law.coulomb_harmonics import Update
from stickslip.core.completeness import reported
from stickslip.core.errors import ConvergenceError
from stickslip.core.progress import ProgressCallback
from stickslip.core.threads import solver_threads, thread_count
from stickslip.core.validation import (
    FloatArray,
    argument_error,
    finite_array,
    per_pair,
    positive_number,
    real_number,
    require_allowed,
    require_positive,
)
from stickslip.results.wear import Wear
from stickslip.solve.excitation import Excitation
from stickslip.solve.path.newton import NewtonSettings
from stickslip.solve.ridges.ridge_stage import RidgeOptions
from stickslip.solve.setting_up import StageReport, checked_window
from stickslip.solve.wear.wear_motion import WornState, WornVibration
from stickslip.solve.wear.worn_joint import WornJoint, WornStiffness
from stickslip.structure.superelement import Superelement

# chosen: more states show nothing more; the message gives the cycles that were reached.
MOST_STATES = 300
# chosen: range of the accuracy; below, sampled friction has no such digits.
FINEST, COARSEST = 1e-5, 0.2
# chosen: few states, because each takes the time of about two curves.
DEFAULT_ACCURACY = 0.02
# chosen: the first step wears this fraction of the largest closure at most.
FIRST_WEAR = 0.1


def wear(
    superelement: Superelement,
    pairs: ContactPairs,
    excitation: Excitation,
    output: ArrayLike,
    *,
    area: ArrayLike,
    energy_wear_coefficient: ArrayLike,
    cycles: float,
    frequency_hz: tuple[float, float] | float,
    accuracy: float = DEFAULT_ACCURACY,
    stiffness: WornStiffness | None = None,
    harmonics: int = 5,
    samples: int = 256,
    modal_damping_ratio: float | None = None,
    update: Update = "tractrix",
    newton: NewtonSettings | None = None,
    threads: int | None = None,
    progress: ProgressCallback | None = None,
    raise_on_failure: bool = False,
) -> Wear:
    """Wear of the pairs over many cycles of vibration.

    ``d h_i / d n = alpha_i E_i(h) / A_i`` in steps of many cycles, with normal loads and gaps from the static
    equilibrium of the worn joint, and the friction energy ``E_i`` from its periodic motion. Theory:
    docs/theory_wear.md.

    Parameters
    ----------
    superelement, pairs, excitation:
        as in :func:`forced_response`; the pairs are all of Coulomb friction and begin without tractions. Loads and gaps
        are those before the wear.
    output:
        (n,) row whose amplitude is reported; with a range of frequencies its highest peak is the motion of the wear.
    area:
        one number or (n_pairs,) m2.
    energy_wear_coefficient:
        alpha in m3/J, one number or (n_pairs,): volume that both faces of a pair lose together for each joule of
        friction. Archard's coefficient in m3/(N m) over the friction coefficient is the same.
    cycles:
        number of cycles.
    frequency_hz:
        a number: the joint vibrates at this frequency. (start, stop): it vibrates at the highest peak in this range,
        whatever its frequency; at each state the whole frequency curve shows which peak that is.
    accuracy:
        error of the depth in one step, as a fraction of the largest elastic closure of the pairs at rest: depth against
        closure is what changes normal loads. From 1e-5 to 0.2.
    stiffness:
        function of normal forces (n_pairs,) N and worn depths (n_pairs,) m that gives the normal and the tangential
        stiffness (n_pairs,) in N/m, for example of a roughness that runs in; None keeps the springs.
    harmonics, samples, modal_damping_ratio, update, newton, threads, progress, raise_on_failure:
        as in :func:`forced_response`.

    Returns
    -------
    Wear
        with the states that were reached; ``converged`` is False if the wear ends early, and ``message`` says why.

    Raises
    ------
    InputError
        for inputs that cannot be used, pairs of other laws, pairs that keep tractions, and a joint that is open.
    ConvergenceError
        if there is no motion before the wear.
    """
    result = unreported_wear(
        superelement, pairs, excitation, output, area=area, energy_wear_coefficient=energy_wear_coefficient,
        cycles=cycles, frequency_hz=frequency_hz, accuracy=accuracy, stiffness=stiffness, harmonics=harmonics,
        samples=samples, modal_damping_ratio=modal_damping_ratio, update=update, newton=newton, threads=threads,
        progress=progress,
    )  # fmt: skip
    return reported(result, raise_on_failure)


def unreported_wear(
    superelement: Superelement, pairs: ContactPairs, excitation: Excitation, output: ArrayLike, *, area: ArrayLike,
    energy_wear_coefficient: ArrayLike, cycles: float, frequency_hz: tuple[float, float] | float, accuracy: float,
    stiffness: WornStiffness | None, harmonics: int, samples: int, modal_damping_ratio: float | None, update: Update,
    newton: NewtonSettings | None, threads: int | None, progress: ProgressCallback | None,
) -> Wear:  # fmt: skip
    """:func:`wear`, for a caller that reports a wear that ends early itself."""
    began = time.perf_counter()
    row, areas = finite_array("output", output), per_pair("area", area, pairs.n_pairs)
    require_positive("area", areas, "Depth is volume over area.")
    alpha = per_pair("energy_wear_coefficient", energy_wear_coefficient, pairs.n_pairs)
    require_positive("energy_wear_coefficient", alpha, "Usual values of metals are 1e-15 to 1e-12 m3/J.")
    count = positive_number("cycles", cycles)
    tolerance = real_number("accuracy", accuracy)
    require_allowed("accuracy", tolerance, FINEST <= tolerance <= COARSEST, f"between {FINEST:g} and {COARSEST:g}")
    if row.shape != (superelement.size,) or not row.any():
        raise argument_error(
            "output",
            f"output must be a row of shape ({superelement.size},) that is not zero, but its shape is {row.shape}.",
        )
    require_wearing_pairs(pairs)
    at, window = _operation(frequency_hz)
    options = RidgeOptions(window, harmonics, samples, update, newton or NewtonSettings())
    report = StageReport(progress)
    with solver_threads(thread_count(threads)):
        joint = WornJoint(superelement, pairs, stiffness)
        vibration = WornVibration(joint, excitation, row, options, at, modal_damping_ratio, report)
        history = _worn(vibration, alpha / areas, count, tolerance, report)
    states = history.states
    return Wear(
        cycles=np.array(history.cycles),
        depth=np.array(history.depth),
        normal_load=np.array([np.maximum(each.pairs.preload, 0.0) for each in states]),
        friction_energy=np.array([each.energy for each in states]),
        amplitude=np.array([each.amplitude for each in states]),
        frequency_hz=np.array([each.frequency_hz for each in states]),
        normal_stiffness=np.array([each.pairs.coulomb.normal_stiffness for each in states]),
        area=areas,
        energy_wear_coefficient=alpha,
        converged=not history.trouble,
        message=history.trouble or f"The wear covers {count:.4g} cycles.",
        warnings=tuple(history.warnings(vibration.unrefined)),
        settings={
            "cycles": count,
            "accuracy": tolerance,
            "motion": "highest peak" if at is None else f"{at:g} Hz",
            "harmonics": harmonics,
            "samples": samples,
            "motions": vibration.motions,
            "whole_curves": vibration.curves,
        },
        provenance={"solve_seconds": f"{time.perf_counter() - began:.2f}"},
    )


def require_wearing_pairs(pairs: ContactPairs) -> None:
    """Raise InputError for pairs whose wear is not defined here."""
    if pairs.law_names != (CoulombLaw.name,):
        raise argument_error(
            "pairs",
            f"the pairs follow the laws {', '.join(pairs.law_names)}, but wear requires Coulomb friction in all of "
            "them: the others have no slip under a normal load, or no open pairs.",
        )
    if not pairs.released:
        raise argument_error(
            "residual_traction",
            "some pairs retain a traction at rest, but wear removes the material that carries it. Release the "
            "tractions.",
        )
    if not (pairs.preload > 0.0).any():
        raise argument_error(
            "normal_load", "no pair is closed at rest, so nothing presses the joint while it wears. Give a normal load."
        )


def _operation(frequency_hz: tuple[float, float] | float) -> tuple[float | None, tuple[float, float]]:
    """The fixed frequency or None, and the range of the equations. Raises InputError."""
    if isinstance(frequency_hz, int | float):
        at = positive_number("frequency_hz", frequency_hz, "Hz")
        return at, (0.99 * at, at)
    return None, checked_window(frequency_hz)


@dataclass
class _History:
    """Accepted states with their cycles and depths, and why they end early, "" if they do not."""

    states: list[WornState] = field(default_factory=list)
    cycles: list[float] = field(default_factory=list)
    depth: list[FloatArray] = field(default_factory=list)
    switches: list[float] = field(default_factory=list)
    trouble: str = ""

    def add(self, state: WornState, cycles: float, depth: FloatArray) -> None:
        """Add a state."""
        self.states.append(state)
        self.cycles.append(cycles)
        self.depth.append(depth)

    def end(self, why: str) -> _History:
        """The states so far, which end early."""
        self.trouble = f"The wear ends at {self.cycles[-1]:.4g} cycles: {why}"
        return self

    def warnings(self, unrefined: int) -> Iterator[str]:
        """Sentences on what the states do not show; ``unrefined`` motions are not quite at a peak."""
        if unrefined:
            yield (
                f"{unrefined} of the motions are those of the highest point of a frequency curve, because no peak was "
                "found near it; their amplitudes may be slightly low."
            )
        if self.switches:
            places = ", ".join(f"{each:.4g}" for each in self.switches)
            yield (
                f"Another peak was the highest after {places} cycles, and the wear continues with its motion: "
                "frequency and energy jump there, within the step before."
            )


def _worn(vibration: WornVibration, rate: FloatArray, cycles: float, accuracy: float, report: StageReport) -> _History:
    """The wear over the cycles; ``rate`` (n_pairs,) m/J. Raises ConvergenceError without a first motion."""
    history, depth = _History(), np.zeros(rate.size)
    report.stage("motion before the wear", 0.0)
    first = vibration.accept(vibration.state_after(depth))
    history.add(first, 0.0, depth)
    closure = float((np.maximum(first.pairs.preload, 0.0) / first.pairs.coulomb.normal_stiffness).max())
    speed = float((rate * first.energy).max())
    if speed == 0.0:
        history.add(first, cycles, depth)
        return history
    latest = first

    def slope(_: float, worn: FloatArray) -> FloatArray:
        nonlocal latest
        latest = vibration.state_after(worn)
        return rate * latest.energy

    try:
        step = min(cycles, FIRST_WEAR * closure / speed)
        solver = RK23(slope, 0.0, depth, cycles, first_step=step, rtol=1e-12, atol=accuracy * closure)
        while solver.status == "running":
            if len(history.states) == MOST_STATES:
                return history.end(f"{MOST_STATES} states are the most. Give fewer cycles, or a coarser accuracy.")
            trouble = solver.step()
            if solver.status == "failed":
                return history.end(f"{trouble}")
            # The last stage of the method is the motion at the end of the step, and its first one in the next.
            state = vibration.accept(latest)
            if state is not latest:
                history.switches.append(float(solver.t))
                solver.f = rate * state.energy
            history.add(state, float(solver.t), solver.y.copy())
            report.stage(f"{solver.t:.3g} of {cycles:.3g} cycles", min(solver.t / cycles, 0.999))
    except ConvergenceError as error:
        return history.end(str(error))
    return history
