"""Reader of model files of other programs, with conversion to SI units."""

from __future__ import annotations

from collections.abc import Callable
from os import PathLike
from pathlib import Path

from stickslip.core.registry import Registry
from stickslip.formats.meshes.abaqus import read_abaqus
from stickslip.formats.meshes.ansys import read_ansys
from stickslip.formats.meshes.build import build_model
from stickslip.formats.meshes.ideas import read_ideas
from stickslip.formats.meshes.imported_model import ImportedModel
from stickslip.formats.meshes.meshio_files import read_gmsh, read_med, read_vtk, read_vtu
from stickslip.formats.meshes.nastran import read_nastran
from stickslip.formats.meshes.raw_model import RawModel, fail
from stickslip.formats.meshes.unit_systems import find_unit_system

Reader = Callable[[Path, bool], RawModel]


def _alone(reader: Callable[[Path], RawModel]) -> Reader:
    """The reader of a format whose files include no others."""
    return lambda path, includes_outside: reader(path)


# Readers by file ending. Decks may include other files; an argument allows those outside of their folder.
_FORMATS: Registry[RawModel] = Registry(
    "model format",
    "stickslip.model_formats",
    {
        "inp": read_abaqus,
        **dict.fromkeys(("bdf", "nas", "dat", "fem"), read_nastran),
        "cdb": _alone(read_ansys),
        "unv": _alone(read_ideas),
        "msh": _alone(read_gmsh),
        "vtu": _alone(read_vtu),
        "vtk": _alone(read_vtk),
        "med": _alone(read_med),
    },
)
# Advice for a file of another kind.
_ADVICE = {
    **dict.fromkeys(
        (".stl", ".step", ".stp", ".iges", ".igs", ".brep", ".x_t", ".obj", ".ply"),
        "It contains a shape without solid elements: mesh it first, for example with Gmsh, and give the .msh file",
    ),
    **dict.fromkeys(
        (".odb", ".cae", ".op2", ".rst", ".db", ".frd", ".mph", ".hm", ".k", ".xdmf"),
        "Export the model as .inp, .bdf or .vtu from the program that wrote it",
    ),
    **dict.fromkeys(
        (".mtx", ".npz", ".npy", ".mat", ".op4", ".sti", ".mas", ".full", ".hb"),
        'It contains matrices: give it in a study with structure.kind = "matrices" (docs/matrices.md)',
    ),
    **dict.fromkeys((".toml", ".yaml", ".yml"), "It is a study file: give its mesh file, or use stickslip check"),
}


def register_model_format(name: str, reader: Reader) -> None:
    """Register a reader of model files in this process, under the ending of its files without the dot, such as "neu".

    ``reader(path, includes_outside)`` returns a :class:`RawModel` in the units of the file (docs/extending.md). A
    package that is installed uses an entry point of the group ``stickslip.model_formats`` instead. Raises InputError
    for the ending of another format.
    """
    _FORMATS.register(name, reader)


def read_model(
    path: str | PathLike[str],
    length_unit: str,
    unit_system: str | None = None,
    includes_outside: bool = False,
    temperature: float | None = None,
) -> ImportedModel:
    """Read a model into SI units: .inp (Abaqus, CalculiX), .bdf/.nas/.dat/.fem (Nastran), .cdb (Ansys), .unv
    (I-DEAS), .msh (Gmsh), .vtu, .vtk, .med.

    Other packages add formats through entry points of the group ``stickslip.model_formats`` (docs/extending.md).

    Parameters
    ----------
    length_unit:
        unit of the coordinates: m, dm, cm, mm, um, in, ft.
    unit_system:
        consistent system of moduli, densities and forces in the file, a key of ``UNIT_SYSTEMS``; by default newtons and
        seconds with metric lengths (mm: MPa and t/mm3), pounds-force and seconds with inches and feet.
    includes_outside:
        whether a deck may include files outside of its folder, for trusted decks.
    temperature:
        temperature of the material constants, in the unit of the file; by default the first row of their tables.

    Raises
    ------
    ImportFileError
        for a file that cannot be read, a format that is not known, and an entry that is wrong; it names file and line.
    InputError
        for a unit or system that does not exist or does not fit.
    """
    units = find_unit_system(length_unit, unit_system)
    return build_model(read_raw(path, includes_outside), units, temperature)


def is_model_file(path: str | PathLike[str]) -> bool:
    """Whether the name of a file has the ending of a model format."""
    return Path(path).suffix.lower().removeprefix(".") in _FORMATS.names()


def read_raw(path: str | PathLike[str], includes_outside: bool = False) -> RawModel:
    """The entries of a model file in its own units; arguments as :func:`read_model`. Raises ImportFileError."""
    source = Path(path)
    if source.is_dir():
        fail(source, "this is a folder. Give the path of a model file.")
    ending = source.suffix.lower()
    formats = _FORMATS.names()
    if ending.removeprefix(".") not in formats:
        advice = _ADVICE.get(ending, "Export the model in one of these, or use the usual ending of the format")
        fail(
            source,
            f"'{source.suffix}' is not a model format of stickslip; the formats are: "
            f"{', '.join(f'.{name}' for name in formats)}. {advice}.",
        )
    if not source.exists():
        fail(source, "the file does not exist.")
    return _FORMATS.find(ending.removeprefix("."))(source, includes_outside)
