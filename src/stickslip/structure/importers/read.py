"""Reading a model file of another program into SI units."""

from __future__ import annotations

from collections.abc import Callable
from os import PathLike
from pathlib import Path

from stickslip.structure.importers.abaqus import read_abaqus
from stickslip.structure.importers.build import build_model
from stickslip.structure.importers.imported_model import ImportedModel
from stickslip.structure.importers.meshio_files import read_gmsh, read_med, read_vtu
from stickslip.structure.importers.nastran import read_nastran
from stickslip.structure.importers.raw_model import RawModel, fail
from stickslip.structure.importers.unit_systems import find_unit_system

_READERS: dict[str, Callable[[Path], RawModel]] = {
    ".inp": read_abaqus,
    ".bdf": read_nastran,
    ".nas": read_nastran,
    ".dat": read_nastran,
    ".fem": read_nastran,
    ".msh": read_gmsh,
    ".vtu": read_vtu,
    ".med": read_med,
}


def read_model(path: str | PathLike[str], length_unit: str, unit_system: str | None = None) -> ImportedModel:
    """Read a model into SI units: .inp (Abaqus, CalculiX), .bdf/.nas/.dat/.fem (Nastran), .msh (Gmsh), .vtu, .med.

    Parameters
    ----------
    length_unit:
        unit of the coordinates: m, dm, cm, mm, um, in, ft.
    unit_system:
        consistent system of moduli, densities and forces in the file, a key of ``UNIT_SYSTEMS``; by default newtons and
        seconds with metric lengths (mm: MPa and t/mm3), pounds-force and seconds with inches and feet.

    Raises
    ------
    ImportFileError
        for a file that cannot be read, a format that is not known, and an entry that is wrong; it names file and line.
    InputError
        for a unit or system that does not exist or does not fit.
    """
    units = find_unit_system(length_unit, unit_system)
    return build_model(read_raw(path), units)


def read_raw(path: str | PathLike[str]) -> RawModel:
    """The entries of a model file in its own units. Raises ImportFileError."""
    source = Path(path)
    reader = _READERS.get(source.suffix.lower())
    if reader is None:
        fail(source, f"'{source.suffix}' is no model format that can be read; there are: {', '.join(_READERS)}.")
    if not source.is_file():
        fail(source, "there is no such file.")
    return reader(source)
