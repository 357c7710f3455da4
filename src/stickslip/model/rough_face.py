"""The rough faces of a study: their material, their roughness, their contact stiffness under a load."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from stickslip.case.case import Case, OwnCase, TwoBladeCase
from stickslip.case.sections import RoughnessSection
from stickslip.contact.stiffness.asperities import fully_plastic_load
from stickslip.contact.stiffness.believable import Believable, BesideOneSpot, beside_one_spot, compared
from stickslip.contact.stiffness.face_stiffness import law_of_roughness, persson_law
from stickslip.contact.stiffness.fractal import (
    ContactStiffness,
    Roughness,
    StiffnessMode,
    fractal_contact,
    reduced_modulus,
)
from stickslip.contact.stiffness.measured_heights import waves_of_heights
from stickslip.contact.stiffness.persson import PerssonStiffness
from stickslip.contact.stiffness.scaled_law import ScaledStiffness
from stickslip.contact.stiffness.stiffness_law import StiffnessLaw
from stickslip.contact.stiffness.surface import SurfaceStatistics, SurfaceWaves, surface_statistics
from stickslip.core.errors import InputError, concerning, keys_of_section
from stickslip.core.validation import FloatArray
from stickslip.structure.elasticity import Material


@dataclass(frozen=True)
class RoughFace:
    """Contact stiffness and regime of one rough contact face under its preload."""

    stiffness: ContactStiffness  # fractal law, of ``reference_area`` under the mean pressure of the face
    roughness: Roughness
    statistics: SurfaceStatistics
    reference_area: float  # m2, roughness.reference_area or the area of the face
    law_name: str
    mode: StiffnessMode  # of the fractal law
    law: StiffnessLaw  # that of the study
    persson: PerssonStiffness
    pressure: float  # Pa, mean

    @cached_property
    def believable(self) -> Believable | None:
        """The law of the study against Persson's; None for a face without load."""
        return compared(self.law, self.persson, self.pressure) if self.pressure > 0.0 else None

    @property
    def has_least_stiffness(self) -> bool:
        """Whether the study uses the least stiffness of the real area, because all spots are plastic. The law jumps
        where elastic spots begin."""
        return self.law_name == "fractal" and self.stiffness.is_least

    @cached_property
    def one_spot(self) -> BesideOneSpot | None:
        """The law of the study beside one round spot of the real area; None unless it is the sum of elastic spots."""
        is_sum = self.law_name == "fractal" and self.mode != "unloading" and not self.stiffness.is_least
        if not is_sum or self.pressure <= 0.0:
            return None
        return beside_one_spot(self.roughness, self.law, self.reference_area, self.pressure)

    @cached_property
    def messages(self) -> tuple[str, ...]:
        """Messages on the law of the study under this pressure."""
        if self.believable is None:
            return self.stiffness.messages
        own = self.stiffness.messages if self.law_name == "fractal" else self.law.valid(np.array([self.pressure]))
        name = f'the law "{self.law_name}"'
        outside = () if self.believable.is_inside else (self.believable.message(name),)
        below = (self.one_spot.message(name),) if self.one_spot is not None and self.one_spot.is_below else ()
        return (*own, *outside, *below)


def rough_face(roughness: Roughness, section: RoughnessSection, area: float, load: float) -> RoughFace:
    """A rough face of ``area`` (m2) under ``load`` (N): its fractal contact, and its law beside Persson's."""
    reference = section.reference_area or area
    pressure = load / area
    waves = waves_of(section)
    return RoughFace(
        fractal_contact(roughness, pressure * reference, mode=section.fractal_mode, area=reference),
        roughness,
        surface_statistics(roughness, waves.longest, waves.shortest),
        reference,
        section.law,
        section.fractal_mode,
        law_of_section(roughness, section, area),
        persson_law(roughness, area, section.form_length),
        pressure,
    )


def plastic_pressure(roughness: Roughness, section: RoughnessSection, reference_area: float) -> float | None:
    """Pa, up to which all spots of a face are plastic, where the law of the study depends on that; else None."""
    if section.law != "fractal" or section.mode == "unloading":
        return None
    return fully_plastic_load(roughness) / reference_area


def jump_warning(plastic: float, pressure: FloatArray) -> str | None:
    """A warning if some of the pairs, under their pressures (k,) in Pa, have plastic spots alone and others not."""
    count = np.count_nonzero(pressure <= plastic)
    if not 0 < count < pressure.size:
        return None
    return (
        f"Plastic pairs: under their own pressure {count} of {pressure.size} pairs have plastic spots alone, and the "
        "stiffness of one round spot of their real area; the others have elastic spots, of which the first ones have "
        f"almost no stiffness. So the fractal law jumps at {1e-6 * plastic:.3g} MPa, between the pairs. "
        'law = "persson" and mode = "unloading" have no jump.'
    )


def law_of_section(roughness: Roughness, section: RoughnessSection, area: float) -> StiffnessLaw:
    """The law that [roughness] names, for a face of ``area`` (m2), times its factor."""
    law = law_of_roughness(
        roughness,
        section.reference_area or area,
        section.law,
        mode=section.fractal_mode if section.law == "fractal" else None,
        tangential_law=section.tangential_law,
        form_length=section.form_length,
    )
    return law if section.stiffness_factor == 1.0 else ScaledStiffness(law, section.stiffness_factor)


def case_material(case: TwoBladeCase | OwnCase) -> Material:
    """The material of [material]. Raises InputError where a study of own structure has none."""
    if case.material is None:
        raise InputError("there is no section [material]. Give young_modulus, poisson_ratio and density.")
    section = case.material
    with keys_of_section("material"):
        return Material(
            section.young_modulus,
            section.poisson_ratio,
            section.density,
            section.fatigue_limit,
            section.tensile_strength,
        )


def roughness_section(case: Case) -> RoughnessSection:
    """The section [roughness]. Raises InputError where a study has none, though a face has no stiffness of its own."""
    if case.roughness is None:
        raise InputError("there is no section [roughness]. Give it, or the stiffness of each face.")
    return case.roughness


def case_roughness(case: Case, first: Material, second: Material) -> Roughness:
    """Roughness of a case that has one, between two bodies."""
    section = roughness_section(case)
    waves = waves_of(section)
    return Roughness(
        fractal_dimension=waves.fractal_dimension,
        fractal_roughness=waves.fractal_roughness,
        hardness=section.hardness,
        reduced_modulus=reduced_modulus(
            first.young_modulus, first.poisson_ratio, second.young_modulus, second.poisson_ratio
        ),
        poisson_ratio=_joint_poisson_ratio(first, second),
        domain_extension=section.domain_extension,
        frequency_ratio=waves.ratio,
        sample_length=waves.longest,
        shortest_length=waves.shortest,
    )


def waves_of(section: RoughnessSection) -> SurfaceWaves:
    """D, G and the waves of [roughness]: with G or Sq down to its shortest wave, or with Sq down to that of Sdq.

    Raises InputError for values that no surface has together.
    """
    dimension, longest, shortest = section.fractal_dimension, section.sample_length, section.shortest_length
    if section.sdq is not None and section.sq is not None:
        with concerning("roughness.sdq"):
            return waves_of_heights(section.sq, section.sdq, longest, dimension)
    if shortest is None:
        raise InputError("roughness.shortest_length or roughness.sdq must be given.", ("roughness.shortest_length",))
    if section.fractal_roughness is not None:
        return SurfaceWaves(dimension, section.fractal_roughness, longest, shortest)
    if section.sq is None:
        raise InputError("roughness.sq or roughness.fractal_roughness must be given.", ("roughness.sq",))
    with concerning("roughness.sq"):
        return SurfaceWaves(dimension, longest, longest, shortest).with_sq(section.sq)


def _joint_poisson_ratio(first: Material, second: Material) -> float:
    """The ratio nu for which two equal bodies have the K_t / K_n of these two, for the contact law of equal bodies.

    Mindlin: K_t / K_n = 4 G* / E*, 1/G* = (2 - nu1)/G1 + (2 - nu2)/G2, which is 2 (1 - nu)/(2 - nu) for equal bodies.
    """
    if first == second:
        return first.poisson_ratio
    compliance = sum(2.0 * (2.0 - m.poisson_ratio) * (1.0 + m.poisson_ratio) / m.young_modulus for m in (first, second))
    modulus = reduced_modulus(first.young_modulus, first.poisson_ratio, second.young_modulus, second.poisson_ratio)
    ratio = 4.0 / (compliance * modulus)
    return 2.0 * (1.0 - ratio) / (2.0 - ratio)
