"""Materials of Ansys archives: constants by MP, MPTEMP and MPDATA, isotropic or orthotropic, over the temperature.

Source: Ansys Mechanical APDL command reference, MP, MPDATA, MPTEMP; material reference, linear material properties.
PRXY is -(strain along y) / (strain along x) under a stress along x; NUXY that under a stress along y, so that
PRXY = NUXY EX / EY.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from stickslip.core.validation import FloatArray
from stickslip.formats.meshes.ansys_archive import Entry
from stickslip.formats.meshes.raw_materials import RawMaterial, RawTable
from stickslip.formats.meshes.raw_model import RawModel

_YOUNG = ("EX", "EY", "EZ")
_SHEAR = ("GXY", "GXZ", "GYZ")
_PAIRS = {"XY": ("EX", "EY"), "XZ": ("EX", "EZ"), "YZ": ("EY", "EZ")}
_ELASTIC = (*_YOUNG, *(f"{kind}{pair}" for kind in ("PR", "NU") for pair in _PAIRS), *_SHEAR)
# chosen: relative difference above which constants are those of an orthotropic material; archives have 9 digits.
_SAME = 1e-6


@dataclass
class _Table:
    line: int
    values: dict[int, tuple[float, float]] = field(default_factory=dict)  # position -> temperature, value


class Materials:
    """Reads MP, MPTEMP, MPDATA and TB; the other methods give what they say after the last command."""

    def __init__(self) -> None:
        self._tables: dict[tuple[int, str], _Table] = {}  # material, label
        self._temperatures: dict[int, float] = {}
        self._anisotropic: dict[int, int] = {}  # material -> line

    def take_constant(self, entry: Entry) -> None:
        """MP,label,material,value. Raises ImportFileError."""
        if len(entry.words) > 3 and any(entry.number(word) for word in entry.words[3:]):
            entry.fail("a polynomial of temperature is not read. Write the archive with MPDATA, or constants.")
        key = entry.label(entry.word(1)), entry.word(0)
        self._tables[key] = _Table(entry.line, {1: (0.0, entry.number(entry.word(2)))})

    def take_temperatures(self, entry: Entry) -> None:
        """MPTEMP,start,temperatures, or as CDWRITE writes it with two more words before. Raises ImportFileError.

        Without a start they follow the last ones; without anything they are erased.
        """
        words = _values(entry)
        start = entry.whole(words[0]) if words else 0
        if start == 1 or not any(words):
            self._temperatures = {}
        for at, word in enumerate(words[1:], start or max(self._temperatures, default=0) + 1):
            if word:
                self._temperatures[at] = entry.number(word)

    def take_table(self, entry: Entry) -> None:
        """MPDATA,label,material,start,values, or with two more words before. Raises ImportFileError.

        Without a start they follow the last ones of the same constant.
        """
        words = _values(entry)
        if len(words) < 4:
            entry.fail("a label, a material, a position and a value are required.")
        key, start = (entry.label(words[1]), words[0].upper()), entry.whole(words[2])
        if start == 1 or key not in self._tables:
            self._tables[key] = _Table(entry.line)
        for at, word in enumerate(words[3:], start or max(self._tables[key].values, default=0) + 1):
            if word:
                if at > 1 and at not in self._temperatures:
                    entry.fail(f"value {at} has no temperature; MPTEMP before it must give one.")
                self._tables[key].values[at] = self._temperatures.get(at, 0.0), entry.number(word)

    def take_nonlinear(self, entry: Entry) -> bool:
        """TB,kind,material,...: whether it is a table of anisotropic elasticity, which :meth:`write` rejects."""
        if entry.word(0) in ("ANEL", "ELAS", "ELASTIC"):
            self._anisotropic[entry.label(entry.word(1))] = entry.line
            return True
        return False

    def friction(self) -> dict[int, float]:
        """Material -> friction coefficient, the first of its table."""
        return {number: float(self._first(number, "MU")) for number, label in self._tables if label == "MU"}

    def numbers(self) -> list[int]:
        """Materials that have constants."""
        return list(dict.fromkeys(number for number, _ in self._tables))

    def write(self, raw: RawModel, numbers: list[int], used: set[int]) -> None:
        """Put materials into the model. Raises ImportFileError for ``used`` ones whose constants are not read."""
        for number in numbers:
            if number in used and number in self._anisotropic:
                raw.fail(
                    f"TB gives the elasticity of material {number}, which is not read. Give its constants with MP "
                    "or MPDATA, give the material in the study, or write the model as .inp.",
                    self._anisotropic[number],
                )
            raw.materials[str(number)] = self._material(raw, number, number in used)

    def _material(self, raw: RawModel, number: int, is_used: bool) -> RawMaterial:
        line = max((table.line for (other, _), table in self._tables.items() if other == number), default=0)
        rows, temperatures = self._rows(number)
        density = self._table(number, "DENS")
        young, poisson, shear = rows[:, :3], rows[:, 3:6], rows[:, 6:]
        alike = _is_same(young, young[:, :1]) and _is_same(poisson, poisson[:, :1])
        if alike and _is_same(shear, young[:, :1] / (2.0 * (1.0 + poisson[:, :1]))):
            return RawMaterial(RawTable(rows[:, [0, 3]], temperatures), density, line)
        missing = [label for label in _SHEAR if (number, label) not in self._tables]
        if missing and is_used:
            raw.fail(
                f"material {number} is orthotropic and has no {', '.join(missing)}. Give all of {', '.join(_SHEAR)}.",
                line,
            )
        return RawMaterial(RawTable(rows, temperatures), density, line, "engineering")

    def _rows(self, number: int) -> tuple[FloatArray, FloatArray]:
        """Constants (k, 9) E1, E2, E3, nu12, nu13, nu23, G12, G13, G23 at temperatures (k,); not a number where the
        archive has none. Those along y and z are those along x where they are missing."""
        places = [
            temperature
            for label in _ELASTIC
            if (table := self._tables.get((number, label))) is not None and len(table.values) > 1
            for temperature, _ in table.values.values()
        ]
        temperatures = np.unique(places) if places else np.zeros(1)
        at = {label: self._at(number, label, temperatures) for label in _ELASTIC}
        young = {label: np.where(np.isnan(at[label]), at["EX"], at[label]) for label in _YOUNG}
        poisson = {}
        for pair, (first, second) in _PAIRS.items():
            minor = at[f"NU{pair}"] * young[first] / young[second]
            poisson[pair] = np.where(np.isnan(at[f"PR{pair}"]), minor, at[f"PR{pair}"])
        ratios = [np.where(np.isnan(poisson[pair]), poisson["XY"], poisson[pair]) for pair in _PAIRS]
        return np.column_stack([*young.values(), *ratios, *(at[label] for label in _SHEAR)]), temperatures

    def _at(self, number: int, label: str, temperatures: FloatArray) -> FloatArray:
        """Values (k,) of a constant, linear between the temperatures of its table."""
        table = self._tables.get((number, label))
        if table is None:
            return np.full(temperatures.shape, np.nan)
        places, values = np.array(sorted(table.values.values())).T
        return np.asarray(np.interp(temperatures, places, values))

    def _table(self, number: int, label: str) -> RawTable:
        table = self._tables.get((number, label))
        if table is None:
            return RawTable.constant(None)
        places, values = np.array(sorted(table.values.values())).T
        return RawTable(values[:, None], places)

    def _first(self, number: int, label: str) -> float:
        return next(iter(self._tables[number, label].values.values()))[1]


def _values(entry: Entry) -> list[str]:
    """The words of a command without the two that CDWRITE puts before them."""
    return entry.words[2:] if entry.word(0).startswith(("R5", "UNBL")) else entry.words


def _is_same(values: FloatArray, wanted: FloatArray) -> bool:
    """Whether all values that exist are the wanted ones."""
    return bool(np.all(np.isnan(values) | np.isnan(wanted) | (np.abs(values - wanted) <= _SAME * np.abs(wanted))))
