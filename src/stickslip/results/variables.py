"""Results that write themselves: each field of a class defines its storage and its labels once.

    residual: FloatArray = field(metadata=stored(Numbers(("point",), "1", "relative residual of the balance")))

From such fields :class:`Labelled` makes the dataset and the groups of a file, and an object from the groups of a file.
A new number is one line in its class.
"""

from __future__ import annotations

import json
from abc import ABC, abstractmethod
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, fields
from typing import TYPE_CHECKING, Any, ClassVar, Self

import numpy as np

from stickslip.core.plain_data import plain, same_content
from stickslip.core.validation import FloatArray, argument_error, finite_array
from stickslip.results.stored import StoredGroup, UnreadableError

if TYPE_CHECKING:
    import xarray

_KEY = "stored"
Variables = dict[str, tuple[Any, ...]]


@dataclass(frozen=True, kw_only=True)
class Entry(ABC):
    """Storage of one field.

    name:
        of its variable; by default that of the field.
    optional:
        the variable may be absent, because the field was None or the file is older; the field then has its default.
    """

    name: str = ""
    optional: bool = False

    def label(self, field: str) -> str:
        """Name of the variable of a field."""
        return self.name or field

    def is_in(self, group: StoredGroup, field: str) -> bool:
        """Whether the group has the field."""
        return self.label(field) in group

    def variables(self, owner: Any, field: str) -> Variables:
        """Variables of the dataset: name -> dimensions, values, attributes."""
        return {}

    def attributes(self, owner: Any, field: str) -> dict[str, Any]:
        """Attributes of the dataset."""
        return {}

    def groups(self, owner: Any, field: str) -> dict[str, xarray.Dataset]:
        """Further groups of the file."""
        return {}

    def checked(self, field: str, value: Any, sizes: Mapping[str, int]) -> Any:
        """The value of a field, after a check against the sizes of the dimensions. Raises InputError."""
        return value

    @abstractmethod
    def read(self, group: StoredGroup, field: str, harmonics: int) -> Any:
        """The value of a field; ``harmonics`` is the number of harmonics of the response. Raises UnreadableError."""


def stored(entry: Entry) -> dict[str, Entry]:
    """The metadata of a dataclass field with this storage."""
    return {_KEY: entry}


@dataclass(frozen=True)
class Numbers(Entry):
    """Real numbers along named dimensions; an array of fewer dimensions has the first of them."""

    dims: tuple[str, ...]
    unit: str
    long_name: str
    stored_as: type[np.generic] = np.float64
    read_as: ClassVar[type[np.generic]] = np.float64

    def variables(self, owner: Any, field: str) -> Variables:
        values = np.asarray(getattr(owner, field), dtype=self.stored_as)
        return {self.label(field): variable(self.dims[: values.ndim], values, self.unit, self.long_name)}

    def read(self, group: StoredGroup, field: str, harmonics: int) -> Any:
        return group.numbers(self.label(field))

    def checked(self, field: str, value: Any, sizes: Mapping[str, int]) -> Any:
        array = finite_array(field, value)
        require_shape(field, array, tuple(sizes[name] for name in self.dims))
        return array.astype(self.read_as)


@dataclass(frozen=True)
class WholeNumbers(Numbers):
    """Whole numbers along named dimensions."""

    stored_as: type[np.generic] = np.int64
    read_as: ClassVar[type[np.generic]] = np.int64

    def read(self, group: StoredGroup, field: str, harmonics: int) -> Any:
        return group.integers(self.label(field))


@dataclass(frozen=True)
class Flags(WholeNumbers):
    """Yes or no along named dimensions, as 1 and 0."""

    stored_as: type[np.generic] = np.int8

    def read(self, group: StoredGroup, field: str, harmonics: int) -> Any:
        return group.integers(self.label(field)) != 0

    def checked(self, field: str, value: Any, sizes: Mapping[str, int]) -> Any:
        return super().checked(field, value, sizes) != 0


@dataclass(frozen=True)
class Count(Entry):
    """One whole number."""

    long_name: str

    def variables(self, owner: Any, field: str) -> Variables:
        return {self.label(field): variable((), getattr(owner, field), "1", self.long_name)}

    def read(self, group: StoredGroup, field: str, harmonics: int) -> int:
        values = group.integers(self.label(field))
        if values.size != 1:
            raise UnreadableError(f'the variable "{self.label(field)}" is not one whole number')
        return int(values.item())


@dataclass(frozen=True)
class Coefficients(Entry):
    """Fourier coefficients (*dims, 2 * harmonics + 1) as their mean, cosine and sine parts.

    ``excited_only`` leaves out harmonics that are zero everywhere above the highest other one; they are zero after
    reading.
    """

    dims: tuple[str, ...]
    unit: str
    long_name: str
    harmonic: str = "harmonic"
    excited_only: bool = False

    def variables(self, owner: Any, field: str) -> Variables:
        array, name, dims = getattr(owner, field), self.label(field), (*self.dims, self.harmonic)
        if self.excited_only:
            array = _excited(array)
        return {
            f"{name}_mean": variable(self.dims, array[..., 0], self.unit, f"{self.long_name}, mean over the period"),
            f"{name}_cosine": variable(dims, array[..., 1::2], self.unit, f"{self.long_name}, cosine part"),
            f"{name}_sine": variable(dims, array[..., 2::2], self.unit, f"{self.long_name}, sine part"),
        }

    def read(self, group: StoredGroup, field: str, harmonics: int) -> FloatArray:
        name = self.label(field)
        mean, cosine, sine = (group.numbers(f"{name}_{part}") for part in ("mean", "cosine", "sine"))
        if cosine.shape != sine.shape or cosine.shape[:-1] != mean.shape or cosine.shape[-1] > harmonics:
            raise UnreadableError(f'the parts of "{name}" do not have compatible shapes')
        array = np.zeros((*mean.shape, 2 * harmonics + 1))
        stop = 2 * cosine.shape[-1] + 1
        array[..., 0], array[..., 1:stop:2], array[..., 2:stop:2] = mean, cosine, sine
        return array

    def checked(self, field: str, value: Any, sizes: Mapping[str, int]) -> FloatArray:
        array = finite_array(field, value)
        require_shape(field, array, (*(sizes[name] for name in self.dims), 2 * sizes["harmonic"] + 1))
        return array


@dataclass(frozen=True)
class HarmonicNumbers(Entry):
    """The number of harmonics, as the coordinate 1, 2, ... of the dimension ``harmonic``."""

    def variables(self, owner: Any, field: str) -> Variables:
        numbers = np.arange(1, getattr(owner, field) + 1)
        return {"harmonic": variable(("harmonic",), numbers, "1", "harmonic number")}

    def read(self, group: StoredGroup, field: str, harmonics: int) -> int:
        return harmonics


@dataclass(frozen=True)
class Attribute(Entry):
    """A whole number or a bool from ``least`` to ``most``, as an attribute of the group."""

    least: int
    most: int
    kind: type[int] = int

    def attributes(self, owner: Any, field: str) -> dict[str, Any]:
        return {self.label(field): int(getattr(owner, field))}

    def read(self, group: StoredGroup, field: str, harmonics: int) -> int:
        return self.kind(group.whole_number(self.label(field), self.least, self.most))


@dataclass(frozen=True)
class Text(Entry):
    """A text. Attributes of HDF5 end at 64 kB, variables do not."""

    long_name: str

    def variables(self, owner: Any, field: str) -> Variables:
        return {self.label(field): ((), getattr(owner, field), {"long_name": self.long_name})}

    def read(self, group: StoredGroup, field: str, harmonics: int) -> str:
        return group.text(self.label(field))


@dataclass(frozen=True)
class Json(Entry):
    """Plain data as JSON; ``kind`` is its type, such as ``list[str]``, which the reader checks."""

    kind: Any
    long_name: str

    def variables(self, owner: Any, field: str) -> Variables:
        return {self.label(field): json_text(getattr(owner, field), self.long_name)}

    def read(self, group: StoredGroup, field: str, harmonics: int) -> Any:
        return group.parsed(self.label(field), self.kind)


@dataclass(frozen=True)
class JsonMember(Entry):
    """One number of a JSON object that stores all fields of ``together``."""

    long_name: str
    together: tuple[str, ...]

    def variables(self, owner: Any, field: str) -> Variables:
        numbers = {each: getattr(owner, each) for each in self.together}
        return {self.label(field): json_text(numbers, self.long_name)}

    def read(self, group: StoredGroup, field: str, harmonics: int) -> float:
        numbers = group.parsed(self.label(field), dict[str, float])
        if set(numbers) != set(self.together):
            raise UnreadableError(
                f'the text "{self.label(field)}" does not have the numbers {", ".join(self.together)}'
            )
        return float(numbers[field])


@dataclass(frozen=True)
class NamedRows(Entry):
    """Rows of one length by name: a matrix, and the names as JSON."""

    dims: tuple[str, str]
    unit: str
    long_name: str
    names: str
    long_name_of_names: str

    def variables(self, owner: Any, field: str) -> Variables:
        rows = getattr(owner, field)
        return {
            self.label(field): variable(self.dims, np.stack(list(rows.values())), self.unit, self.long_name),
            self.names: json_text(list(rows), self.long_name_of_names),
        }

    def read(self, group: StoredGroup, field: str, harmonics: int) -> dict[str, FloatArray]:
        names, rows = group.parsed(self.names, list[str]), group.numbers(self.label(field))
        if rows.ndim != 2 or len(names) != len(rows):
            raise UnreadableError(f'"{self.label(field)}" does not have one row for each of "{self.names}"')
        return dict(zip(names, rows, strict=True))


@dataclass(frozen=True)
class Embedded(Entry):
    """An object whose variables are among those of its owner; absent where its variable ``name`` is."""

    of: type[Labelled]

    def variables(self, owner: Any, field: str) -> Variables:
        return getattr(owner, field)._variables()  # type: ignore[no-any-return]

    def read(self, group: StoredGroup, field: str, harmonics: int) -> Labelled:
        return self.of.from_group(group, harmonics)


@dataclass(frozen=True)
class InGroup(Entry):
    """An object in a group of its own, named from the root; ``write`` gives its groups, ``restore`` reads it."""

    write: Callable[[Any, str], dict[str, xarray.Dataset]]
    restore: Callable[[StoredGroup, int], Any]

    @classmethod
    def of(cls, kind: type[Labelled], optional: bool = False) -> InGroup:
        """The entry of an object that is labelled itself."""
        return cls(kind.to_groups, kind.from_group, optional=optional)

    def is_in(self, group: StoredGroup, field: str) -> bool:
        return self.label(field) in _root(group)

    def groups(self, owner: Any, field: str) -> dict[str, xarray.Dataset]:
        return self.write(getattr(owner, field), self.label(field))

    def read(self, group: StoredGroup, field: str, harmonics: int) -> Any:
        return self.restore(_root(group).subgroup(self.label(field)), harmonics)


class Labelled:
    """Base of dataclasses whose fields define their storage. Equal objects agree in every entry."""

    DATASET_TITLE: ClassVar[str] = ""

    def __eq__(self, other: object) -> bool:
        return same_content(self, other) if type(other) is type(self) else NotImplemented

    __hash__ = None  # type: ignore[assignment]

    def to_dataset(self) -> xarray.Dataset:
        """The variables of this object with units and names, as in its group of a results file."""
        import xarray

        attributes = {"title": self.DATASET_TITLE} if self.DATASET_TITLE else {}
        for name, entry in self._written():
            attributes |= entry.attributes(self, name)
        return xarray.Dataset(self._variables(), attrs=attributes)

    def to_groups(self, group: str = "") -> dict[str, xarray.Dataset]:
        """Name of a group of a results file -> its dataset; ``group`` is that of this object, "" the root."""
        groups = {group: self.to_dataset()}
        for name, entry in self._written():
            groups |= entry.groups(self, name)
        return groups

    @classmethod
    def from_group(cls, group: StoredGroup, harmonics: int = 0) -> Self:
        """The object in a group of a results file.

        ``harmonics`` is the number of harmonics of the response. Raises UnreadableError for content that no run writes,
        and InputError for parts that do not fit together.
        """
        return cls(
            **{
                name: entry.read(group, name, harmonics)
                for name, entry in _entries(cls)
                if not entry.optional or entry.is_in(group, name)
            }
        )

    def _variables(self) -> Variables:
        variables: Variables = {}
        for name, entry in self._written():
            variables |= entry.variables(self, name)
        return variables

    def _written(self) -> Iterator[tuple[str, Entry]]:
        """Fields that are not None, and their storage."""
        return ((name, entry) for name, entry in _entries(type(self)) if getattr(self, name) is not None)

    def _require_sizes(self, sizes: Mapping[str, int]) -> None:
        """Give every array its type, after a check against the sizes of the dimensions. Raises InputError."""
        for name, entry in self._written():
            object.__setattr__(self, name, entry.checked(name, getattr(self, name), sizes))


def variable(dims: tuple[str, ...], values: Any, unit: str, long_name: str) -> tuple[Any, ...]:
    """A variable of a dataset."""
    return (dims, values, {"units": unit, "long_name": long_name})


def json_text(value: Any, long_name: str) -> tuple[Any, ...]:
    """A variable that contains plain data as JSON."""
    return ((), json.dumps(plain(value)), {"long_name": long_name})


def require_shape(name: str, array: Any, shape: tuple[int, ...]) -> None:
    """Raise InputError for an array of another shape."""
    if array.shape != shape:
        raise argument_error(name, f"{name} must have shape {shape}, but its shape is {array.shape}.")


def _entries(kind: Any) -> Iterator[tuple[str, Entry]]:
    """Fields of a dataclass that are stored."""
    return ((field.name, field.metadata[_KEY]) for field in fields(kind) if _KEY in field.metadata)


def _excited(array: FloatArray) -> FloatArray:
    """Coefficients (..., 2H+1) without the harmonics above the highest one that is not zero, but at least the first."""
    present = np.flatnonzero(array.any(axis=tuple(range(array.ndim - 1))))
    harmonics = max(1, (int(present.max(initial=0)) + 1) // 2)
    return array[..., : 2 * harmonics + 1]


def _root(group: StoredGroup) -> StoredGroup:
    return StoredGroup(group.group.file, group.most_bytes)
