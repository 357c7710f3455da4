"""Shapes of a nonlinear mode at the points of a sketch, at its smallest and at its largest amplitude."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from stickslip.core.errors import InputError
from stickslip.core.validation import FloatArray, finite_array
from stickslip.results.variables import Labelled, Numbers, stored

_END = "mode_end"


@dataclass(frozen=True, eq=False)
class ModeShapes(Labelled):
    """The mode at its smallest and at its largest amplitude, each at the instant of its largest motion.

    Parameters
    ----------
    displacement:
        (2, n, 3) kg^(-1/2), single precision: displacement of the points of the sketch over the modal amplitude.
    modal_amplitude:
        (2,) m kg^(1/2), rising.

    Raises
    ------
    InputError
        for arrays of another shape, and for numbers that are not finite.
    """

    displacement: NDArray[np.float32] = field(
        metadata=stored(
            Numbers(
                (_END, "point", "axis"), "kg-0.5", "displacement of the points over the modal amplitude", np.float32,
                name="mode_shape",
            )
        )
    )  # fmt: skip
    modal_amplitude: FloatArray = field(
        metadata=stored(Numbers((_END,), "m kg0.5", "modal amplitude of the shape", name="mode_shape_amplitude"))
    )

    def __post_init__(self) -> None:
        shapes = finite_array("shapes of the mode", self.displacement)
        amplitude = finite_array("modal amplitudes of the shapes", self.modal_amplitude)
        if shapes.ndim != 3 or (shapes.shape[0], shapes.shape[2]) != (2, 3) or amplitude.shape != (2,):
            raise InputError(
                "the shapes of a mode must be (2, n, 3) with two modal amplitudes, but have the shapes "
                f"{shapes.shape} and {amplitude.shape}."
            )
        object.__setattr__(self, "displacement", shapes.astype(np.float32))
        object.__setattr__(self, "modal_amplitude", amplitude)
