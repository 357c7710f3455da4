"""Dimensions and element counts of a two-blade study, as its mesh needs them."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from math import degrees

from stickslip.case.case import TwoBladeCase
from stickslip.case.two_blade_sections import CylindricalSection, FlatSection
from stickslip.core.errors import InputError, concerning
from stickslip.model.kinds.damper_shapes import Cylinder, DamperShape, Plate, Wedge
from stickslip.model.kinds.two_blade_geometry import BladePairElements, BladePairGeometry

# Name of a dimension or count -> its key of the study file, where it is not that of [geometry] with the same name.
_KEYS = {
    "platform_angle_deg": "geometry.platform_angle",
    "right_platform_angle_deg": "geometry.right_platform_angle",
    "radius": "damper.radius",
    "thickness": "damper.thickness",
    "contact_columns": "mesh.contact_columns",
    "damper_columns": "mesh.damper_columns",
}


@contextmanager
def about_dimensions() -> Iterator[None]:
    """In an InputError raised inside, replace the names of dimensions by the keys of the study file."""
    try:
        yield
    except InputError as error:
        names = () if error.are_arguments else error.keys
        keys = [_KEYS.get(name, f"geometry.{name}") for name in names]
        error.concern(*(keys or ["geometry"]))
        raise


def geometry_of(case: TwoBladeCase) -> BladePairGeometry:
    """The dimensions of a case. Raises InputError for parts that do not fit."""
    dimensions = case.geometry.model_dump()
    dimensions["platform_angle_deg"] = float(degrees(dimensions.pop("platform_angle")))
    right = dimensions.pop("right_platform_angle")
    dimensions["right_platform_angle_deg"] = None if right is None else float(degrees(right))
    if dimensions["damper_flank_height"] is None:
        del dimensions["damper_flank_height"]  # of a wedge alone
    with about_dimensions():
        return BladePairGeometry(**dimensions, damper=_shape_of(case))


def elements_of(case: TwoBladeCase) -> BladePairElements:
    """The element counts of a case. Raises InputError for too many."""
    counts = case.mesh.model_dump()
    del counts["element"]
    with concerning("mesh"):
        return BladePairElements(**counts)


def _shape_of(case: TwoBladeCase) -> DamperShape:
    section = case.damper
    if isinstance(section, FlatSection):
        return Plate(section.thickness)
    return Cylinder(section.radius) if isinstance(section, CylindricalSection) else Wedge()
