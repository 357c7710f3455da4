"""Why the published sums give a face no stiffness, and what would give it one."""

from __future__ import annotations

from dataclasses import replace
from math import floor

from stickslip.contact.stiffness.asperities import Roughness, fully_plastic_load
from stickslip.contact.stiffness.fractal import NEAR_LIMIT, elastic_limits

DIMENSION_STEPS = 1000  # steps from 2 to 3 of a proposed D: three decimals


def why_no_stiffness(roughness: Roughness, load: float) -> str:
    """Why the published sums give a fully plastic face under ``load`` (N) no stiffness; which load, G or law does."""
    scale = roughness.fractal_roughness
    enough, finer = elastic_limits(roughness, load)
    ways = [f"raise the load above {enough} N", f"set G below {finer} m"]
    dimension = _least_dimension(roughness, load)
    if dimension is not None:
        ways.append(f"raise D to {dimension:g} (a smoother face)")
    ways.append(
        'use law = "persson" or mode = "unloading", in which plastic contact responds to a small oscillation too (both '
        "require shortest_length)"
    )
    return (
        f"with D = {roughness.fractal_dimension:g} and G = {scale:g} m each contact spot is plastic under a face load "
        f"of {load:.4g} N; elastic spots require more than {enough} N. Remedies: {', or '.join(ways)}. At these limits "
        "the stiffness is still almost zero. If G is from a publication, check its unit: m and mm differ by a factor "
        "of 1000."
    )


def _least_dimension(roughness: Roughness, load: float) -> float | None:
    """The least D above that of ``roughness`` for which ``load`` (N) makes spots elastic; None if there is none.

    The load that this needs falls with D to a minimum (at D = 2.88 for E*/H = 36) and then rises without bound, so that
    a larger D does not always help. D within NEAR_LIMIT of 3 is not proposed.
    """
    first, last = floor(DIMENSION_STEPS * roughness.fractal_dimension) + 1, round(DIMENSION_STEPS * (3.0 - NEAR_LIMIT))
    dimensions = (step / DIMENSION_STEPS for step in range(first, last + 1))
    return next((D for D in dimensions if fully_plastic_load(replace(roughness, fractal_dimension=D)) < load), None)
