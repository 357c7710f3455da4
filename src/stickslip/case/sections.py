"""The sections that study files of every kind share, and what all sections are made of. The defaults are the
two-blade study; tests hold them equal to those of the classes that they end up in.

The fields are the keys of the file, their descriptions and the docstrings its comments (``template.py``). Values with a
unit are texts ("145 mm"), plain numbers are SI; after loading everything is SI floats.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import PurePath
from typing import Annotated, Any, ClassVar, Literal
from unicodedata import category

from pydantic import (
    AfterValidator,
    BaseModel,
    ConfigDict,
    Field,
    PlainValidator,
    ValidationInfo,
    create_model,
    field_validator,
    model_validator,
)

from stickslip.core.errors import InputError
from stickslip.core.units import (
    LARGEST_FORCE,
    LARGEST_INTEGER,
    LARGEST_STIFFNESS,
    NEGLIGIBLE,
    Count,
    Quantity,
    Respelled,
)

_CONTROLS = ("Cc", "Cs", "Zl", "Zp")  # controls, halves of characters, separators of lines and paragraphs
# Limits are wide on purpose: from micromachined parts (micrometres, micrograms) to the largest turbines. Values outside
# are typing errors or in a wrong unit. ``usual`` is narrower, and leads to a warning only. A part of a blade above 3 m
# is a number in millimetres without its unit; 1 nm is below what any process makes.
Length = Annotated[float, Quantity("length", shown="mm", at_least=1e-9, at_most=3.0)]
# Distances and places in a mesh or in matrices: as large as a ship, with room for those who write "far away".
Distance = Annotated[float, Quantity("length", shown="mm", at_least=1e-12, at_most=1e6)]
Coordinate = Annotated[float, Quantity("length", shown="mm", at_least=-1e6, at_most=1e6)]
Force = Annotated[float, Quantity("force", at_least=1e-15, at_most=LARGEST_FORCE, usual=(1e-6, 1e8), example='"500 N"')]
ForceOrNone = Annotated[float, Quantity("force", at_least=0.0, at_most=LARGEST_FORCE)]
PairForce = Annotated[float, Quantity("force", at_least=-LARGEST_FORCE, at_most=LARGEST_FORCE)]
# Atomic force microscopes have springs of 1e-2 N/m; 1 m2 of ground steel faces under load reaches 1e14 N/m.
Stiffness = Annotated[
    float,
    Quantity("stiffness", at_least=1e-6, at_most=LARGEST_STIFFNESS, usual=(1e-1, 1e14), example='"1.3e8 N/m"'),
]
# Buildings sway at 0.1 Hz, micromechanical resonators reach 1e9 Hz.
Frequency = Annotated[float, Quantity("frequency", at_least=1e-6, at_most=1e12, usual=(1e-2, 1e9))]
# Gels have 1 kPa, diamond 1.2 TPa (Callister, Materials Science and Engineering); more serves as a rigid body.
YoungModulus = Annotated[float, Quantity("pressure", shown="GPa", at_least=1e3, at_most=1e16)]
# Aerogels have 1 kg/m^3, osmium 22,590 kg/m^3; less serves as a body without mass, more as a lumped one.
Density = Annotated[float, Quantity("density", at_least=1e-6, at_most=1e9)]
PoissonRatio = Annotated[float, Quantity("pure number", at_least=0.0, below=0.5)]
# Rubber on dry glass reaches 3 or 4, clean metals in vacuum more; 1e-9 is practically no friction.
FrictionCoefficient = Annotated[float, Quantity("pure number", at_least=1e-9, at_most=10.0)]
Area = Annotated[float, Quantity("area", shown="mm^2", at_least=1e-18, at_most=1e6)]
# Fraction of a window or of a response; below 1e-12 round-off decides.
Step = Annotated[float, Quantity("pure number", at_least=1e-12, at_most=1.0)]
Elements = Annotated[int, Count(at_least=1, at_most=1000)]


def _unit_vector(value: object) -> tuple[float, float, float]:
    """``value`` scaled to length 1. Raises InputError unless it is three finite numbers, not all zero."""
    number = Quantity("pure number", at_least=-1e100, at_most=1e100)  # squares of larger numbers are infinite
    if not isinstance(value, list | tuple) or len(value) != 3:
        raise InputError("must be three numbers [x, y, z], for example [1.0, 0.0, 0.0].")
    x, y, z = (number.parse(entry) for entry in value)
    length = (x * x + y * y + z * z) ** 0.5
    if not length > 0:
        raise InputError("has length zero; a direction is for example [1.0, 0.0, 0.0].")
    if abs(length - 1.0) < 1e-12:  # a stored direction is read back to the last digit
        return (x, y, z)
    return (x / length, y / length, z / length)


Direction = Annotated[tuple[float, float, float], PlainValidator(_unit_vector)]


def require_printable(value: Any) -> Any:
    """``value``, unless it is or contains a text with a character that no file, page or terminal can show."""
    if isinstance(value, list | tuple):
        for entry in value:
            require_printable(entry)
    odd = next((letter for letter in value if category(letter) in _CONTROLS), "") if isinstance(value, str) else ""
    if odd:
        raise InputError(
            f"contains the control character U+{ord(odd):04X}, but a text is one line of printable characters. "
            "Remove it."
        )
    return value


def _file_name(value: str) -> str:
    """``value``. Raises InputError for a name that is too long for any disk."""
    longest = max(map(len, PurePath(value).parts), default=0)
    if longest > 255 or len(value) > 4000:  # what file systems of Linux, macOS and Windows take
        raise InputError(f"is not a file name: it has {len(value)} characters, and one part of it has {longest}.")
    return value


FileName = Annotated[str, AfterValidator(_file_name)]


@dataclass(frozen=True)
class Required:
    """The message on a missing required key, after its name."""

    sentence: str


class Section(BaseModel):
    """A section of the study file.

    ``foreign`` are keys that the section has in a study of another kind, with what a message says of them here.
    """

    model_config = ConfigDict(extra="forbid", frozen=True)
    foreign: ClassVar[Mapping[str, str]] = {}

    @model_validator(mode="before")
    @classmethod
    def _drop_empty_foreign_keys(cls, data: Any) -> Any:
        """Files of earlier versions contain foreign keys that are empty or zero, which have no effect."""
        if not isinstance(data, Mapping):
            return data
        return {key: value for key, value in data.items() if value or key not in cls.foreign}

    @field_validator("*", mode="before")
    @classmethod
    def _texts_can_be_shown(cls, value: Any) -> Any:
        return require_printable(value)


def chosen_by(choose: Callable[[Any], type[Section]]) -> PlainValidator:
    """The validator of a union of sections of which ``choose`` picks one for the data of a file."""
    return PlainValidator(lambda data: data if isinstance(data, Section) else choose(data).model_validate(data))


def _literal(words: tuple[str, ...]) -> Any:
    return Literal[words]


def of_kind(classes: Mapping[str, type[Section]], default: str) -> PlainValidator:
    """The validator of a union of sections that differ by their key ``kind``."""
    config = ConfigDict(extra="ignore", frozen=True)
    unknown = create_model("UnknownKind", __config__=config, kind=(_literal(tuple(classes)), ...))

    def validated(data: Any) -> Any:
        if isinstance(data, Section):
            return data
        kind = data.get("kind", default) if isinstance(data, Mapping) else default
        is_valid = isinstance(kind, str) and kind in classes
        return (classes[kind] if is_valid else unknown).model_validate(data)

    return PlainValidator(validated)


class StudySection(Section):
    """Name of the study."""

    title: str = Field(default="Two blades with an under-platform damper", description="heading of the report")


class StructureSection(Section):
    """Source of the structure."""

    kind: str

    @property
    def files(self) -> dict[str, str]:
        """Key -> name of each input file of the structure."""
        return {}


class ReductionSection(Section):
    """Craig-Bampton reduction to the contact nodes, N1, N2, A and a few modes."""

    modes: Annotated[int, Count(at_least=0, at_most=2000)] = Field(
        default=30, description="retained fixed-interface modes"
    )


class RoughnessSection(Section):
    """Fractal (Weierstrass-Mandelbrot) roughness of the contact faces; with the preload it gives the contact stiffness.
    At the same G a larger D makes the face smoother and stiffer; a larger G makes it rougher and softer."""

    fractal_dimension: Annotated[float, Quantity("pure number", above=2.0, below=3.0)] = Field(
        default=2.4, description="D of the surface, 2 < D < 3"
    )
    # A fit of a nearly smooth profile gives 1e-100 m as D nears 2; heights grow with G^(D-2).
    fractal_roughness: Annotated[
        float,
        Quantity(
            "length",
            at_least=NEGLIGIBLE,
            at_most=1e-3,
            usual=(NEGLIGIBLE, 1e-5),
            unit_required="Publications omit it, and m and mm differ by a factor of 1000.",
            example='"1e-8 m"',
        ),
    ] = Field(default=1e-8, description="G; the unit is required")
    # Soft rubber 0.1 MPa, lead 40 MPa, diamond 100 GPa (Tabor, The Hardness of Metals).
    hardness: Annotated[
        float, Quantity("pressure", shown="GPa", at_least=1e4, at_most=1e13, usual=(1e7, 2e11), example='"3 GPa"')
    ] = Field(default=3e9, description="of the softer face; steel and nickel alloys 2 to 4 GPa")
    sample_length: Length = Field(default=0.028, description="longest wave of the surface")
    # Atoms of metals are 0.25 nm apart.
    shortest_length: Annotated[
        float, Quantity("length", shown="um", at_least=1e-10, at_most=3.0, usual=(1e-9, 1e-2), example='"1 um"')
    ] = Field(default=1e-6, description="shortest wave of the surface")
    ridges: Annotated[int, Count(at_least=1, at_most=1000)] = Field(default=10, description="directions of waves")
    seed: Annotated[int, Count(at_least=0, at_most=LARGEST_INTEGER)] = Field(
        default=1, description="of the random phases"
    )
    # "paper" is the earlier name of "varying-curvature" in study files.
    mode: Annotated[
        Literal["consistent", "varying-curvature", "unloading"], Respelled("paper", "varying-curvature")
    ] = Field(
        default="consistent",
        description="varying-curvature: K_n along spots of all sizes; unloading: plastic spots respond too",
    )
    allocation: Literal["area", "pressure"] = Field(
        default="area", description="stiffness of a pair by its fraction of the area, or by its own pressure"
    )
    reference_area: Area | None = Field(
        default=None,
        description="pressure: reference area of the law for all faces; default: the area of each face",
        examples=["180 mm^2"],
    )
    domain_extension: Annotated[float, Quantity("pure number", at_least=1.0, at_most=1e3)] = Field(
        default=1.0, description="psi of the size distribution; 1 omits it"
    )

    @field_validator("shortest_length")
    @classmethod
    def _shorter_than_the_sample(cls, value: float, info: ValidationInfo) -> float:
        longest = info.data.get("sample_length")
        if longest is not None and value >= longest:
            raise InputError(f"must be below sample_length = {longest:g} m: the surface has waves between the two.")
        return value

    @field_validator("reference_area")
    @classmethod
    def _of_the_pressure_alone(cls, value: float | None, info: ValidationInfo) -> float | None:
        if value is not None and info.data.get("allocation") == "area":
            raise InputError(
                'belongs to allocation = "pressure", but allocation is "area", which distributes the stiffness of each '
                "face under its own load. Set the allocation, or remove the key."
            )
        return value


class ContactStiffnessSection(Section):
    """Measured stiffness of one complete contact face, instead of [roughness]."""

    foreign: ClassVar[Mapping[str, str]] = dict.fromkeys(
        ("allocation", "stiffness_constants"),
        "belongs to stiffness_law, which is not given. Give it, or remove this key.",
    )

    normal_stiffness: Stiffness = Field(examples=["1.34e8 N/m"])
    tangential_stiffness: Stiffness = Field(examples=["1.11e8 N/m"])


class FrictionSection(Section):
    """Coulomb friction between damper and platforms."""

    coefficient: FrictionCoefficient = Field(default=0.3, description="dry metal joints have 0.1 to 0.8")


class PreloadSection(Section):
    """Normal load at rest: prescribed, or solved from the static load with contact, gaps and friction."""

    method: Literal["prescribed", "solved"] = Field(
        default="prescribed",
        description="prescribed: uniform pressure, or values; solved: the pressure under the static load",
    )
    values: tuple[PairForce, ...] | None = Field(
        default=None,
        description="N, one for each pair in the order of the faces, instead of a load of the face; below 0: a gap",
        examples=[[2.5, 2.5, 2.5]],
    )
    residual_traction: Literal["released", "kept"] = Field(
        default="released",
        description="solved: released: no traction at rest in vibration; kept: it remains until a pair slips",
    )
    normal_law: Literal["spring", "pressure-gap"] = Field(
        default="spring",
        description="solved: springs of the face or of each pair (roughness.allocation), or the whole curve",
    )


class DampingSection(Section):
    """Viscous damping of the structure."""

    modal_damping_ratio: Annotated[float, Quantity("pure number", at_least=0.0, below=1.0)] | None = Field(
        default=0.001, description="of the modes with stuck contact"
    )
    # 2 pi f zeta of a share of the mass, zeta / (pi f) of the stiffness: more than critical at any frequency below.
    rayleigh_alpha: Annotated[float, Quantity("rate", at_least=0.0, at_most=1e12)] | None = Field(
        default=None, description="multiple of the mass matrix, instead of modal_damping_ratio", examples=["0.5 1/s"]
    )
    rayleigh_beta: Annotated[float, Quantity("time", at_least=0.0, at_most=1e6)] | None = Field(
        default=None,
        description="multiple of the stiffness without contact; slower, because it couples the stuck modes",
        examples=["6e-7 s"],
    )

    @model_validator(mode="before")
    @classmethod
    def _rayleigh_replaces_the_default(cls, data: Any) -> Any:
        return without_default(data, ("rayleigh_alpha", "rayleigh_beta"), "modal_damping_ratio")

    @field_validator("rayleigh_alpha", "rayleigh_beta")
    @classmethod
    def _one_source(cls, value: Any, info: ValidationInfo) -> Any:
        return instead_of(value, info, "modal_damping_ratio")


class SolverSection(Section):
    """Frequency range of the sweep, and its accuracy."""

    frequency_start: Frequency = Field(default=400.0, description="a start above the stop sweeps downwards")
    frequency_stop: Frequency = Field(default=530.0)
    harmonics: Annotated[int, Count(at_least=1, at_most=200)] = Field(
        default=5, description="number of harmonics, in addition to the mean"
    )
    samples: Annotated[int, Count(at_least=8, at_most=100_000)] = Field(
        default=256, description="per period; 512 with much separation", validate_default=True
    )
    # Numbers have 16 digits, so no residual falls below 1e-15.
    tolerance: Annotated[float, Quantity("pure number", at_least=1e-15, at_most=1e-3)] = Field(
        default=1e-9, description="of the residual, relative"
    )
    smallest_step: Step = Field(
        default=1e-6, description="along the curve, as a fraction of the frequency range or of the largest response"
    )
    first_step: Step = Field(default=0.01, validate_default=True)
    largest_step: Step = Field(default=0.08, validate_default=True)
    update: Literal["tractrix", "radial"] = Field(
        default="tractrix", description="return of a slipping pair to the friction limit"
    )

    @field_validator("frequency_stop")
    @classmethod
    def _window_has_a_width(cls, value: float, info: ValidationInfo) -> float:
        if value == info.data.get("frequency_start"):
            raise InputError(
                "is equal to frequency_start, so the frequency range is empty. Give two different frequencies; "
                "a start above the stop sweeps downwards."
            )
        return value

    @field_validator("samples")
    @classmethod
    def _enough_samples(cls, value: int, info: ValidationInfo) -> int:
        harmonics = info.data.get("harmonics")
        if harmonics is not None and value < 2 * harmonics + 1:
            advice = next(2**k for k in range(8, 20) if 2**k >= 16 * harmonics)
            raise InputError(
                f"is too few: harmonics = {harmonics} requires at least {2 * harmonics + 1} samples in a period. "
                f"Use {advice}: few samples miss the kinks of friction."
            )
        return value

    @field_validator("first_step", "largest_step")
    @classmethod
    def _steps_in_order(cls, value: float, info: ValidationInfo) -> float:
        for shorter in ("smallest_step", "first_step"):
            if value < info.data.get(shorter, 0.0):
                raise InputError(f"must not be below {shorter} = {info.data[shorter]:g}.")
        return value


class OutputSection(Section):
    """Files in addition to results.nc and report.html."""

    figure_formats: tuple[Literal["svg", "pdf", "png"], ...] = Field(
        default=("svg", "png"), description="formats of the separate figures"
    )
    mode_shapes: Annotated[int, Count(at_least=0, at_most=100)] = Field(
        default=10, description="number of mode shapes for ParaView"
    )
    deflected_shape_frames: Annotated[int, Count(at_least=0, at_most=1000)] = Field(
        default=24, description="instants of one period at the peak, for ParaView; 0 for none"
    )


def without_default(data: Any, alternatives: tuple[str, ...], default: str) -> Any:
    """``data`` with ``default`` switched off where a ``alternatives`` key replaces it and the file does not name it."""
    if isinstance(data, Mapping) and default not in data and any(key in data for key in alternatives):
        return {default: None, **data}
    return data


def instead_of(value: Any, info: ValidationInfo, other: str) -> Any:
    """``value``, after checking that ``other`` is not given as well. Raises InputError."""
    if value is not None and info.data.get(other) is not None:
        raise InputError(f"and {other} cannot both be given. Remove one of them.")
    return value
