"""The effect of a contact stiffness that was not measured: the curves at both ends of its band."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import ClassVar

from numpy.typing import ArrayLike

from stickslip.core.validation import FloatArray
from stickslip.results.peaks import Peak, peaks
from stickslip.results.side_curves import SideCurves
from stickslip.results.variables import Numbers, stored


@dataclass(frozen=True, eq=False)
class StiffnessBand(SideCurves):
    """Curves of the same study with another contact stiffness, normal and tangential, of its rough faces.

    Two methods of measurement differ by a factor 3 on one contact (Mulvihill et al., Exp. Mech. 53 (2013) 1245), so the
    band is 1/3 to 3 of the law. The peak need not be monotonic between both ends.

    Parameters
    ----------
    names, complete, curve, frequency_hz, displacement:
        as in :class:`SideCurves`.
    factor:
        (n_curves,) stiffness of each curve over that of the study.
    """

    DATASET_TITLE: ClassVar[str] = "Curves with other contact stiffness"

    factor: FloatArray = field(metadata=stored(Numbers(("side_curve",), "1", "stiffness over that of the study")))

    def __repr__(self) -> str:
        return f"StiffnessBand({', '.join(self.names)})"

    def curve_peaks(self, output: ArrayLike) -> tuple[Peak, ...]:
        """(n_curves,) the highest peak of each curve, as amplitude of an output (n,). Raises InputError."""
        return tuple(peaks(each.frequency_hz, each.amplitude)[0] for each in self.curves(output))
