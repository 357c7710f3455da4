"""What makes the nonlinear mode of a study doubtful: its reduction, a node at the output, amplitudes that it misses."""

from __future__ import annotations

import math

from stickslip.case.analysis import ModeAnalysis
from stickslip.case.case import Case
from stickslip.core.errors import ConvergenceError, InputError, SingularMatrixError
from stickslip.core.validation import FloatArray
from stickslip.model.model import Model
from stickslip.results.nonlinear_mode import POOR_REDUCTION, NonlinearMode
from stickslip.solve.harmonic.mode_shapes import LEAST_MAC, sliding_stiffness
from stickslip.structure.full_mode import NEAREST, closest_full_mode
from stickslip.study.mode import FirstMotion, linear_mode

# chosen: relative errors of a frequency above which a run warns of the reduction, and above which it has no result. The
# error of an eigenvalue is that of the kinetic energy, so a mode 10 % off has a third of its motion elsewhere.
DOUBTFUL_FREQUENCY, WRONG_FREQUENCY = 0.01, 0.1
WRONG_MAC = 0.5  # chosen: below it most of the motion is in other modes
# chosen: motion of an output over the largest one of its mode below which the mode has a node close to it. Shapes of a
# reduction are right to about this part: the first modes of the default study to 0.1 to 1 %.
NODE = 1e-2
# chosen: relative difference of an amplitude from the one that was asked for.
LARGEST_DIFFERENCE = 0.05


def reduction_doubts(case: Case, model: Model) -> tuple[str, ...]:
    """A warning of a mode that the reduction represents poorly; none for matrices, which have no full model.

    Raises InputError for a mode that the reduced structure does not have, or that the full model does not have.
    """
    analysis, full = case.analysis, model.in_study.full_model
    if not isinstance(analysis, ModeAnalysis) or full is None:
        return ()
    linear, pairs = linear_mode(analysis, model), model.pairs
    springs = pairs.resting_stiffness() if analysis.limit == "stuck" else sliding_stiffness(pairs)
    frequency_hz, motion = linear.omega / (2.0 * math.pi), model.superelement.recovery @ linear.shape
    try:
        closest = closest_full_mode(full, model.joint.face_pairs, springs, motion, frequency_hz)
    except (ConvergenceError, SingularMatrixError) as error:
        return (f"Mode {analysis.mode} was not compared with that of the full model: {error}",)
    change = frequency_hz / closest.frequency_hz - 1.0
    has = (
        f"it has {frequency_hz:.2f} Hz, but of the {NEAREST} modes of the full model near it, the one that resembles "
        f"it most has {closest.frequency_hz:.2f} Hz ({100 * change:+.2g} %) and a MAC of {closest.mac:.2f}"
    )
    advice = f"Give more modes in [reduction] (now {case.reduction.modes}), or a lower mode."
    if abs(change) > WRONG_FREQUENCY or closest.mac < WRONG_MAC:
        raise InputError(
            f"mode is {analysis.mode}, which is not a mode of the full model: {has} (required: within "
            f"{100 * WRONG_FREQUENCY:g} % and {WRONG_MAC:g}). {advice}",
            ("analysis.mode",),
        )
    if abs(change) <= DOUBTFUL_FREQUENCY and closest.mac >= LEAST_MAC:
        return ()
    return (
        f"{POOR_REDUCTION} {analysis.mode} poorly: {has} (usual: within {100 * DOUBTFUL_FREQUENCY:g} % "
        f"and {LEAST_MAC:g}). Frequency, damping ratio and shape of the nonlinear mode have errors of this size. "
        f"{advice}",
    )


def node_doubts(name: str, first: FirstMotion, analysis: ModeAnalysis) -> tuple[str, ...]:
    """A warning of a mode that hardly moves the first output, ``name``."""
    if first.share >= NODE:
        return ()
    largest = 1e3 * analysis.largest_amplitude / first.share
    return (
        f'The linear mode moves the output "{name}" by only {first.share:.1g} of its largest motion: the output is '
        f"close to a node, so its amplitude determines that of the mode poorly. At largest_amplitude another place "
        f"moves by {largest:.3g} mm. Choose another first output.",
    )


def amplitude_doubts(mode: NonlinearMode, name: str, output: FloatArray, analysis: ModeAnalysis) -> tuple[str, ...]:
    """A warning where the first output, ``name`` with the row ``output`` (n,), does not move as the study asks at the
    ends of a mode: its amplitudes hold in the shape of the linear mode."""
    moved = mode.harmonic_amplitude(output, 1)
    at_ends = {
        "smallest": (float(moved[mode.modal_amplitude.argmin()]), analysis.smallest_amplitude),
        "largest": (float(moved[mode.modal_amplitude.argmax()]), analysis.largest_amplitude),
    }
    if not mode.converged:
        del at_ends["largest" if mode.limit == "stuck" else "smallest"]  # not reached
    missed = [
        f"by {1e6 * actual:.4g} um at the {end} amplitude, not by {1e6 * asked:.4g} um "
        f"({100 * (actual / asked - 1):+.3g} %)"
        for end, (actual, asked) in at_ends.items()
        if abs(actual / asked - 1.0) > LARGEST_DIFFERENCE
    ]
    if not missed:
        return ()
    return (
        f'The first harmonic moves the output "{name}" {" and ".join(missed)}: the amplitudes of the study hold in the '
        "shape of the linear mode, and the shape changes. Change smallest_amplitude and largest_amplitude if you need "
        "others.",
    )
