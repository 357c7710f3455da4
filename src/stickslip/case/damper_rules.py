"""Rules between the kind of the damper of two blades and the other sections of a study file."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from math import degrees
from typing import Any

from stickslip.case.analysis import AnalysisSection, WearAnalysis
from stickslip.case.consistency import EntryError
from stickslip.case.law_keys import StiffnessLawSection
from stickslip.case.two_blade_sections import CylindricalSection, FlatSection, GeometrySection, WedgeSection

DamperSection = WedgeSection | FlatSection | CylindricalSection

# Below it, rounding decides where a cylinder or a wedge touches.
LEAST_ANGLE = 1e-6
_ANGLES = ("platform_angle", "right_platform_angle")


def with_two_blade_defaults(data: Any) -> Any:
    """The mappings of a study file without the defaults that another damper, or a rotation, replaces."""
    data = _with_damper_defaults(data)
    preload = data.get("preload", {}) if isinstance(data, Mapping) and "rotation" in data else None
    if isinstance(preload, Mapping) and "centrifugal_force" not in preload:
        return {**data, "preload": {"centrifugal_force": None, **preload}}
    return data


def _with_damper_defaults(data: Any) -> Any:
    """The data without the defaults that belong to a wedge, if they have another damper."""
    damper = data.get("damper") if isinstance(data, Mapping) else None
    kind = damper.get("kind", "wedge") if isinstance(damper, Mapping) else getattr(damper, "kind", "wedge")
    geometry = data.get("geometry", {}) if isinstance(data, Mapping) else None
    if kind not in ("flat", "cylindrical") or not isinstance(geometry, Mapping):
        return data
    replaced: dict[str, Any] = {"damper_flank_height": None}
    if kind == "flat":
        replaced["platform_angle"] = "0 deg"
    sections = {**data, "geometry": {**replaced, **geometry}}
    return sections if kind == "flat" else {"roughness": None, **sections}


def damper_errors(
    damper: DamperSection, geometry: GeometrySection, analysis: AnalysisSection, stiffness: Any, is_rough: bool
) -> Iterator[EntryError]:
    """Entries that contradict the kind of the damper.

    ``stiffness`` is the section [contact_stiffness] or None; ``is_rough`` says whether there is a [roughness].
    """
    for key in _ANGLES:
        angle = getattr(geometry, key)
        if angle is not None:
            yield from _angle_errors(key, angle, damper)
    if geometry.damper_flank_height is None and isinstance(damper, WedgeSection):
        yield EntryError(("geometry", "damper_flank_height"), "is missing. Give the height of the wedge's flanks.")
    elif geometry.damper_flank_height is not None and not isinstance(damper, WedgeSection):
        yield EntryError(
            ("geometry", "damper_flank_height"), f'belongs to a wedge, but damper.kind is "{damper.kind}". Remove it.'
        )
    if isinstance(damper, CylindricalSection):
        yield from _line_errors(damper, analysis, stiffness, is_rough)


def _angle_errors(key: str, angle: float, damper: DamperSection) -> Iterator[EntryError]:
    if isinstance(damper, FlatSection) and angle != 0.0:
        yield EntryError(
            ("geometry", key),
            f"is {degrees(angle):.4g} deg, but a flat damper requires flat platforms. Set it to 0 deg, or choose "
            "another damper.kind.",
        )
    if not isinstance(damper, FlatSection) and angle < LEAST_ANGLE:
        yield EntryError(
            ("geometry", key),
            f'is {degrees(angle):.4g} deg, but damper.kind = "{damper.kind}" requires inclined platforms. Set an angle '
            'above 0 deg, or damper.kind = "flat".',
        )


def _line_errors(
    damper: CylindricalSection, analysis: AnalysisSection, stiffness: Any, is_rough: bool
) -> Iterator[EntryError]:
    """What the contact lines of a cylinder have no use for."""
    if is_rough:
        yield EntryError(
            ("roughness",),
            'has no effect on damper.kind = "cylindrical": its contact lines are narrower than the waves of a rough '
            "face, and have the stiffness of Hertz. Remove the section, or give [contact_stiffness].",
        )
    if isinstance(stiffness, StiffnessLawSection):
        yield EntryError(
            ("contact_stiffness", "stiffness_law"),
            'is a stiffness per area, but damper.kind = "cylindrical" touches along lines. Give normal_stiffness and '
            "tangential_stiffness of a line, or remove the section.",
        )
    if isinstance(analysis, WearAnalysis):
        yield EntryError(
            ("analysis", "kind"),
            'is "wear", but wear is a depth over an area, and damper.kind = "cylindrical" touches along lines that '
            "become wider as they wear. Use a wedge or a flat damper.",
        )
    if damper.crowning >= damper.radius:
        yield EntryError(
            ("damper", "crowning"),
            f"is {1e6 * damper.crowning:.4g} um; it must be below the radius of {1e3 * damper.radius:.4g} mm.",
        )
