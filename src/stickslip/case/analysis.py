"""What is computed of a structure: the section [analysis] of a study file, one class for each kind.

A further kind is one more class here and one function in ``study/analyses.py``.
"""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field

from stickslip.case.section import Section, of_kind
from stickslip.core.units import LARGEST_INTEGER, Count

MOST_STARTS = 10_000  # chosen: some days of time integration


class ForcedAnalysis(Section):
    """The computed result: forced is the periodic response to the excitation over the frequency range of [solver]."""

    kind: Literal["forced"] = Field(default="forced", description="forced")
    traction_band: bool = Field(
        default=False,
        description="compute how far the peak moves with the residual tractions of pairs; takes several curves more",
    )
    search: bool = Field(
        default=False,
        description="search for periodic motions off the curve by time integration from random states (run --search)",
    )
    search_starts: Annotated[int, Count(at_least=0, at_most=MOST_STARTS)] = Field(
        default=24, description="random states of the search"
    )
    search_seed: Annotated[int, Count(at_least=0, at_most=LARGEST_INTEGER)] = Field(
        default=0, description="seed of the random states; the same seed, the same search"
    )


Analysis = Annotated[ForcedAnalysis, of_kind({"forced": ForcedAnalysis}, "forced")]
