"""The material of each body of a mesh: of the study, of the mesh file, or common to all bodies."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import ArrayLike

from stickslip.case.case import SolidCase
from stickslip.case.own_sections import BodySection
from stickslip.case.template import bare_name
from stickslip.core.errors import InputError, keys_of_section
from stickslip.formats.meshes.imported_model import ImportedModel
from stickslip.structure.anisotropy import anisotropic_material, orthotropic_matrix, rotated_matrix
from stickslip.structure.elasticity import Material

_ISOTROPIC = ("young_modulus", "poisson_ratio")
_ORTHOTROPIC = ("young_moduli", "poisson_ratios", "shear_moduli")
_AXES = ("axis_1", "axis_2")
_PARALLEL = 1e-6  # sine of the angle of two axes below which they count as parallel


def body_materials(case: SolidCase, source: ImportedModel) -> tuple[Material, ...]:
    """Material of each body: of [bodies.NAME], else of the file, else of [material]. Raises InputError."""
    names = source.mesh.body_names
    unknown = [name for name in case.bodies if name not in names]
    if unknown:
        raise InputError(
            f"[bodies.{bare_name(unknown[0])}] is not a body of {source.source}; its bodies are: {', '.join(names)}.",
            (f"bodies.{unknown[0]}",),
        )
    return tuple(_material(case, name, source) for name in names)


def _material(case: SolidCase, name: str, source: ImportedModel) -> Material:
    sections = (case.bodies.get(name), source.materials.get(name), case.material)
    keys, strengths = ("young_modulus", "poisson_ratio", "density"), ("fatigue_limit", "tensile_strength")
    values: dict[str, float] = {}
    for key in (*keys, *strengths):
        candidates = [getattr(each, key, None) for each in sections if each is not None]
        present = [value for value in candidates if value is not None]
        if present:
            values[key] = present[0]
    elastic = _elastic(case, name, source)
    missing = [key for key in keys if key not in values and (elastic is None or key == "density")]
    if missing:
        # an incomplete material of the file is not used in part
        messages = [words for words in source.messages if words.startswith("material ") and f"body '{name}'" in words]
        section = f"[bodies.{bare_name(name)}]"
        raise InputError(
            f"body '{name}' has no {', no '.join(missing)}: neither {section}, nor the mesh file, nor [material] "
            f"gives it.{' In the file, ' + messages[0] if messages else ''} Give a section {section} for this body, or "
            "[material] for all bodies without one.",
            (f"bodies.{name}" if name in case.bodies else "structure.file",),
        )
    home = f"bodies.{name}" if name in case.bodies else "material"
    with keys_of_section(home):
        if elastic is None:
            made = Material(values["young_modulus"], values["poisson_ratio"], values["density"])
        else:
            made = anisotropic_material(elastic, values["density"])
        return replace(made, fatigue_limit=values.get("fatigue_limit"), tensile_strength=values.get("tensile_strength"))


def _elastic(case: SolidCase, name: str, source: ImportedModel) -> ArrayLike | None:
    """Elastic matrix of an anisotropic body in x, y, z, of the study or the file; None for an isotropic one.

    Raises InputError for orthotropic constants that are incomplete, beside isotropic ones, or not possible.
    """
    section, of_file = case.bodies.get(name), source.materials.get(name)
    own = of_file.elastic if of_file is not None else None
    if section is None:
        return own
    home = f"bodies.{name}"
    isotropic, given, axes = (
        [key for key in keys if getattr(section, key) is not None] for keys in (_ISOTROPIC, _ORTHOTROPIC, _AXES)
    )
    if given and isotropic:
        raise InputError(
            f"body '{name}' has {given[0]} of an orthotropic material and {isotropic[0]} of an isotropic one. Remove "
            "one of them.",
            (f"{home}.{given[0]}", f"{home}.{isotropic[0]}"),
        )
    if own is not None and len(isotropic) == 1:
        raise InputError(
            f"body '{name}' is anisotropic in the file, and the study gives {isotropic[0]} only. Give young_modulus "
            "and poisson_ratio for an isotropic body, or neither.",
            (f"{home}.{isotropic[0]}",),
        )
    if axes and not given:
        raise InputError(
            f"body '{name}' has {axes[0]}, which belongs to {', '.join(_ORTHOTROPIC)}. Give these, or remove it.",
            (f"{home}.{axes[0]}",),
        )
    if given:
        return _orthotropic(name, section)
    return None if isotropic else own


def _orthotropic(name: str, section: BodySection) -> ArrayLike:
    """Elastic matrix of orthotropic constants of the study in x, y, z. Raises InputError."""
    home = f"bodies.{name}"
    moduli, ratios, shears = section.young_moduli, section.poisson_ratios, section.shear_moduli
    if moduli is None or ratios is None or shears is None:
        missing = [key for key in _ORTHOTROPIC if getattr(section, key) is None]
        raise InputError(
            f"body '{name}' has no {', no '.join(missing)}. An orthotropic body requires {', '.join(_ORTHOTROPIC)}.",
            tuple(f"{home}.{key}" for key in _ORTHOTROPIC if key not in missing),
        )
    first, second = np.array(section.axis_1 or (1.0, 0.0, 0.0)), np.array(section.axis_2 or (0.0, 1.0, 0.0))
    third = np.cross(first, second)
    if not np.linalg.norm(third) > _PARALLEL:
        raise InputError(
            f"body '{name}': axis_1 and axis_2 are parallel, so they define no axes. Give another one.",
            tuple(f"{home}.{key}" for key in _AXES if getattr(section, key) is not None),
        )
    third /= np.linalg.norm(third)
    try:
        matrix = orthotropic_matrix(moduli, ratios, shears)
    except InputError as error:
        raise InputError(f"body '{name}': {error}", (f"{home}.poisson_ratios",)) from error
    return rotated_matrix(matrix, np.vstack([first, np.cross(third, first), third]))
