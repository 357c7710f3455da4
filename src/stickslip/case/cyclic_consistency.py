"""Combinations of sections that a disk of equal sectors does not allow."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

from stickslip.case.analysis import AnalysisSection, ForcedAnalysis
from stickslip.case.consistency import EntryError
from stickslip.case.cyclic_sections import MistuningSection
from stickslip.case.interface_sections import InterfaceSection
from stickslip.case.own_sections import ForceSection, SectorRotationSection
from stickslip.case.sections import DampingSection


def sector_errors(
    analysis: AnalysisSection, damping: DampingSection, unbalance: Mapping[str, Any]
) -> Iterator[EntryError]:
    """What is not computed for a sector of a disk, and damping that is missing."""
    full = "is not computed for a sector of a disk"
    if not isinstance(analysis, ForcedAnalysis):
        yield EntryError(
            ("analysis", "kind"),
            f'is "{analysis.kind}", which {full}. Use "forced", or a mesh of the full ring with structure.kind = '
            '"mesh".',
        )
    for key in ("traction_band", "search", "gradients"):
        if getattr(analysis, key):
            yield EntryError(("analysis", key), f"is true, but this {full}. Set it to false.")
    if unbalance:
        yield EntryError(("unbalance",), f"{full}: its force would have to be alike in all sectors. Remove it.")
    if not any((damping.modal_damping_ratio, damping.rayleigh_alpha, damping.rayleigh_beta)):
        yield EntryError(
            ("damping", "modal_damping_ratio"),
            "is 0, but a sector of a disk requires viscous damping. Give it, 0.001 is usual for metal.",
        )


def mistuning_errors(
    mistuning: MistuningSection,
    damping: DampingSection,
    forces: Mapping[str, ForceSection],
    interfaces: Mapping[str, InterfaceSection],
    rotation: SectorRotationSection | None,
) -> Iterator[EntryError]:
    """What a mistuned disk cannot have."""
    if mistuning.damper_loads is not None:
        if not mistuning.friction_curve:
            yield EntryError(
                ("mistuning", "damper_loads"),
                "changes only the curve with friction, which this study does not compute. Set friction_curve = true, "
                "or remove the key.",
            )
        for name, interface in interfaces.items():
            if interface.other_law is not None:
                yield EntryError(
                    ("interfaces", name, "law"),
                    f'is "{interface.other_law}", but mistuning.damper_loads requires Coulomb friction. Remove one.',
                )
    if rotation is not None and rotation.top_speed is not None:
        yield EntryError(
            ("rotation", "top_speed"),
            "gives one reduction for several speeds, but the blades alone of [mistuning] are those of one speed. "
            "Remove one of the two.",
        )
    if rotation is not None and rotation.coriolis:
        yield EntryError(
            ("rotation", "coriolis"),
            "is true, but amplification factors of [mistuning] do not contain Coriolis forces. Set it to false.",
        )
    if damping.modal_damping_ratio is None:
        yield EntryError(
            ("damping", "modal_damping_ratio"),
            "is missing, but a disk with [mistuning] must have it: Rayleigh damping is not possible there. Give it, "
            "0.001 is usual for metal.",
        )
    for name, force in forces.items():
        if force.harmonic != 1:
            yield EntryError(
                ("forces", name, "harmonic"),
                f"is {force.harmonic}, but [mistuning] compares the peaks of one engine order. Set it to 1, or remove "
                "[mistuning].",
            )
