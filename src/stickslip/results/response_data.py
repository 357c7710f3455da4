"""The stored data of a forced response: its fields with units, and the checks that they fit together."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import ClassVar, Self

import numpy as np
from numpy.typing import NDArray

from stickslip.contact.law.contact_pairs import ContactPairs
from stickslip.contact.law.law import ContactState
from stickslip.core.errors import InputError
from stickslip.core.validation import FloatArray
from stickslip.results.linear_curves import LinearCurves
from stickslip.results.other_solutions import OtherSolutions
from stickslip.results.pair_variables import pairs_from, pairs_groups
from stickslip.results.stability import Bifurcation, BifurcationRows, ComplexNumbers
from stickslip.results.stored import StoredGroup
from stickslip.results.traction_band import TractionBand
from stickslip.results.variables import (
    Attribute,
    Coefficients,
    Flags,
    HarmonicNumbers,
    InGroup,
    Json,
    Labelled,
    Numbers,
    Text,
    WholeNumbers,
    require_shape,
    stored,
)

# Dimensions of what each point of the curve has, and each pair at each point.
CURVE, PAIRS = ("point",), ("point", "pair")
_Setting = str | float | int | None
# More samples of a period than any run has: a larger number in a file is damage.
MOST_SAMPLES = 10**6
# The message of results of versions that did not compute it.
NO_STABILITY = "These results do not contain the stability of the points."


@dataclass(frozen=True, eq=False)
class ResponseData(Labelled):
    """The fields of :class:`stickslip.results.response.ForcedResponse`, which describes them."""

    DATASET_TITLE: ClassVar[str] = "Forced response of a structure with rough, dry-friction joints"

    frequency_hz: FloatArray = field(
        metadata=stored(Numbers(CURVE, "Hz", "excitation frequency along the curve, may fold", name="frequency"))
    )
    displacement: FloatArray = field(
        metadata=stored(
            Coefficients(
                ("point", "unknown"),
                "m",
                "displacement (m for boundary unknowns, own scaling for modal ones)",
            )
        )
    )
    contact_state: NDArray[np.int8] = field(
        metadata=stored(
            WholeNumbers(
                PAIRS, "1", f"contact state: {', '.join(f'{each:d} {each.label}' for each in ContactState)}", np.int8
            )
        )
    )
    dissipated_energy: FloatArray = field(
        metadata=stored(Numbers(PAIRS, "J", "work on the contact force per cycle: friction and normal_work"))
    )
    normal_work: FloatArray = field(
        metadata=stored(Numbers(PAIRS, "J", "work of the normal force per cycle, an error of sampling"))
    )
    closure: FloatArray = field(
        metadata=stored(Numbers(PAIRS, "1", "relative distance between slider at start and end of the period"))
    )
    residual: FloatArray = field(metadata=stored(Numbers(CURVE, "1", "relative residual of the balance")))
    iterations: NDArray[np.int64] = field(metadata=stored(WholeNumbers(CURVE, "1", "Newton iterations")))
    input_energy: FloatArray = field(metadata=stored(Numbers(CURVE, "J", "work of the excitation per cycle")))
    viscous_energy: FloatArray = field(
        metadata=stored(Numbers(CURVE, "J", "energy that viscous damping dissipates per cycle"))
    )
    converged: bool = field(metadata=stored(Attribute(0, 1, bool)))
    message: str = field(metadata=stored(Text("message of the solver at its end")))
    warnings: tuple[str, ...] = field(metadata=stored(Json(list[str], "warnings of the solver, JSON list")))
    harmonics: int = field(metadata=stored(HarmonicNumbers()))
    samples: int = field(metadata=stored(Attribute(1, MOST_SAMPLES)))
    pairs: ContactPairs = field(metadata=stored(InGroup(pairs_groups, pairs_from)))
    linear: LinearCurves = field(metadata=stored(InGroup.of(LinearCurves)))
    force: FloatArray = field(metadata=stored(Coefficients(("unknown",), "N", "excitation force")))
    settings: dict[str, str | float | int] = field(
        metadata=stored(Json(dict[str, _Setting], "settings of the solve, JSON object"))
    )
    provenance: dict[str, str] = field(metadata=stored(Json(dict[str, str], "software and machine, JSON object")))
    load_factor: FloatArray = field(
        default_factory=lambda: np.ones(1),
        metadata=stored(Numbers(CURVE, "1", "excitation at the point over force", optional=True)),
    )
    kinetic_energy: FloatArray = field(
        default_factory=lambda: np.zeros(1),
        metadata=stored(Numbers(CURVE, "J", "twice the mean kinetic energy of the first harmonic", optional=True)),
    )
    walk: FloatArray | None = field(
        default=None,
        metadata=stored(
            Numbers(("point", "unknown"), "m", "way of the unknown in one cycle, where a body walks", optional=True)
        ),
    )
    part: NDArray[np.int64] = field(
        default_factory=lambda: np.zeros(1, dtype=np.int64),
        metadata=stored(WholeNumbers(CURVE, "1", "uninterrupted part of the curve of the point", optional=True)),
    )
    point_harmonics: NDArray[np.int64] | None = field(
        default=None,
        metadata=stored(WholeNumbers(CURVE, "1", "harmonics of the solution at the point", optional=True)),
    )
    estimated_error: FloatArray | None = field(
        default=None,
        metadata=stored(Numbers(CURVE, "1", "estimated error by neglected harmonics, over the motion", optional=True)),
    )
    stable: NDArray[np.bool_] | None = field(
        default=None, metadata=stored(Flags(CURVE, "1", "1 if small disturbances decay", optional=True))
    )
    multipliers: NDArray[np.complex128] | None = field(
        default=None,
        metadata=stored(ComplexNumbers(("point", "multiplier"), "1", "largest Floquet multipliers", optional=True)),
    )
    bifurcations: tuple[Bifurcation, ...] = field(default=(), metadata=stored(BifurcationRows(optional=True)))
    stability_message: str = field(
        default=NO_STABILITY, metadata=stored(Text("stability of the points of the curve", optional=True))
    )
    traction_band: TractionBand | None = field(default=None, metadata=stored(InGroup.of(TractionBand, optional=True)))
    other_solutions: OtherSolutions | None = field(
        default=None, metadata=stored(InGroup.of(OtherSolutions, optional=True))
    )

    def __post_init__(self) -> None:
        points = np.shape(self.frequency_hz)
        if len(points) != 1 or not points[0]:
            raise InputError(
                f"frequency_hz must be a list of at least one point, but its shape is {points}.",
                arguments=["frequency_hz"],
            )
        for name in ("load_factor", "kinetic_energy", "part"):
            if np.shape(getattr(self, name)) == (1,):
                object.__setattr__(self, name, np.repeat(getattr(self, name), points[0]))
        if not np.isin(self.contact_state, list(ContactState)).all():
            states = [f"{state:d} ({state.label})" for state in ContactState]
            raise InputError(
                f"contact_state must contain only {', '.join(states[:-1])} or {states[-1]}.",
                arguments=["contact_state"],
            )
        sizes = {
            "point": points[0],
            "pair": self.pairs.n_pairs,
            "unknown": self.pairs.operator.shape[1],
            "harmonic": self.harmonics,
        }
        self._require_sizes(sizes)
        if self.traction_band is not None:
            band = self.traction_band
            require_shape(
                "traction_band.displacement", band.displacement[0], (sizes["unknown"], 2 * self.harmonics + 1)
            )
            require_shape("traction_band.traction", band.traction[0], (sizes["pair"], 2))
        limit = (self.linear.frequency_hz.size, sizes["unknown"], 2 * self.harmonics + 1)
        require_shape("linear.stuck", self.linear.stuck, limit)
        require_shape("linear.free", self.linear.free, limit)
        object.__setattr__(self, "warnings", tuple(self.warnings))

    @classmethod
    def from_group(cls, group: StoredGroup, harmonics: int = 0) -> Self:
        """The response in the root group of a results file, which contains its number of harmonics."""
        return super().from_group(group, group.integers("harmonic").size)
