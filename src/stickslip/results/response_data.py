"""The stored data of a forced response: its fields with units, and the checks that they fit together."""

from __future__ import annotations

from dataclasses import dataclass, field, fields
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from stickslip.core.validation import FloatArray
from stickslip.results.linear_curves import LinearCurves
from stickslip.results.mistuning import Mistuning
from stickslip.results.nonlinear_mode import NonlinearMode
from stickslip.results.other_solutions import OtherSolutions
from stickslip.results.part import ResultPart
from stickslip.results.peak_gradients import PeakGradients
from stickslip.results.peak_ridge import PeakRidge
from stickslip.results.periodic_motions import CURVE, PeriodicMotions
from stickslip.results.quasi_static_mode import QuasiStaticMode
from stickslip.results.stability import Bifurcation, BifurcationRows, ComplexNumbers
from stickslip.results.stiffness_band import StiffnessBand
from stickslip.results.traction_band import TractionBand
from stickslip.results.variables import (
    Coefficients,
    Flags,
    InGroup,
    Numbers,
    Text,
    WholeNumbers,
    require_shape,
    stored,
)
from stickslip.results.wear import Wear

# The message of results of versions that did not compute it.
NO_STABILITY = "These results do not contain the stability of the points."


@dataclass(frozen=True, eq=False)
class ResponseData(PeriodicMotions):
    """The fields of :class:`stickslip.results.response.ForcedResponse`, which describes them."""

    DATASET_TITLE: ClassVar[str] = "Forced response of a structure with rough, dry-friction joints"

    frequency_hz: FloatArray = field(
        metadata=stored(Numbers(CURVE, "Hz", "excitation frequency along the curve, may fold", name="frequency"))
    )
    input_energy: FloatArray = field(metadata=stored(Numbers(CURVE, "J", "work of the excitation per cycle")))
    linear: LinearCurves = field(metadata=stored(InGroup.of(LinearCurves)))
    force: FloatArray = field(metadata=stored(Coefficients(("unknown",), "N", "excitation force")))
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
    doubtful: NDArray[np.bool_] | None = field(
        default=None, metadata=stored(Flags(CURVE, "1", "1 if the verdict on stability is doubtful", optional=True))
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
    stiffness_band: StiffnessBand | None = field(
        default=None, metadata=stored(InGroup.of(StiffnessBand, optional=True))
    )
    other_solutions: OtherSolutions | None = field(
        default=None, metadata=stored(InGroup.of(OtherSolutions, optional=True))
    )

    nonlinear_mode: NonlinearMode | None = field(
        default=None, metadata=stored(InGroup.of(NonlinearMode, optional=True))
    )
    quasi_static_mode: QuasiStaticMode | None = field(
        default=None, metadata=stored(InGroup.of(QuasiStaticMode, optional=True))
    )
    peak_ridge: PeakRidge | None = field(default=None, metadata=stored(InGroup.of(PeakRidge, optional=True)))
    performance_curve: PeakRidge | None = field(default=None, metadata=stored(InGroup.of(PeakRidge, optional=True)))
    gradients: PeakGradients | None = field(default=None, metadata=stored(InGroup.of(PeakGradients, optional=True)))
    wear: Wear | None = field(default=None, metadata=stored(InGroup.of(Wear, optional=True)))
    mistuning: Mistuning | None = field(default=None, metadata=stored(InGroup.of(Mistuning, optional=True)))

    @property
    def parts(self) -> dict[str, ResultPart]:
        """Name -> analysis beside the curve, those that the study has."""
        values = {each.name: getattr(self, each.name) for each in fields(self)}
        return {name: value for name, value in values.items() if isinstance(value, ResultPart)}

    def __post_init__(self) -> None:
        sizes = self._checked_sizes()
        for name in ("load_factor", "kinetic_energy", "part"):
            if np.shape(getattr(self, name)) == (1,):
                object.__setattr__(self, name, np.repeat(getattr(self, name), sizes["point"]))
        self._require_sizes(sizes)
        if self.traction_band is not None:
            band = self.traction_band
            require_shape(
                "traction_band.displacement", band.displacement[0], (sizes["unknown"], 2 * self.harmonics + 1)
            )
            require_shape("traction_band.traction", band.traction[0], (sizes["pair"], 2))
        if self.stiffness_band is not None:
            shape = sizes["unknown"], 2 * self.harmonics + 1
            require_shape("stiffness_band.displacement", self.stiffness_band.displacement[0], shape)
        limit = (self.linear.frequency_hz.size, sizes["unknown"], 2 * self.harmonics + 1)
        require_shape("linear.stuck", self.linear.stuck, limit)
        require_shape("linear.free", self.linear.free, limit)
        object.__setattr__(self, "warnings", tuple(self.warnings))
