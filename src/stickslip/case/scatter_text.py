"""Texts of distributed inputs: their forms, as a study file or a command gives them.

============================  ==================================================================================
``"0.3 +- 0.1"``              normal: mean and standard deviation, cut at 3 standard deviations on both sides;
                              ``"500 N +- 10 %"``: the deviation as a fraction of the mean
``"lognormal 0.3 */ 1.5"``    lognormal: median and geometric standard deviation, cut at 3 of them on both sides
``"0.2 .. 0.4"``              uniform between two values; ``"1e-10 m .. 1e-8 m log"``: uniform in the logarithm
``"0.2 | 0.3 | 0.35"``        listed values with equal probability; also words of a choice
============================  ==================================================================================

A number without unit has the unit of the other one in the text. The meaning of the numbers depends on the key
(:mod:`stickslip.sweeps.distributions`).
"""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any, Literal

from stickslip.core.errors import InputError
from stickslip.core.units import in_unit, number_and_unit, number_or_text

Form = Literal["normal", "lognormal", "uniform", "loguniform", "listed"]
LONGEST_PATH = 4  # of a key: section.NAME.table.key; what lies deeper in a file is an error that others report
FORMS = (
    'Forms are "0.3 +- 0.1" (mean, standard deviation), "lognormal 0.3 */ 1.5" (median, factor), "0.2 .. 0.4", '
    '"0.2 .. 0.4 log" and "0.2 | 0.3 | 0.35".'
)
_LOGNORMAL = re.compile(r"lognormal\b\s*(.*)", re.DOTALL)
_LOGARITHMIC = re.compile(r"(.*\S)\s+log", re.DOTALL)


@dataclass(frozen=True)
class ScatterText:
    """A distributed input as text.

    form:
        of the distribution.
    parts:
        its numbers with units, or its words: mean and deviation; median and factor; both ends; the listed values.
    """

    form: Form
    parts: tuple[str, ...]

    @property
    def centre(self) -> str:
        """The central value as a study file gives it: mean, median, middle (of the logarithms), first of a list."""
        if self.form not in ("uniform", "loguniform"):
            return self.parts[0]
        (first, unit), (second, other) = (number_and_unit(part) for part in self.parts)
        second = in_unit(second, other, unit)
        # ends without a logarithm are rejected with the distribution
        is_linear = self.form == "uniform" or first * second <= 0.0
        middle = 0.5 * (first + second) if is_linear else (first * second) ** 0.5
        return f"{middle:.12g} {unit}".rstrip()


def central_sentences(scattered: Mapping[str, str]) -> tuple[str, ...]:
    """A sentence on the central value of each distributed input, key -> text."""
    centres = {key: scatter for key, text in scattered.items() if (scatter := scatter_text(text)) is not None}
    return tuple(
        f'{key} is "{scattered[key]}"; its central value {scatter.centre} is used. "stickslip band" uses the '
        "distribution."
        for key, scatter in centres.items()
    )


def scatter_text(text: str) -> ScatterText | None:
    """A distributed input; None for a text without the signs of one. Raises InputError for an incomplete one."""
    logarithmic = _LOGARITHMIC.fullmatch(text.strip())
    lognormal = _LOGNORMAL.fullmatch(text.strip())
    if "|" in text:
        parts = tuple(part.strip() for part in text.split("|"))
        if not all(parts):
            raise InputError(f"has an empty value between its signs |. {FORMS}")
        return ScatterText("listed", parts)
    if lognormal:
        return _pair("lognormal", lognormal[1], "*/")
    for sign in ("+-", "±"):
        if sign in text:
            return _pair("normal", text, sign)
    if ".." in text:
        inner = logarithmic[1] if logarithmic else text
        return _pair("loguniform" if logarithmic else "uniform", inner, "..")
    return None


def _pair(form: Form, text: str, sign: str) -> ScatterText:
    """Two numbers with the sign between them; one without unit has that of the other one."""
    first, _, second = (part.strip() for part in text.partition(sign))
    try:
        units = [number_and_unit(part)[1] for part in (first, second)]
    except InputError as error:
        raise InputError(f"is not a number, {sign} and another number. {FORMS}") from error
    if form == "normal" and units[1] == "%":
        return ScatterText(form, (first, second))  # a fraction of the mean
    if form == "lognormal":
        if units[1]:
            raise InputError(f'has a factor with the unit "{units[1]}". The second number is a pure factor. {FORMS}')
        return ScatterText(form, (first, second))
    first, second = (
        part if unit or not other else f"{part} {other}"
        for part, unit, other in ((first, units[0], units[1]), (second, units[1], units[0]))
    )
    return ScatterText(form, (first, second))


def split_scatter(
    data: Mapping[str, Any], may_scatter: Callable[[tuple[str, ...]], bool], above: tuple[str, ...] = ()
) -> tuple[dict[str, Any], dict[str, str]]:
    """Sections of a study file with central values, and key -> text of each distributed input in them.

    ``may_scatter(path)`` tells whether the key with this path, (section, ..., key), may be distributed.

    Raises InputError about the key of an incomplete text.
    """
    central: dict[str, Any] = {}
    scattered: dict[str, str] = {}
    for key, value in data.items():
        path = (*above, key)
        if isinstance(value, Mapping) and len(path) < LONGEST_PATH:
            central[key], inner = split_scatter(value, may_scatter, path)
            scattered |= inner
            continue
        central[key] = value
        if isinstance(value, str) and may_scatter(path):
            name = ".".join(path)
            try:
                scatter = scatter_text(value)
                if scatter is not None:
                    central[key], scattered[name] = number_or_text(scatter.centre), value
            except InputError as error:
                raise InputError(f'{name} = "{value}" {error}', (name,)) from error
    return central, scattered
