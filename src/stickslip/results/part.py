"""Interface of the results of an analysis beside the curve."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Protocol, runtime_checkable

from stickslip.core.validation import FloatArray
from stickslip.results.table import Table


@runtime_checkable
class ResultPart(Protocol):
    """A part of the results of a study under a name, which is that of its field in ``ForcedResponse``.

    It writes its own tables and sentences. Its section of the page is a module of ``reporting``.
    """

    def tables(self, name: str, outputs: Mapping[str, FloatArray]) -> Iterator[Table]:
        """Its tables for ``stickslip export``; ``outputs`` are the rows (n,) of the study by name, in m."""

    def closing_words(self, name: str) -> Iterator[str]:
        """Lines for the end of ``stickslip run``: its message, its main numbers and its warnings."""
