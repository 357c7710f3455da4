"""The shapes of the nonlinear mode of a study at nodes of its mesh."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from stickslip.core.validation import FloatArray
from stickslip.model.model import Model
from stickslip.results.mode_shapes import ModeShapes
from stickslip.results.nonlinear_mode import NonlinearMode
from stickslip.structure.mesh import IntArray

# The shapes at nodes (k,) of the mesh.
ShapesOfNodes = Callable[[IntArray], ModeShapes]


@dataclass(frozen=True)
class MeshShapes:
    """Displacements (2, n_nodes, 3) kg^(-1/2) of a mesh in the smallest and the largest motion of a mode, over its
    modal amplitude (2,) m kg^(1/2)."""

    displacement: FloatArray
    modal_amplitude: FloatArray

    @classmethod
    def of(cls, model: Model, mode: NonlinearMode | None) -> MeshShapes | None:
        """None without a mode, and for matrices without a mesh."""
        if mode is None or model.in_study.mesh is None:
            return None
        ends = [int(mode.modal_amplitude.argmin()), int(mode.modal_amplitude.argmax())]
        mass = model.superelement.mass
        first, last = (_largest_motion(mode.displacement[end][:, 1:3], mass) for end in ends)
        last *= np.copysign(1.0, first @ (mass @ last))
        amplitude = mode.modal_amplitude[ends]
        shapes = (model.superelement.recovery @ (np.column_stack([first, last]) / amplitude)).T
        return cls(shapes.reshape(2, -1, 3), amplitude)

    def at(self, nodes: IntArray) -> ModeShapes:
        """The shapes at nodes (k,)."""
        return ModeShapes(self.displacement[:, nodes].astype(np.float32), self.modal_amplitude)


def _largest_motion(first_harmonic: FloatArray, mass: FloatArray) -> FloatArray:
    """(n,) m, the motion of cosine and sine (n, 2) at the instant at which its mass norm is the largest."""
    _, instants = np.linalg.eigh(first_harmonic.T @ (mass @ first_harmonic))
    return np.asarray(first_harmonic @ instants[:, -1])
