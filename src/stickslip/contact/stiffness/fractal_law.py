"""The fractal contact stiffness of a rough face as a stiffness law over the pressure."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from stickslip.contact.stiffness.fractal import (
    ContactStiffness,
    Roughness,
    StiffnessMode,
    fractal_contact,
)
from stickslip.core.validation import FloatArray, positive_number


@dataclass(frozen=True)
class FractalStiffness:
    """``kappa(p) = K(p A_ref) / A_ref`` with the stiffness K of a whole face (:func:`fractal_contact`).

    The fractal law has no nominal area, so its stiffness per area depends on the area of the face: with one fixed
    physical face ``A_ref`` it is independent of the mesh.

    ``reference_area`` in m2; InputError unless it is above zero.
    """

    roughness: Roughness
    reference_area: float
    mode: StiffnessMode = "consistent"

    def __post_init__(self) -> None:
        object.__setattr__(self, "reference_area", positive_number("reference_area", self.reference_area, "m2"))

    def normal(self, pressure: FloatArray) -> FloatArray:
        """(k,) N/m3 at pressures (k,) in Pa."""
        return np.array([each.normal for each in self._faces(pressure)]) / self.reference_area

    def tangential(self, pressure: FloatArray) -> FloatArray:
        """(k,) N/m3 at pressures (k,) in Pa."""
        return np.array([each.tangential for each in self._faces(pressure)]) / self.reference_area

    def valid(self, pressure: FloatArray) -> tuple[str, ...]:
        """Messages on the pressures, each kind once, worst first."""
        messages: dict[str, str] = {}
        for face in self._faces(pressure):
            for message in face.messages:
                messages.setdefault(message.split(":")[0][:40], message)
        return tuple(messages.values())

    def describe(self) -> str:
        """The law in one line."""
        roughness = self.roughness
        return (
            f"fractal, D = {roughness.fractal_dimension:g}, G = {roughness.fractal_roughness:g} m, {self.mode}, "
            f"{1e6 * self.reference_area:.4g} mm2"
        )

    def _faces(self, pressure: FloatArray) -> list[ContactStiffness]:
        return [
            fractal_contact(self.roughness, float(value) * self.reference_area, self.mode, self.reference_area)
            for value in pressure
        ]
