"""Heights of a rough face on a coarse grid, for the pages of a run, and statistics of the whole spectrum."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from stickslip.core.errors import InputError
from stickslip.core.validation import FloatArray, finite_array
from stickslip.results.variables import JsonMember, Labelled, Numbers, stored

_SIZES = stored(
    JsonMember(
        "length and width of that face, Sq (m) and Sdq of its roughness, JSON object",
        ("length", "width", "sq", "sdq"),
        name="rough_numbers",
    )
)


@dataclass(frozen=True, eq=False)
class RoughPatch(Labelled):
    """Heights of a rough face on a grid.

    Parameters
    ----------
    length, width:
        m, extent along and across; the grid has its first and last points on the edges.
    height:
        (n_across, n_along) m.
    sq, sdq:
        root mean square height in m and slope of all waves down to the shortest one, which a coarse grid cannot show.

    Raises
    ------
    InputError
        for heights that are not a grid of two or more points along both axes, and for an extent that is not above 0.
    """

    length: float = field(metadata=_SIZES)
    width: float = field(metadata=_SIZES)
    height: FloatArray = field(
        metadata=stored(Numbers(("rough_across", "rough_along"), "m", "heights of a rough face", name="rough_height"))
    )
    sq: float = field(metadata=_SIZES)
    sdq: float = field(metadata=_SIZES)

    def __post_init__(self) -> None:
        height = finite_array("height", self.height)
        if height.ndim != 2 or min(height.shape) < 2:
            raise InputError(
                f"height must have shape (n_across, n_along), both 2 or more, but its shape is {height.shape}.",
                arguments=["height"],
            )
        if not (self.length > 0.0 and self.width > 0.0):
            raise InputError(
                f"length and width must be above 0 m, but are {self.length:g} and {self.width:g} m.",
                arguments=["length", "width"],
            )
        object.__setattr__(self, "height", height)

    def __repr__(self) -> str:
        across, along = self.height.shape
        return f"RoughPatch({along} by {across} heights on {self.length:g} by {self.width:g} m, Sq {self.sq:.3g} m)"

    @property
    def along(self) -> FloatArray:
        """(n_along,) m."""
        return np.linspace(0.0, self.length, self.height.shape[1])

    @property
    def across(self) -> FloatArray:
        """(n_across,) m."""
        return np.linspace(0.0, self.width, self.height.shape[0])

    @property
    def about_mean(self) -> FloatArray:
        """(n_across, n_along) m, heights minus their mean."""
        about: FloatArray = self.height - self.height.mean()
        return about
