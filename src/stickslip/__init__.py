"""stickslip: forced vibration of structures with rough, dry-friction joints.

The public names are imported when they are first used, so that ``import stickslip`` costs nothing.
"""

from __future__ import annotations

import sys
from importlib import import_module
from types import ModuleType
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from stickslip.case.case import Case, load_case
    from stickslip.contact.law.contact_pairs import ContactPairs
    from stickslip.contact.law.coulomb import contact_cycle
    from stickslip.contact.law.normal_law import PressureGapLaw
    from stickslip.contact.pairing.pairing import pair_faces, pair_surfaces, pair_with_ground
    from stickslip.contact.stiffness.fractal import Roughness, contact_stiffness
    from stickslip.contact.stiffness.roughness_fit import RoughnessFit, fit_roughness
    from stickslip.contact.stiffness.surface import fractal_surface
    from stickslip.formats.calculix_deck import write_calculix_deck
    from stickslip.formats.matrices.exchange import read_superelement, write_superelement
    from stickslip.formats.matrices.model import MatrixModel
    from stickslip.formats.matrices.read import read_matrices
    from stickslip.formats.matrices.reduce import reduce_matrices
    from stickslip.results.response import ForcedResponse
    from stickslip.solve.forced import forced_response
    from stickslip.solve.static.load_ramp import StaticState
    from stickslip.solve.static.ramp_to_rest import static_preload
    from stickslip.structure.craig_bampton import craig_bampton
    from stickslip.structure.elasticity import Material, Structure, assemble
    from stickslip.structure.mesh import Mesh
    from stickslip.structure.superelement import Superelement
    from stickslip.study.run import report, run
    from stickslip.sweeps.run import sweep

    __version__: str

_HOME = {
    "Case": "case",
    "ContactPairs": "interface.contact_pairs",
    "PressureGapLaw": "interface.normal_law",
    "StaticState": "solve.static_ramp",
    "static_preload": "solve.static",
    "ForcedResponse": "results.response",
    "Material": "structure.elasticity",
    "MatrixModel": "structure.matrix_files.model",
    "Mesh": "structure.mesh",
    "Roughness": "interface.stiffness",
    "RoughnessFit": "interface.roughness_fit",
    "Structure": "structure.elasticity",
    "Superelement": "structure.superelement",
    "assemble": "structure.elasticity",
    "contact_cycle": "interface.friction",
    "contact_stiffness": "interface.stiffness",
    "craig_bampton": "structure.craig_bampton",
    "fit_roughness": "interface.roughness_fit",
    "forced_response": "solve.forced",
    "fractal_surface": "interface.surface",
    "load_case": "case",
    "pair_faces": "interface.pairing",
    "pair_surfaces": "interface.pairing",
    "pair_with_ground": "interface.pairing",
    "read_matrices": "structure.matrix_files.read",
    "read_superelement": "structure.matrix_files.exchange",
    "reduce_matrices": "structure.matrix_files.reduce",
    "run": "study",
    "sweep": "sweeps.run",
    "write_calculix_deck": "structure.calculix_deck",
    "write_superelement": "structure.matrix_files.exchange",
}

__all__ = [
    "Case",
    "ContactPairs",
    "ForcedResponse",
    "Material",
    "MatrixModel",
    "Mesh",
    "PressureGapLaw",
    "Roughness",
    "RoughnessFit",
    "StaticState",
    "Structure",
    "Superelement",
    "__version__",
    "assemble",
    "contact_cycle",
    "contact_stiffness",
    "craig_bampton",
    "fit_roughness",
    "forced_response",
    "fractal_surface",
    "load_case",
    "pair_faces",
    "pair_surfaces",
    "pair_with_ground",
    "read_matrices",
    "read_superelement",
    "reduce_matrices",
    "report",
    "run",
    "static_preload",
    "sweep",
    "write_calculix_deck",
    "write_superelement",
]


class _ReportPackage(ModuleType):
    """The sub-package ``stickslip.reporting``, which can be called: the public verb ``report`` has the same name."""

    def __call__(self, *arguments: Any, **options: Any) -> Any:
        """``stickslip.study.run.report``."""
        return import_module("stickslip.study.run").report(*arguments, **options)


class _Package(ModuleType):
    """This package; the import system binds sub-packages to it with ``setattr``."""

    def __setattr__(self, name: str, value: Any) -> None:
        if name == "report" and isinstance(value, ModuleType):
            value.__class__ = _ReportPackage
        super().__setattr__(name, value)


sys.modules[__name__].__class__ = _Package


def __getattr__(name: str) -> Any:
    if name == "__version__":
        from importlib.metadata import version

        return version("stickslip")
    if name == "report":
        return import_module("stickslip.reporting")
    if name not in _HOME:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    value = getattr(import_module(f"stickslip.{_HOME[name]}"), name)
    globals()[name] = value
    return value


def __dir__() -> list[str]:
    return sorted({*globals(), *__all__})
