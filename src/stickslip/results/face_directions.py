"""Where the contact faces of a study are in its structure, and the directions along which their pairs slide."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from stickslip.core.errors import InputError
from stickslip.core.validation import FloatArray, finite_array
from stickslip.results.variables import Labelled, Numbers, stored

_ROUND_OFF = 1e-9  # allowed error of the length of a unit vector


def _direction(of: str) -> dict[str, object]:
    words = f"{of}, mean of the pairs of a face as a unit vector; 0 on a closed face"
    return dict(stored(Numbers(("face", "axis"), "1", words)))


@dataclass(frozen=True, eq=False)
class FaceDirections(Labelled):
    """Position and sliding directions of each contact face, in the axes x, y, z of the structure.

    Parameters
    ----------
    middle:
        (n_faces, 3) m, the mean position of the pairs.
    tangent1, tangent2:
        (n_faces, 3) unit vectors, the means of t1 and t2 of the pairs; zero on a closed face, where t1 and t2 have
        no mean. Maps of a face show t2 to the right and t1 upwards.

    Raises
    ------
    InputError
        for arrays that do not fit together, and for directions whose length is neither 1 nor 0.
    """

    middle: FloatArray = field(
        metadata=stored(Numbers(("face", "axis"), "m", "mean position of the pairs of a face", name="face_middle"))
    )
    tangent1: FloatArray = field(metadata=_direction("sliding direction t1"))
    tangent2: FloatArray = field(metadata=_direction("sliding direction t2"))

    def __post_init__(self) -> None:
        n_faces = len(self.middle)
        for name in ("middle", "tangent1", "tangent2"):
            array = finite_array(name, getattr(self, name))
            if array.shape != (n_faces, 3):
                raise InputError(
                    f"{name} must have shape ({n_faces}, 3), but its shape is {array.shape}.", arguments=[name]
                )
            object.__setattr__(self, name, array)
        for name in ("tangent1", "tangent2"):
            length = np.linalg.norm(getattr(self, name), axis=1)
            if (np.minimum(length, np.abs(length - 1.0)) > _ROUND_OFF).any():
                raise InputError(
                    f"{name} must contain unit vectors, or zeros for a closed face, but has lengths "
                    f"{', '.join(f'{each:g}' for each in length)}.",
                    arguments=[name],
                )

    def __repr__(self) -> str:
        return f"FaceDirections({len(self.middle)} faces)"
