"""The sections that study files of every kind share. The defaults are the two-blade study; tests hold them equal to
those of the classes that they end up in.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Annotated, Any, ClassVar, Literal

from pydantic import Field, ValidationInfo, field_validator, model_validator

from stickslip.case.quantities import Area, Frequency, FrictionCoefficient, Length, PairForce, Step, Stiffness
from stickslip.case.section import Section, instead_of, without_default
from stickslip.core.errors import InputError
from stickslip.core.resolution import COARSEST_ACCURACY, FINEST_ACCURACY, LEAST_SAMPLES
from stickslip.core.units import LARGEST_INTEGER, NEGLIGIBLE, Count, Quantity, Respelled


class StudySection(Section):
    """Name of the study."""

    title: str = Field(default="Two blades with an under-platform damper", description="heading of the report")


STRUCTURE_KINDS = "two-blade, mesh, matrices or cyclic"


class StructureSection(Section):
    """Source of the structure."""

    kind: str

    @property
    def files(self) -> dict[str, str]:
        """Key -> name of each input file of the structure."""
        return {}


class ReductionSection(Section):
    """Craig-Bampton reduction to the nodes of contacts, forces and responses, and a few modes."""

    modes: Annotated[int, Count(at_least=0, at_most=2000)] = Field(
        default=30, description="retained fixed-interface modes"
    )
    pairs: Literal["all", "moving"] = Field(
        default="all",
        description="contact pairs with unknowns: all, or moving (large joints that mostly stick)",
    )


FractalMode = Literal["consistent", "varying-curvature", "unloading"]
FIRST_MODE: FractalMode = "consistent"
_OF_FRACTAL = ("mode", "reference_area", "domain_extension")  # keys of this law alone: they choose it


class RoughnessSection(Section):
    """Roughness of the contact faces; with the preload it gives the contact stiffness. The defaults are machined faces:
    Sq 1 um over the cut-off of 0.8 mm, under the law that agrees with boundary elements within a factor 2. At the same
    Sq a larger D has more of its height in short waves."""

    fractal_dimension: Annotated[float, Quantity("pure number", above=2.0, below=3.0)] = Field(
        default=2.2, description="D of the surface, 2 < D < 3; machined metal has about 2.2"
    )
    # A fit of a nearly smooth profile gives 1e-100 m as D nears 2; heights grow with G^(D-2).
    fractal_roughness: (
        Annotated[
            float,
            Quantity(
                "length",
                at_least=NEGLIGIBLE,
                at_most=1e-3,
                usual=(NEGLIGIBLE, 1e-5),
                unit_required="Publications omit it, and m and mm differ by a factor of 1000.",
                example='"1e-8 m"',
            ),
        ]
        | None
    ) = Field(
        default=None,
        description="G, the scale of the heights, instead of sq; the unit is required",
        examples=["1e-17 m"],
    )
    # Polished glass has 1 nm, a sand casting 100 um.
    sq: Annotated[float, Quantity("length", shown="um", at_least=1e-12, at_most=1e-2, usual=(1e-10, 1e-3))] | None = (
        Field(default=1e-6, description="root mean square height over sample_length", validate_default=True)
    )
    # Soft rubber 0.1 MPa, lead 40 MPa, diamond 100 GPa (Tabor, The Hardness of Metals).
    hardness: Annotated[
        float, Quantity("pressure", shown="GPa", at_least=1e4, at_most=1e13, usual=(1e7, 2e11), example='"3 GPa"')
    ] = Field(default=3e9, description="of the softer face; steel and nickel alloys 2 to 4 GPa")
    sample_length: Length = Field(
        default=0.0008, description="longest wave of the surface; longer ones are form, as behind the cut-off of Sq"
    )
    # Atoms of metals are 0.25 nm apart.
    shortest_length: (
        Annotated[
            float, Quantity("length", shown="um", at_least=1e-10, at_most=3.0, usual=(1e-9, 1e-2), example='"1 um"')
        ]
        | None
    ) = Field(default=1e-6, description="shortest wave of the surface", validate_default=True)
    sdq: Annotated[float, Quantity("pure number", at_least=1e-9, at_most=10.0)] | None = Field(
        default=None, description="root mean square slope measured with sq, instead of shortest_length", examples=[0.05]
    )
    ridges: Annotated[int, Count(at_least=1, at_most=1000)] = Field(default=10, description="directions of waves")
    seed: Annotated[int, Count(at_least=0, at_most=LARGEST_INTEGER)] = Field(
        default=1, description="of the random phases"
    )
    law: Literal["fractal", "persson", "greenwood-williamson", "bush-gibson-thomas"] = Field(
        default="persson",
        description="of the contact stiffness; persson agrees best with boundary elements",
    )
    # Times the stiffness of the law: a calibration to a measured frequency, or the uncertainty of the law.
    stiffness_factor: Annotated[float, Quantity("pure number", at_least=1e-6, at_most=1e6)] = Field(
        default=1.0, description="times the stiffness of the law, for a calibration or its uncertainty"
    )
    # "paper" is the earlier name of "varying-curvature" in study files.
    mode: Annotated[FractalMode | None, Respelled("paper", "varying-curvature")] = Field(
        default=None,
        description="fractal: varying-curvature: K_n along spots of all sizes; unloading: plastic spots respond too",
        examples=["consistent"],
    )
    tangential_law: Literal["mindlin", "sherif-kossa"] = Field(
        default="mindlin", description="K_t / K_n: mindlin 2 (1-nu)/(2-nu); sherif-kossa pi (1-nu)/(2 (2-nu))"
    )
    form_length: Length | None = Field(
        default=None,
        description="not fractal: longer waves are form, which the mesh has as gaps; default: all waves count",
        examples=["2 mm"],
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

    @model_validator(mode="before")
    @classmethod
    def _given_keys_replace_defaults(cls, data: Any) -> Any:
        if isinstance(data, Mapping) and "law" not in data and any(data.get(key) is not None for key in _OF_FRACTAL):
            data = {**data, "law": "fractal"}  # files of earlier versions have its keys without its name
        return without_default(without_default(data, ("fractal_roughness",), "sq"), ("sdq",), "shortest_length")

    @field_validator("fractal_dimension", mode="before")
    @classmethod
    def _of_a_surface(cls, value: Any) -> Any:
        if isinstance(value, int | float) and 1.0 < value < 2.0:
            raise InputError(
                f"is the dimension of a profile, between 1 and 2. D of the surface is one more: {value + 1.0:g}."
            )
        return value

    @field_validator("sq")
    @classmethod
    def _one_scale(cls, value: Any, info: ValidationInfo) -> Any:
        if value is None and "fractal_roughness" in info.data and info.data["fractal_roughness"] is None:
            raise InputError("or fractal_roughness must be given. Give exactly one of them.")
        return instead_of(value, info, "fractal_roughness")

    @field_validator("mode", "tangential_law", "form_length", "reference_area", "domain_extension")
    @classmethod
    def _of_the_law(cls, value: Any, info: ValidationInfo) -> Any:
        is_default = value in (cls.model_fields[str(info.field_name)].default, FIRST_MODE)
        of_fractal = info.field_name in _OF_FRACTAL
        if "law" in info.data and not is_default and of_fractal != (info.data["law"] == "fractal"):
            laws = 'the law "fractal"' if of_fractal else "the other laws"
            raise InputError(f'belongs to {laws}, but law is "{info.data["law"]}". Remove it, or choose another law.')
        return value

    @field_validator("shortest_length")
    @classmethod
    def _shorter_than_the_sample(cls, value: float | None, info: ValidationInfo) -> float | None:
        longest = info.data.get("sample_length")
        if longest is not None and value is not None and value >= longest:
            raise InputError(f"must be below sample_length = {longest:g} m: the surface has waves between the two.")
        return value

    @field_validator("sdq")
    @classmethod
    def _one_end_of_the_waves(cls, value: float | None, info: ValidationInfo) -> Any:
        if value is None and "shortest_length" in info.data and info.data["shortest_length"] is None:
            raise InputError("or shortest_length must be given. Give exactly one of them.")
        if value is not None and "sq" in info.data and info.data["sq"] is None:
            raise InputError("requires sq: G and D already give the slope. Give sq instead of fractal_roughness.")
        return instead_of(value, info, "shortest_length")

    @property
    def fractal_mode(self) -> FractalMode:
        """The mode of the fractal law, also where another law is chosen and the fractal one stands beside it."""
        return self.mode or FIRST_MODE

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
    """Coulomb friction of all contact faces."""

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
    frequency_stop: Frequency = Field(default=550.0)
    harmonics: Annotated[int, Count(at_least=1, at_most=200)] | None = Field(
        default=5, description="in addition to the mean, fixed, instead of accuracy; 5 without either"
    )
    accuracy: (
        Annotated[
            float,
            Quantity("pure number", shown="%", at_least=FINEST_ACCURACY, at_most=COARSEST_ACCURACY, example='"0.5 %"'),
        ]
        | None
    ) = Field(
        default=None,
        description="of each point and of the peak; harmonics follow from it along the curve",
        examples=["0.5 %"],
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

    @model_validator(mode="before")
    @classmethod
    def _accuracy_replaces_the_default(cls, data: Any) -> Any:
        return without_default(data, ("accuracy",), "harmonics")

    @field_validator("accuracy")
    @classmethod
    def _one_resolution(cls, value: Any, info: ValidationInfo) -> Any:
        if value is None and "harmonics" in info.data and info.data["harmonics"] is None:
            raise InputError("or harmonics must be given. Give exactly one of them.")
        return instead_of(value, info, "harmonics")

    @property
    def resolution(self) -> str:
        """The harmonics in words."""
        if self.accuracy is None:
            return f"{self.harmonics} harmonics"
        return f"harmonics by an accuracy of {100.0 * self.accuracy:g} %"

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
        if info.data.get("accuracy") is not None and value < LEAST_SAMPLES:
            raise InputError(
                f"is too few: accuracy requires at least {LEAST_SAMPLES} samples in a period, which resolve the "
                "harmonics that it may choose. Use 256."
            )
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
        default=24,
        description="instants of one period at the peak, for ParaView, more if its harmonics require it; 0 for none",
    )
    stress: bool = Field(
        default=True, description="stress at the peak, on the page and for ParaView; structures with a mesh"
    )
    frd: bool = Field(
        default=False, description="displacement and stress at the peak as peak.frd of CalculiX; needs stress"
    )

    @field_validator("frd")
    @classmethod
    def _contains_the_stress(cls, value: bool, info: ValidationInfo) -> bool:
        if value and info.data.get("stress") is False:
            raise InputError("is true, and the file contains the stress, but stress is false. Set stress = true.")
        return value
