"""Materials of Ansys archives: orthotropic constants, their axes, tables over the temperature, rejected commands."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from test_ansys import ARCHIVE

from sentences import rejects
from stickslip.core.errors import ImportFileError
from stickslip.core.validation import FloatArray
from stickslip.formats.meshes.imported_model import ImportedModel
from stickslip.formats.meshes.read import read_model
from stickslip.structure.anisotropy import orthotropic_matrix, rotated_matrix

YOUNG, POISSON, SHEAR = [160e3, 11e3, 9e3], [0.3, 0.25, 0.4], [6e3, 5e3, 3e3]  # MPa; xy, xz, yz
DIRECTED = {
    "EX": 160e3,
    "EY": 11e3,
    "EZ": 9e3,
    "PRXY": 0.3,
    "PRXZ": 0.25,
    "PRYZ": 0.4,
    "GXY": 6e3,
    "GXZ": 5e3,
    "GYZ": 3e3,
}
MINOR = {"NUXY": 0.3 * 11 / 160, "NUXZ": 0.25 * 9 / 160, "NUYZ": 0.4 * 9 / 11}
ELEMENT = f"{1:10d}{1:10d}{1:10d}{1:10d}{0:10d}"  # material, type, real constants, section, coordinate system
TURNED = ["LOCAL,R5.0,LOC,      12,  0,  0.0,  0.0,  0.0", "LOCAL,R5.0,ANG,      12,  0,  90.0,  0.0,  0.0"]


def table(label: str, values: list[float], temperatures: list[float], material: int = 1) -> list[str]:
    """Lines of a constant as CDWRITE writes them: three values in each."""
    lines = []
    for command, numbers in ((f"MPTEMP,R5.0,{len(values):2d},", temperatures), ("MPDATA", values)):
        for at in range(0, len(numbers), 3):
            words = "".join(f" {value:.9E}," for value in numbers[at : at + 3])
            if command == "MPDATA":
                lines.append(f"MPDATA,R5.0,{len(values):2d},{label:4},{material:8d},{at + 1:2d},{words}")
            else:
                lines.append(f"{command}{at + 1:2d},{words}")
    return lines


def constants(values: dict[str, float]) -> list[str]:
    return [line for label, value in values.items() for line in table(label, [value], [0.0])]


def archive_with(tmp_path: Path, lines: list[str], system: int = 0, temperature: float | None = None) -> ImportedModel:
    """The two cubes; the lines stand for the elastic constants of material 1, whose element has the system."""
    text = ARCHIVE.splitlines()
    own = [
        at
        for at, line in enumerate(text)
        if line.startswith(("MPDATA,R5.0, 1,EX  ,       1", "MPDATA,R5.0, 1,PRXY,       1"))
    ]
    assert len(own) == 2
    kept = [line for at, line in enumerate(text) if at not in own]
    assert sum(line.startswith(ELEMENT) for line in kept) == 1
    kept = [line.replace(ELEMENT, f"{ELEMENT[:40]}{system:10d}") if line.startswith(ELEMENT) else line for line in kept]
    at = next(at for at, line in enumerate(kept) if line.startswith("MPTEMP"))
    path = tmp_path / "materials.cdb"
    path.write_text("\n".join([*kept[:at], *lines, *kept[at:], ""]), encoding="utf-8")
    return read_model(path, "mm", temperature=temperature)


def elastic_mpa(model: ImportedModel) -> FloatArray:
    elastic = model.materials["material 1"].elastic
    assert elastic is not None
    return 1e-6 * np.array(elastic)


WANTED = orthotropic_matrix(YOUNG, POISSON, SHEAR)


@pytest.mark.parametrize(
    "lines",
    [
        constants(DIRECTED),
        constants({label: value for label, value in DIRECTED.items() if not label.startswith("PR")} | MINOR),
        [f"MP,{label},1,{value}" for label, value in DIRECTED.items()],
    ],
    ids=["major Poisson's ratios", "minor ones", "MP"],
)
def test_orthotropic_constants(tmp_path: Path, lines: list[str]) -> None:
    model = archive_with(tmp_path, lines)
    np.testing.assert_allclose(elastic_mpa(model), WANTED, rtol=1e-8, atol=1e-9)
    assert model.materials["material 2"].elastic is None


@pytest.mark.parametrize("system", [TURNED, ["LOCAL,12,0,1,2,3,90"]], ids=["CDWRITE", "command"])
def test_axes_are_those_of_the_system_of_the_elements(tmp_path: Path, system: list[str]) -> None:
    """Turned by 90 degrees about z: the x axis of the material is y."""
    found = elastic_mpa(archive_with(tmp_path, [*constants(DIRECTED), *system], 12))
    np.testing.assert_allclose(
        found, rotated_matrix(WANTED, np.array([[0, 1, 0], [-1, 0, 0], [0, 0, 1.0]])), rtol=1e-8, atol=1e-8
    )
    assert found[1, 1] == pytest.approx(WANTED[0, 0], rel=1e-8)


def test_an_isotropic_material_has_no_axes(tmp_path: Path) -> None:
    """Its nine constants agree, and a system that is not rectangular says nothing about it."""
    steel = dict.fromkeys(("EX", "EY", "EZ"), 210e3) | dict.fromkeys(("PRXY", "PRXZ"), 0.3) | {"GXY": 210e3 / 2.6}
    model = archive_with(tmp_path, [*constants(steel), "LOCAL,R5.0,LOC,12,1,0,0,0"], 12)
    material = model.materials["material 1"]
    assert (material.elastic, material.young_modulus, material.poisson_ratio) == (None, 210e9, 0.3)


@pytest.mark.parametrize(("temperature", "wanted"), [(None, 210e9), (350.0, 190e9), (900.0, 150e9)])
def test_constants_at_a_temperature(tmp_path: Path, temperature: float | None, wanted: float) -> None:
    """Two tables with other temperatures, more values than a line holds; linear between, constant beyond the ends."""
    lines = table("EX", [210e3, 200e3, 180e3, 150e3], [20.0, 300.0, 400.0, 500.0]) + table(
        "PRXY", [0.3, 0.34], [20.0, 420.0]
    )
    material = archive_with(tmp_path, lines, 0, temperature).materials["material 1"]
    assert material.young_modulus == pytest.approx(wanted, rel=1e-9)
    ratio = 0.3 if temperature is None else float(np.interp(temperature, [20.0, 420.0], [0.3, 0.34]))
    assert material.poisson_ratio == pytest.approx(ratio, rel=1e-9)


def test_a_table_without_positions_goes_on(tmp_path: Path) -> None:
    """As a user writes it: the second commands follow the first ones; the table of another time is erased."""
    lines = [
        "MPTEMP,1,0,1,2",
        "MPTEMP",
        "MPTEMP,,20,300",
        "MPTEMP,,500",
        "MPDATA,EX,1,1,210e3,200e3",
        "MPDATA,EX,1,,150e3",
    ]
    material = archive_with(tmp_path, [*lines, "MP,PRXY,1,0.3"], 0, 400.0).materials["material 1"]
    assert material.young_modulus == pytest.approx(175e9, rel=1e-9)


@pytest.mark.parametrize(
    ("lines", "system"),
    [
        (constants({label: value for label, value in DIRECTED.items() if label != "GXZ"}), 0),
        (["TB,ANEL,       1,   1,  21,   0", *constants({"EX": 2e5, "PRXY": 0.3})], 0),
        ([*constants(DIRECTED), "LOCAL,R5.0,LOC,      12,  1,  0.0,  0.0,  0.0"], 12),
        (constants(DIRECTED), 12),
        (["MPDATA,R5.0, 2,EX  ,       1, 1, 2E5, 1E5,"], 0),
        (constants({**DIRECTED, "PRXY": 5.0}), 0),
    ],
    ids=["no shear modulus", "anisotropic", "cylindrical", "no such system", "no temperature", "no positive energy"],
)
def test_what_is_rejected(tmp_path: Path, lines: list[str], system: int) -> None:
    with rejects(ImportFileError):
        archive_with(tmp_path, lines, system)


def test_a_nonlinear_table_is_told(tmp_path: Path) -> None:
    model = archive_with(tmp_path, ["TB,BISO,1,1,2,", *constants({"EX": 2e5, "PRXY": 0.3})])
    assert any("TB,BISO" in message for message in model.messages)
