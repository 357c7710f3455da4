"""The natural frequencies of a disk by nodal diameter, and the wave that excites it."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from stickslip.core.errors import InputError
from stickslip.core.validation import FloatArray, finite_array
from stickslip.results.variables import Count, Labelled, Numbers, Text, WholeNumbers, stored


@dataclass(frozen=True, eq=False)
class Disk(Labelled):
    """A tuned disk of which one sector was solved.

    Parameters
    ----------
    sectors, engine_order:
        number of sectors, and of waves of the excitation round the disk.
    direction:
        "forward" or "backward".
    diameters:
        (k,) nodal diameters, rising.
    stuck_hz, free_hz:
        (k, m) Hz, the lowest natural frequencies of each with all pairs that are closed at rest stuck, and without
        contact, motions of free bodies omitted; with Coriolis forces those of waves that travel as the excitation does.
    opposite_hz:
        (k, m) Hz, as ``stuck_hz``, of waves that travel the other way; None without Coriolis forces.

    Raises InputError for arrays that do not fit together, and diameters that the disk does not have.
    """

    sectors: int = field(metadata=stored(Count("number of sectors of the disk")))
    engine_order: int = field(metadata=stored(Count("number of waves of the excitation round the disk")))
    direction: str = field(metadata=stored(Text("direction of the wave: forward or backward")))
    diameters: NDArray[np.int64] = field(metadata=stored(WholeNumbers(("nodal_diameter",), "1", "nodal diameters")))
    stuck_hz: FloatArray = field(
        metadata=stored(
            Numbers(("nodal_diameter", "family"), "Hz", "natural frequencies, contacts closed at rest stuck")
        )
    )
    free_hz: FloatArray = field(
        metadata=stored(Numbers(("nodal_diameter", "family"), "Hz", "natural frequencies without contact"))
    )
    opposite_hz: FloatArray | None = field(
        default=None,
        metadata=stored(
            Numbers(
                ("nodal_diameter", "family"),
                "Hz",
                "natural frequencies of waves against the excitation, contacts closed at rest stuck",
                optional=True,
            )
        ),
    )

    def __post_init__(self) -> None:
        diameters = np.asarray(self.diameters, dtype=np.int64)
        if (
            self.sectors < 2
            or not diameters.size
            or (np.diff(diameters) <= 0).any()
            or diameters[0] < 0
            or diameters[-1] > self.sectors // 2
        ):
            raise InputError(
                f"diameters of a disk of {self.sectors} sectors must rise from 0 to {self.sectors // 2} at most.",
                arguments=["diameters"],
            )
        if self.direction not in ("forward", "backward") or self.engine_order < 0:
            raise InputError(
                f"the wave has engine order {self.engine_order} and direction {self.direction!r}; the order must be 0 "
                'or above, the direction "forward" or "backward".',
                arguments=["direction"],
            )
        for name in ("stuck_hz", "free_hz", "opposite_hz"):
            if getattr(self, name) is None:
                continue
            values = finite_array(name, getattr(self, name))
            if values.ndim != 2 or len(values) != diameters.size or np.shape(self.stuck_hz) != values.shape:
                raise InputError(
                    f"{name} must have one row for each of {diameters.size} nodal diameters, all of one length, but "
                    f"its shape is {values.shape}.",
                    arguments=[name],
                )
            object.__setattr__(self, name, values)
        object.__setattr__(self, "diameters", diameters)

    @property
    def diameter(self) -> int:
        """The nodal diameter that the engine order excites in the first harmonic."""
        rest = self.engine_order % self.sectors
        return min(rest, self.sectors - rest)
