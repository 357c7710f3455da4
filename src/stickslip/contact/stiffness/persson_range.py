"""The range in which boundary elements confirm Persson's law of contact stiffness."""

from __future__ import annotations

from collections.abc import Iterator

STEEPEST = 0.5  # Sdq of the elastic waves: the theory has small slopes; tan of 27 degrees
LARGEST_CONTACT = 0.9  # of the nominal area: the stiffness then depends on the last voids
LARGEST_PRESSURE = 1.0 / 3.0  # over the hardness: beyond it the body under the face flows too


def messages(pressure: float, contact_fraction: float, slope: float, hardness: float | None) -> Iterator[str]:
    """Messages on a highest pressure (Pa), its real over nominal area and Sdq of the waves that remain elastic."""
    if contact_fraction > LARGEST_CONTACT:
        yield (
            f"Complete contact: under {1e-6 * pressure:.3g} MPa the real contact is {100 * contact_fraction:.3g} % of "
            f"the face; above {100 * LARGEST_CONTACT:g} % the roughness has nearly no compliance left, and its value "
            "is not reliable. The compliance of the bodies then determines the joint."
        )
    if hardness is not None and pressure > LARGEST_PRESSURE * hardness:
        yield (
            f"Bulk flow: the pressure of {1e-6 * pressure:.4g} MPa is {pressure / hardness:.2g} of the hardness; above "
            "a third of it the body under the face flows too, and the law is not valid."
        )
    if slope > STEEPEST:
        yield (
            f"Steep surface: the slope of the waves that remain elastic is Sdq = {slope:.2g}, above {STEEPEST:g}; the "
            "law is for small slopes. Check G, Sq and their units."
        )
