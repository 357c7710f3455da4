"""The Campbell diagram of a rotating structure or disk: natural frequencies of its linear limits at each speed."""

from __future__ import annotations

from collections.abc import Callable
from typing import get_args

import numpy as np
from numpy.typing import ArrayLike

from stickslip.contact.law.contact_pairs import ContactPairs
from stickslip.core.errors import InputError
from stickslip.core.validation import FloatArray, finite_array, whole_number
from stickslip.results.campbell import Campbell
from stickslip.results.disk_campbell import DiskCampbell
from stickslip.solve.cyclic.stuck_sector import wide_pairs
from stickslip.solve.excitation import lag_of
from stickslip.solve.harmonic.compliance import require_one_size
from stickslip.solve.harmonic.damping import stuck_stiffness_matrix
from stickslip.solve.harmonic.linear import LinearLimit
from stickslip.structure.cyclic_sector import CyclicSector, Direction, waves_of
from stickslip.structure.rotating_superelement import RotatingSuperelement
from stickslip.structure.superelement import Superelement


def campbell_diagram(
    rotor: RotatingSuperelement,
    pairs: ContactPairs | Callable[[float], ContactPairs] | None,
    speed_rpm: ArrayLike,
    *,
    count: int = 6,
) -> Campbell:
    """Natural frequencies with stuck contact and without contact over the speed, and their crossings with engine
    orders.

    Frequencies are those in the rotating frame, without damping: an excitation that is constant in space has multiples
    of the speed there, its engine orders. Each speed costs two dense eigenvalue problems and no reduction.

    Parameters
    ----------
    rotor:
        of :func:`rotating_superelement`.
    pairs:
        the joint, of which pairs that are closed at rest stick; or a function of the speed in rpm that gives the joint
        in its static state there; None without contact, where both limits are the same.
    speed_rpm:
        (s,) rising speeds, two or more.
    count:
        number of frequencies of each limit.

    Raises
    ------
    InputError
        for speeds that do not rise, or are not those of the reduction, and for pairs of another structure.
    """
    speeds = _rising(speed_rpm)
    number = whole_number("count", count, 1)
    stuck, free = np.empty((2, speeds.size, number))
    for place, speed in enumerate(speeds.tolist()):
        superelement = rotor.at(speed)
        free[place] = stuck[place] = _natural_hz(superelement, superelement.stiffness, number)
        if pairs is not None:
            joint = pairs(speed) if callable(pairs) else pairs
            require_one_size(superelement, joint)
            stuck[place] = _natural_hz(superelement, stuck_stiffness_matrix(superelement, joint), number)
    return Campbell(tuple(f"{speed:g} rpm" for speed in speeds), speeds, stuck, free)


def _natural_hz(superelement: Superelement, stiffness: FloatArray, count: int) -> FloatArray:
    """(count,) Hz, NaN beyond the number of unknowns."""
    whirl = np.zeros_like(superelement.mass) if superelement.gyroscopic is None else superelement.gyroscopic
    return _filled(LinearLimit.of_matrices(superelement.mass, stiffness, whirl), count)


def disk_campbell_diagram(
    sector_at: Callable[[float], CyclicSector],
    pairs: ContactPairs | Callable[[float], ContactPairs] | None,
    speed_rpm: ArrayLike,
    *,
    count: int = 3,
) -> DiskCampbell:
    """Natural frequencies of the travelling waves of a tuned disk over the speed, in the rotating frame.

    Coriolis forces split those of forward and backward waves. Frequencies are those without damping.

    Parameters
    ----------
    sector_at:
        the reduced sector at a speed in rpm, always of the same nodal diameters, such as
        ``lambda rpm: ss.cyclic_sector(rotor.at(rpm), symmetry, nodes, gyroscopic=rotor.coriolis_at(rpm))``.
    pairs:
        the joint of one sector, of which pairs that are closed at rest stick; or a function of the speed in rpm that
        gives the joint in its static state there; None without contact.
    speed_rpm:
        (s,) rising speeds, two or more.
    count:
        number of frequencies of each wave.

    Raises
    ------
    InputError
        for speeds that do not rise, sectors with other nodal diameters at other speeds, and pairs of another sector.
    """
    speeds = _rising(speed_rpm)
    number = whole_number("count", count, 1)
    stuck, free, given = [], [], []
    for speed in speeds.tolist():
        sector = sector_at(speed).require_sector()
        given.append(tuple(sorted(sector.diameters)))
        joint = pairs(speed) if callable(pairs) else pairs
        waves = [[waves_of(diameter, each) for diameter in given[0]] for each in get_args(Direction)]
        if given[-1] != given[0]:
            raise InputError(
                f"sector_at gives other nodal diameters at {speed:g} rpm than at {speeds[0]:g} rpm. Reduce the sector "
                "for the same ones at each speed.",
                arguments=["sector_at"],
            )
        free.append([[_wave_hz(sector, None, each, number) for each in row] for row in waves])
        stuck.append(
            free[-1] if joint is None else [[_wave_hz(sector, joint, each, number) for each in row] for row in waves]
        )
    ordered = (np.moveaxis(np.array(table), 0, 2) for table in (stuck, free))
    return DiskCampbell(sector.sectors, speeds, given[0], *ordered)


def _rising(speed_rpm: ArrayLike) -> FloatArray:
    """The speeds (s,) of a diagram. Raises InputError."""
    speeds = finite_array("speed_rpm", speed_rpm)
    if speeds.ndim != 1 or speeds.size < 2 or (np.diff(speeds) <= 0.0).any():
        raise InputError(
            "speed_rpm must contain two or more speeds in rising order, such as np.linspace(0, 9000, 31).",
            arguments=["speed_rpm"],
        )
    return speeds


def _wave_hz(sector: CyclicSector, pairs: ContactPairs | None, waves: int, count: int) -> FloatArray:
    """(count,) Hz of a number of waves round the disk, NaN beyond the number of unknowns."""
    matrices = sector.lagged(waves)
    stiffness = matrices.stiffness
    if pairs is not None:
        here, ahead = np.hsplit(wide_pairs(pairs, sector.size).operator, 2)
        operator = here + lag_of(waves, sector.sectors) * ahead
        stiffness = stiffness + operator.conj().T @ (pairs.resting_stiffness()[:, None] * operator)
    whirl = np.zeros_like(matrices.mass) if matrices.gyroscopic is None else matrices.gyroscopic
    return _filled(LinearLimit.of_matrices(matrices.mass, stiffness, whirl), count)


def _filled(limit: LinearLimit, count: int) -> FloatArray:
    """(count,) Hz, the lowest of a limit, NaN beyond their number."""
    lowest = limit.natural_hz[:count]
    return np.concatenate([lowest, np.full(count - lowest.size, np.nan)])
