"""Objects by name: those of this package, those that a program registers, and those of installed packages."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import cache
from importlib.metadata import EntryPoint, entry_points
from typing import Generic, TypeVar

from stickslip.core.errors import InputError

T = TypeVar("T")


@cache
def _offered(group: str) -> Mapping[str, EntryPoint]:
    """The entry points of a group by name, of the packages that were installed at the first request of the program.

    To search all packages takes 30 ms, and the validation of one study needs them about 25 times.
    """
    return {point.name: point for point in entry_points(group=group)}


class Registry(Generic[T]):
    """Makers of one kind of object by name.

    ``what`` names the kind in messages; packages offer more through entry points of the group ``group``.
    """

    def __init__(self, what: str, group: str, own: Mapping[str, Callable[..., T]]) -> None:
        self._what, self._group = what, group
        self._makers: dict[str, Callable[..., T]] = dict(own)

    def register(self, name: str, maker: Callable[..., T]) -> None:
        """Register ``maker(**constants)`` under a name.

        Raises InputError for a name that is no text or that another maker has, and for a maker that cannot be called.
        """
        if not isinstance(name, str) or not name:
            raise InputError(f"the name of a {self._what} must be a text, but it is {name!r}.", arguments=["name"])
        if not callable(maker):
            raise InputError(
                f'the {self._what} "{name}" must be a class or a function that creates it, but it is {maker!r}.',
                arguments=["law"],
            )
        if self._makers.get(name, maker) is not maker:
            raise InputError(f'the {self._what} "{name}" exists already. Register the new one under another name.')
        self._makers[name] = maker

    def names(self) -> tuple[str, ...]:
        """All names: of this package, registered, and of installed packages."""
        return tuple(sorted({*self._makers, *_offered(self._group)}))

    def find(self, name: str) -> Callable[..., T]:
        """The maker of a name. Raises InputError for an unknown name."""
        if name not in self._makers:
            point = _offered(self._group).get(name)
            if point is None:
                raise InputError(f'there is no {self._what} "{name}"; there are: {", ".join(self.names())}.')
            self.register(name, point.load())
        return self._makers[name]
