"""From the materials of a model file to those of its bodies, in SI units and basic axes."""

from __future__ import annotations

import numpy as np

from stickslip.core.errors import InputError
from stickslip.core.validation import real_number
from stickslip.formats.meshes.raw_materials import RawMaterial, deck_matrix
from stickslip.formats.meshes.raw_model import RawBody, RawModel
from stickslip.formats.meshes.unit_systems import UnitSystem
from stickslip.structure.anisotropy import anisotropic_material, rotated_matrix
from stickslip.structure.elasticity import Material

_CONSTANTS = ("Young's modulus", "Poisson's ratio")


def build_materials(
    raw: RawModel, units: UnitSystem, temperature: float | None, names: tuple[str, ...], messages: list[str]
) -> dict[str, Material]:
    """Material in SI units of each body that has a complete one.

    ``temperature`` is in the unit of the file; None: the first row of each table, with a message. Raises
    ImportFileError for a material that does not exist or is not possible, InputError for a temperature that is not a
    number.
    """
    if temperature is not None:
        real_number("temperature", temperature)
    answer = {}
    for body in raw.bodies:
        if body.name not in names or body.material is None:
            continue
        if body.material not in raw.materials:
            raw.fail(
                f"body '{body.name}' has the material '{body.material}', which the file does not define.", body.line
            )
        material = raw.materials[body.material]
        elastic, density = material.elastic.at(temperature), float(material.density.at(temperature)[0])
        labels = _CONSTANTS if material.symmetry == "isotropic" else ("elastic constants",) * len(elastic)
        missing = [word for word, value in zip(labels, elastic, strict=True) if np.isnan(value)]
        missing += ["density"] if np.isnan(density) else []
        if missing:
            messages.append(
                f"material '{body.material}' has no {' and no '.join(dict.fromkeys(missing))}, so body '{body.name}' "
                "requires a material in the study file."
            )
            continue
        try:
            answer[body.name] = _material(body, material, elastic, density, units)
        except InputError as error:
            raw.fail(f"material '{body.material}': {error}", material.line)
    messages += _temperature_messages(raw, temperature)
    messages += [
        f"body '{name}' is anisotropic: the contact stiffness of rough faces uses the averages "
        f"{1e-9 * each.young_modulus:.4g} GPa and {each.poisson_ratio:.3g} over all directions."
        for name, each in answer.items()
        if each.elastic is not None
    ]
    return answer


def _material(body: RawBody, material: RawMaterial, elastic: np.ndarray, density: float, units: UnitSystem) -> Material:
    """Raises InputError for constants that are not possible."""
    if material.symmetry == "isotropic":
        return Material(units.pressure * elastic[0], float(elastic[1]), units.density * density)
    matrix = units.pressure * deck_matrix(material.symmetry, elastic)
    if body.axes is not None:
        matrix = rotated_matrix(matrix, body.axes)
    return anisotropic_material(matrix, units.density * density)


def _temperature_messages(raw: RawModel, temperature: float | None) -> list[str]:
    """The values that are used of constants that depend on temperature."""
    used = {body.material for body in raw.bodies}
    names = [name for name, each in raw.materials.items() if name in used and each.depends_on_temperature]
    if not names:
        return []
    words = ", ".join(f"'{name}'" for name in names)
    if temperature is None:
        return [
            f"constants of the materials {words} depend on temperature; stickslip uses the first row of each table. "
            "structure.temperature of a study (--temperature) gives another one."
        ]
    return [f"constants of the materials {words} are those at the temperature {temperature:g} of the file's unit."]
