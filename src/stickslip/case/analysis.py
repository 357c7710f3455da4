"""The section [analysis] of a study file: the analysis of the structure, one class for each kind.

A further kind is one more class here and one function in ``study/analyses.py``.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Annotated, ClassVar, Literal, cast

from pydantic import BeforeValidator, Field, ValidationInfo, field_validator

from stickslip.case.quantities import Frequency
from stickslip.case.section import Section, instead_of, of_kind
from stickslip.core.errors import InputError
from stickslip.core.units import LARGEST_INTEGER, Count, Quantity

MOST_STARTS = 10_000  # chosen: some days of time integration
MOST_MODES = 100_000  # chosen: more unknowns than a reduced structure has
# Amplitudes of an output: below an atom up to a metre.
Amplitude = Annotated[float, Quantity("length", shown="um", at_least=1e-13, at_most=1.0, example='"10 um"')]


class AnalysisSection(Section):
    """Keys of all kinds of analysis; each computes the forced response."""

    kind: str
    performance_curve: bool = Field(
        default=True,
        description="two blades: highest peak over centrifugal over excitation force; about three curves more",
    )
    stiffness_band: bool = Field(
        default=True,
        description="if it follows from roughness: curves with 1/3 and 3 times the contact stiffness; two curves more",
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
MODE_KEYS = ("mode", "limit", "mode_method", "smallest_amplitude", "largest_amplitude")
RIDGE_KEYS = ("over", "over_from", "over_to")
WEAR_KEYS = (
    "wear_coefficient", "energy_wear_coefficient", "wear_cycles", "wear_frequency", "running_in_sq", "running_in_depth",
)  # fmt: skip
KIND = "forced, mode, ridge or wear"
# Dry metals lose about 1e-14 m3/(N m), abrasive faces up to 1e-10, lubricated ones down to 1e-19.
WearCoefficient = Annotated[
    float,
    Quantity("wear coefficient", shown="mm^3/(N m)", at_least=1e-30, at_most=1e-6, usual=(1e-20, 1e-10)),
]


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
    its peaks over a key; wear is this response and, beside it, the wear of the joint over many cycles."""

    foreign: ClassVar[Mapping[str, str]] = _foreign("forced", mode=MODE_KEYS, ridge=RIDGE_KEYS, wear=WEAR_KEYS)

    kind: Literal["forced"] = Field(default="forced", description=KIND)


class RidgeAnalysis(AnalysisSection):
    """The forced response, and beside it the peaks of the first output while a key of the study changes."""

    foreign: ClassVar[Mapping[str, str]] = _foreign("ridge", mode=MODE_KEYS, wear=WEAR_KEYS)

    kind: Literal["ridge"] = Field(default="ridge", description=KIND)
    over: str = Field(
        default="preload.centrifugal_force",
        description="the key that changes: any quantity, section.key",
        max_length=200,
    )
    over_from: Limit = Field(default="50 N", description="its range, rising: values above zero, each with its unit")
    over_to: Limit = Field(default="5 kN")


class ModeAnalysis(AnalysisSection):
    """The forced response, and beside it a nonlinear mode: frequency and damping ratio against amplitude."""

    foreign: ClassVar[Mapping[str, str]] = _foreign("mode", ridge=RIDGE_KEYS, wear=WEAR_KEYS)

    kind: Literal["mode"] = Field(default="mode", description=KIND)
    mode: Annotated[int, Count(at_least=1, at_most=MOST_MODES)] = Field(
        default=1, description="number of the linear mode, from 1, in the order of frequencies"
    )
    limit: Literal["stuck", "sliding"] = Field(
        default="stuck",
        description="pairs of the linear mode; the nonlinear one starts there, at the smallest or largest amplitude",
    )
    mode_method: Literal["periodic", "quasi-static"] = Field(
        default="periodic",
        description="nonlinear mode of periodic motions, or the quasi-static estimate alone, in seconds",
    )
    smallest_amplitude: Amplitude = Field(
        default=1e-8, description="of the first output, 0-to-peak, in the shape of the linear mode"
    )
    largest_amplitude: Amplitude = Field(default=1e-4, validate_default=True)

    @field_validator("mode_method")
    @classmethod
    def _estimate_is_stuck(cls, value: str, info: ValidationInfo) -> str:
        if value == "quasi-static" and info.data.get("limit") == "sliding":
            raise InputError(
                'requires limit = "stuck", but limit is "sliding": the estimate loads a mode with stuck pairs. Set '
                'limit = "stuck", or mode_method = "periodic".'
            )
        return value

    @field_validator("largest_amplitude")
    @classmethod
    def _range_rises(cls, value: float, info: ValidationInfo) -> float:
        smallest = info.data.get("smallest_amplitude")
        if smallest is not None and value <= smallest:
            raise InputError(f"must be above smallest_amplitude = {1e6 * smallest:g} um.")
        return value


class WearAnalysis(AnalysisSection):
    """The forced response, and beside it the wear of the joint over many cycles, with the first output."""

    foreign: ClassVar[Mapping[str, str]] = _foreign("wear", mode=MODE_KEYS, ridge=RIDGE_KEYS)

    kind: Literal["wear"] = Field(default="wear", description=KIND)
    energy_wear_coefficient: WearCoefficient | None = Field(
        default=None,
        description="volume that both faces lose for each joule of friction; this or wear_coefficient",
        examples=["1e-5 mm^3/J"],
    )
    wear_coefficient: WearCoefficient | None = Field(
        default=None,
        description="Archard's K: volume for each newton of normal force and metre of slip",
        examples=["5e-6 mm^3/(N m)"],
        validate_default=True,
    )
    wear_cycles: Annotated[float, Quantity("pure number", at_least=1.0, at_most=1e15)] = Field(
        default=1e7, description="number of cycles of vibration"
    )
    wear_frequency: Frequency | None = Field(
        default=None,
        description="of the vibration; default: at each moment the frequency of the highest peak",
        examples=["450 Hz"],
    )
    running_in_sq: Annotated[float, Quantity("length", shown="um", at_least=1e-12, at_most=1e-2)] | None = Field(
        default=None,
        description="Sq towards which the roughness falls while a face wears; default: roughness stays",
        examples=["0.5 um"],
    )
    running_in_depth: Annotated[float, Quantity("length", shown="um", at_least=1e-12, at_most=1.0)] | None = Field(
        default=None,
        description="mean worn depth of a face in which the rest of its Sq above running_in_sq falls to 37 %",
        examples=["1 um"],
        validate_default=True,
    )

    @field_validator("wear_coefficient")
    @classmethod
    def _one_coefficient(cls, value: float | None, info: ValidationInfo) -> float | None:
        if "energy_wear_coefficient" in info.data and value is info.data["energy_wear_coefficient"] is None:
            raise InputError("or energy_wear_coefficient must be given. Give exactly one of them.")
        return cast("float | None", instead_of(value, info, "energy_wear_coefficient"))

    @field_validator("running_in_depth")
    @classmethod
    def _both_of_running_in(cls, value: float | None, info: ValidationInfo) -> float | None:
        if "running_in_sq" in info.data and (value is None) != (info.data["running_in_sq"] is None):
            raise InputError("belongs to running_in_sq: give both of them, or none.")
        return value


Analysis = Annotated[
    ForcedAnalysis | ModeAnalysis | RidgeAnalysis | WearAnalysis,
    of_kind({"forced": ForcedAnalysis, "mode": ModeAnalysis, "ridge": RidgeAnalysis, "wear": WearAnalysis}, "forced"),
]
