"""Measures of each contact pair over one period: sticking, slipping and separated times, slip distance, pressure."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from stickslip.contact.law.friction_law import FrictionLaw
from stickslip.contact.law.jenkins import JenkinsElement
from stickslip.core.errors import InputError
from stickslip.core.short_repr import short_repr
from stickslip.core.validation import FloatArray, positive_number
from stickslip.results.response import ForcedResponse

# chosen: a slider that moves less than this fraction of the motion of its pair in a sample does not slip. Its position
# is a difference of numbers of the size of the motion, so round-off is 1e-15 of it.
AT_REST = 1e-9


@dataclass(frozen=True)
class PairMeasures:
    """The contact pairs over one period at one point of the curve; all arrays are (n_pairs,).

    state:
        codes of :class:`stickslip.ContactState`: 0 stuck, 1 stick-slip, 2 separating.
    stick_fraction, slip_fraction, separated_fraction:
        of the period; they sum to 1. NaN for laws without one slider: cubic, elastic-stop, iwan, laws of the user.
    slip_distance:
        m per cycle, path of the slider in contact, ``sum |w_j - w_(j-1)|`` over the samples. NaN for the same laws.
        Without the steady walk of a body that nothing holds.
    mean_normal_force:
        N, mean over the period, the load at rest included; laws that are bonded along n and have no normal load count
        it from rest.
    normal_load:
        N at rest.
    dissipated_energy:
        J per cycle.
    """

    state: NDArray[np.int8]
    stick_fraction: FloatArray
    slip_fraction: FloatArray
    separated_fraction: FloatArray
    slip_distance: FloatArray
    mean_normal_force: FloatArray
    normal_load: FloatArray
    dissipated_energy: FloatArray

    __repr__ = short_repr


def pair_measures(response: ForcedResponse, point: int) -> PairMeasures:
    """The measures of all pairs at a point of the curve (:meth:`ForcedResponse.pair_cycle`).

    A sample counts as separated where the normal force is 0, as slip where the slider moved since the sample before and
    the pair was closed at both, and as stick otherwise. The fractions therefore have steps of one sample, and the slip
    in the sample of a touchdown is not counted. Raises InputError for a point that does not exist.
    """
    cycle = response.pair_cycle(point)
    n_samples, n_pairs, _ = cycle.force.shape
    separated = np.zeros((n_samples, n_pairs), dtype=bool)
    has_slider = np.zeros(n_pairs, dtype=bool)
    for law, members in zip(response.pairs.laws, response.pairs.members, strict=True):
        has_slider[members] = isinstance(law, FrictionLaw | JenkinsElement)
        if isinstance(law, FrictionLaw):
            separated[:, members] = cycle.force[:, members, 2] <= 0.0
    motion = response.pair_displacement(point, n_samples)[:, :, :2]
    size = np.linalg.norm(np.ptp(motion, axis=0), axis=1)
    step = np.linalg.norm(cycle.slider - np.roll(cycle.slider, 1, axis=0), axis=2)
    slips = (step > AT_REST * size) & ~separated & ~np.roll(separated, 1, axis=0)

    def or_nan(values: FloatArray) -> FloatArray:
        return np.where(has_slider, values, np.nan)

    return PairMeasures(
        state=response.contact_state[point],
        stick_fraction=or_nan((~slips & ~separated).mean(axis=0)),
        slip_fraction=or_nan(slips.mean(axis=0)),
        separated_fraction=or_nan(separated.mean(axis=0)),
        slip_distance=or_nan(np.where(slips, step, 0.0).sum(axis=0)),
        mean_normal_force=cycle.force[:, :, 2].mean(axis=0),
        normal_load=response.pairs.normal_load,
        dissipated_energy=response.dissipated_energy[point],
    )


def point_at_frequency(response: ForcedResponse, output: ArrayLike, frequency_hz: float) -> int:
    """The point of the curve next to a frequency; where the curve folds, that with the largest amplitude of ``output``.

    Raises InputError for a frequency outside of the curve, or in a gap between two parts of it.
    """
    wanted = positive_number("frequency_hz", frequency_hz, "Hz")
    frequency, amplitude = response.frequency_hz, response.amplitude(output)
    first = np.arange(response.n_points - 1)
    low, high = np.minimum(frequency[:-1], frequency[1:]), np.maximum(frequency[:-1], frequency[1:])
    passes = (low <= wanted) & (wanted <= high) & (response.part[:-1] == response.part[1:])
    nearer = np.where(np.abs(frequency[1:] - wanted) < np.abs(frequency[:-1] - wanted), first + 1, first)
    candidates = np.concatenate([nearer[passes], np.flatnonzero(frequency == wanted)])
    if not candidates.size:
        raise InputError(
            f"the curve does not pass {wanted:g} Hz; its points are from {frequency.min():.2f} to "
            f"{frequency.max():.2f} Hz. Give a frequency on the curve.",
            arguments=["frequency_hz"],
        )
    return int(candidates[amplitude[candidates].argmax()])
