"""The stiffness law: contact stiffness per area over the pressure, and the springs of pairs from it."""

from __future__ import annotations

from typing import Literal, Protocol, get_args, runtime_checkable

import numpy as np
from numpy.typing import ArrayLike

from stickslip.contact.preload import checked_area, face_index, face_sum
from stickslip.core.errors import RoughnessError
from stickslip.core.validation import FloatArray, per_pair, require_choice

Allocation = Literal["area", "pressure"]


@runtime_checkable
class StiffnessLaw(Protocol):
    """Stiffness of a contact per nominal area; a new one is one file with one class and one entry in ``registry.py``.

    Pressures (k,) are in Pa, above zero; docs/extending.md shows a law from start to end.
    """

    def normal(self, pressure: FloatArray) -> FloatArray:
        """(k,) N/m3; 0 where the law gives no stiffness."""

    def tangential(self, pressure: FloatArray) -> FloatArray:
        """(k,) N/m3."""

    def valid(self, pressure: FloatArray) -> tuple[str, ...]:
        """Messages on pressures outside the range of the law, worst first; empty where the law is reliable."""

    def describe(self) -> str:
        """The law in one line."""


def springs_of_pairs(
    law: StiffnessLaw, area: ArrayLike, preload: ArrayLike, allocation: Allocation = "area", face: ArrayLike = 0
) -> tuple[FloatArray, FloatArray]:
    """Normal and tangential stiffness (n_pairs,) in N/m of contact pairs, face by face.

    area: ``k_i = A_i kappa(p)`` with the mean pressure p of the face, from the preloads of its closed pairs.
    pressure: ``k_i = A_i kappa(p_i)``, ``p_i = N0_i / A_i``; a pair that is open at rest (N0_i <= 0) has no pressure of
        its own and takes kappa at the mean pressure of its face, for when it closes.

    ``area`` (n_pairs,) m2; ``preload`` N, one number or (n_pairs,); ``face`` integers, which face a pair belongs to.
    Raises RoughnessError, with the messages of the law, if a pair would have no stiffness; InputError for unusable
    arrays.
    """
    areas = checked_area(area)
    pressure = pair_pressure(areas, preload, allocation, face)
    _require_load(pressure)
    different, pair = np.unique(pressure, return_inverse=True)
    normal = areas * np.asarray(law.normal(different), dtype=float)[pair]
    tangential = areas * np.asarray(law.tangential(different), dtype=float)[pair]
    dead = np.flatnonzero(~(normal > 0.0))
    if dead.size:
        reasons = law.valid(np.unique(pressure[dead])[:1]) or (f"the law gives none: {law.describe()}.",)
        advice = ' With allocation "area" each pair has the mean pressure of its face.' if allocation != "area" else ""
        raise RoughnessError(
            f"{dead.size} of {areas.size} contact pairs (first: pair {dead[0]}) would have no contact stiffness: "
            f"{reasons[0]}{advice}"
        )
    return normal, tangential


def pair_pressure(
    area: ArrayLike, preload: ArrayLike, allocation: Allocation = "area", face: ArrayLike = 0
) -> FloatArray:
    """The pressure (n_pairs,) Pa at which each pair takes its stiffness; arguments as in :func:`springs_of_pairs`."""
    require_choice("allocation", allocation, get_args(Allocation))
    areas = checked_area(area)
    loads, faces = per_pair("preload", preload, areas.size), face_index(face, areas.size)
    closed_load = np.maximum(loads, 0.0)
    pressure = (face_sum(closed_load, faces) / face_sum(areas, faces))[faces]
    return np.where(loads > 0.0, closed_load / areas, pressure) if allocation == "pressure" else pressure


def _require_load(pressure: FloatArray) -> None:
    """Raise RoughnessError for pairs whose face carries no load."""
    unloaded = np.flatnonzero(~(pressure > 0.0))
    if unloaded.size:
        raise RoughnessError(
            f"{unloaded.size} of {pressure.size} contact pairs (first: pair {unloaded[0]}) would have no contact "
            "stiffness, because the preload of their face is 0 N. Give the face a preload above 0 N, or give the "
            "contact stiffness."
        )
