"""What is computed of a structure: the section [analysis] of a study file, one class for each kind.

A further kind is one more class here and one function in ``study/analyses.py``.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Annotated, ClassVar, Literal

from pydantic import BeforeValidator, Field, ValidationInfo, field_validator

from stickslip.case.section import Section, of_kind
from stickslip.core.errors import InputError
from stickslip.core.units import LARGEST_INTEGER, Count, Quantity

MOST_STARTS = 10_000  # chosen: some days of time integration
MOST_MODES = 100_000  # chosen: more unknowns than a reduced structure has
# Amplitudes of an output: below an atom up to a metre.
Amplitude = Annotated[float, Quantity("length", shown="um", at_least=1e-13, at_most=1.0, example='"10 um"')]


class AnalysisSection(Section):
    """What is computed, whatever its kind: always the forced response."""

    kind: str
    performance_curve: bool = Field(
        default=True,
        description="two blades: peaks over centrifugal force over excitation force, in the time of up to three curves",
    )
    traction_band: bool = Field(
        default=False,
        description="bound the peak over the residual tractions of pairs (run --traction-band); time of several curves",
    )
    traction_starts: Annotated[int, Count(at_least=0, at_most=MOST_STARTS)] = Field(
        default=2, description="random tractions from which this band is optimised, beside zero and estimated extremes"
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
    gradients: bool = Field(
        default=False,
        description="compute what each input changes at the highest peak (run --gradients); about a second for each",
    )


# A value of another key: it is read as that key, so a number is stored as its text.
Limit = Annotated[
    str, BeforeValidator(lambda value: repr(value) if type(value) in (int, float) else value), Field(max_length=100)
]
MODE_KEYS = ("mode", "limit", "smallest_amplitude", "largest_amplitude")
RIDGE_KEYS = ("over", "over_from", "over_to")
KIND = "forced, mode or ridge"


def _foreign(kind: str, **keys: tuple[str, ...]) -> dict[str, str]:
    """Key of another kind -> the rest of an error about it."""
    return {
        key: f'belongs to kind = "{owner}", but kind is "{kind}". Set the kind, or remove this key.'
        for owner, each in keys.items()
        for key in each
    }


class ForcedAnalysis(AnalysisSection):
    """The computed result: forced is the periodic response to the excitation over the frequency range of [solver]; mode
    is this response and, beside it, a nonlinear mode over a range of amplitudes; ridge is this response and, beside it,
    its peaks over a key."""

    foreign: ClassVar[Mapping[str, str]] = _foreign("forced", mode=MODE_KEYS, ridge=RIDGE_KEYS)

    kind: Literal["forced"] = Field(default="forced", description=KIND)


class RidgeAnalysis(AnalysisSection):
    """The forced response, and beside it the peaks of the first output while a key of the study changes."""

    foreign: ClassVar[Mapping[str, str]] = _foreign("ridge", mode=MODE_KEYS)

    kind: Literal["ridge"] = Field(default="ridge", description=KIND)
    over: str = Field(
        default="preload.centrifugal_force",
        description="the key that changes: any quantity, section.key",
        max_length=200,
    )
    over_from: Limit = Field(default="50 N", description="its range: values above zero, each with its unit")
    over_to: Limit = Field(default="5 kN")


class ModeAnalysis(AnalysisSection):
    """The forced response, and beside it a nonlinear mode: frequency and damping ratio against amplitude."""

    foreign: ClassVar[Mapping[str, str]] = _foreign("mode", ridge=RIDGE_KEYS)

    kind: Literal["mode"] = Field(default="mode", description=KIND)
    mode: Annotated[int, Count(at_least=1, at_most=MOST_MODES)] = Field(
        default=1, description="number of the linear mode, from 1, in the order of frequencies"
    )
    limit: Literal["stuck", "sliding"] = Field(
        default="stuck",
        description="pairs of the linear mode; the nonlinear one starts there, at the smallest or largest amplitude",
    )
    smallest_amplitude: Amplitude = Field(
        default=1e-8, description="of the first output, 0-to-peak, in the shape of the linear mode"
    )
    largest_amplitude: Amplitude = Field(default=1e-4, validate_default=True)

    @field_validator("largest_amplitude")
    @classmethod
    def _range_rises(cls, value: float, info: ValidationInfo) -> float:
        smallest = info.data.get("smallest_amplitude")
        if smallest is not None and value <= smallest:
            raise InputError(f"must be above smallest_amplitude = {1e6 * smallest:g} um.")
        return value


Analysis = Annotated[
    ForcedAnalysis | ModeAnalysis | RidgeAnalysis,
    of_kind({"forced": ForcedAnalysis, "mode": ModeAnalysis, "ridge": RidgeAnalysis}, "forced"),
]
