"""Distributions of the inputs of a band: texts become numbers, checked against what their key allows.

All inputs are independent. A normal and a lognormal distribution is cut at ``CUT`` standard deviations, so that its
samples have bounds that can be checked before anything is solved. The forms are in
:mod:`stickslip.case.scatter_text`.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np
import scipy.stats

from stickslip.case.case import Case
from stickslip.case.key_kinds import kind_of_key
from stickslip.case.scatter_text import FORMS, Form, ScatterText, scatter_text
from stickslip.core.errors import InputError
from stickslip.core.units import Count, Quantity, number_and_unit, number_or_text
from stickslip.core.validation import FloatArray
from stickslip.results.influence import Coordinate
from stickslip.results.sweep_table import SweptKey, Value
from stickslip.sweeps.axes import KeyKind, key_with_values, shown_value, single_value

CUT = 3.0  # chosen: standard deviations; the cut probability is 0.27 %
DIGITS = 10  # of a sampled value, so that round-off of other machines and versions gives the same cases
# A cut end may touch a limit of its key: 0.3 - 3 * 0.1 is -5.6e-17. Samples stay this fraction of the width inside.
INSIDE = 1e-8
_NODES = 64  # of a Gauss rule for moments; exact for polynomials of degree 127
Scatter = Mapping[str, str]


@dataclass(frozen=True)
class Distribution:
    """A distributed input.

    name:
        key of the study file.
    text:
        as the user gave it.
    kind:
        of the values of the key.
    form:
        of the distribution.
    first, second:
        SI: mean and standard deviation (normal); logarithm of the median and of the geometric standard deviation
        (lognormal); both ends (uniform), or their logarithms (loguniform).
    listed:
        the values of a list.
    """

    name: str
    text: str
    kind: KeyKind
    form: Form
    first: float = math.nan
    second: float = math.nan
    listed: tuple[Value, ...] = ()

    def key(self, points: FloatArray) -> SweptKey:
        """The key with one value for each of the points (n,) between 0 and 1, by the inverse distribution function."""
        return key_with_values(self.name, self.kind, self._values(points))

    def _values(self, points: FloatArray) -> list[Value]:
        if self.listed:
            return [self.listed[place] for place in self._places(points)]
        low, high = self.support
        margin = INSIDE * (high - low)
        values = np.clip(self._of_coordinate(self._coordinates(points)), low + margin, high - margin)
        return [float(f"{value:.{DIGITS}g}") for value in values]

    def coordinate(self, points: FloatArray) -> Coordinate:
        """The coordinate in which polynomials of this input are formed: the value or its logarithm, standardised."""
        if self.listed:
            count = len(self.listed)
            return Coordinate(
                self.name, self._places(points).astype(float), np.arange(float(count)), np.full(count, 1.0 / count)
            )
        nodes, weights = np.polynomial.legendre.leggauss(_NODES)
        if self.form in ("normal", "lognormal"):
            nodes = CUT * nodes
            weights = weights * np.exp(-0.5 * nodes**2)
        return Coordinate(self.name, self._coordinates(points), nodes, weights / weights.sum())

    @property
    def support(self) -> tuple[float, float]:
        """Smallest and largest value of a continuous distribution, SI."""
        low, high = self._of_coordinate(np.array([-1.0, 1.0]) * (CUT if self._has_tails else 1.0))
        return float(low), float(high)

    @property
    def _has_tails(self) -> bool:
        return self.form in ("normal", "lognormal")

    def _coordinates(self, points: FloatArray) -> FloatArray:
        if self._has_tails:
            values: FloatArray = scipy.stats.truncnorm.ppf(points, -CUT, CUT)
            return values
        return 2.0 * points - 1.0

    def _places(self, points: FloatArray) -> FloatArray:
        places: FloatArray = np.minimum(np.floor(points * len(self.listed)).astype(int), len(self.listed) - 1)
        return places

    def _of_coordinate(self, coordinate: FloatArray) -> FloatArray:
        match self.form:
            case "normal" | "lognormal":
                values = self.first + self.second * coordinate
            case _:
                values = 0.5 * (self.first + self.second) + 0.5 * (self.second - self.first) * coordinate
        result: FloatArray = np.exp(values) if self.form in ("lognormal", "loguniform") else values
        return result


def distributions(scatter: Scatter, case: Case) -> tuple[Distribution, ...]:
    """The distributions of texts by key; each value that can be drawn is allowed by its key.

    Raises InputError for an unknown key, a text that is no distribution, or values that the key does not allow.
    """
    if not scatter:
        raise InputError(
            "no input is distributed. Give at least one, in the study file or by its key: "
            'friction.coefficient="0.3 +- 0.1".'
        )
    return tuple(_distribution(name, text, case) for name, text in scatter.items())


def _distribution(name: str, text: str, case: Case) -> Distribution:
    kind = kind_of_key(name, case)
    try:
        scatter = scatter_text(text) if isinstance(text, str) else None
    except InputError as error:
        raise InputError(f'{name} = "{text}" {error}', arguments=[name]) from error
    if scatter is None:
        raise InputError(f'{name} = "{text}" is not a distribution. {FORMS}', arguments=[name])
    if scatter.form == "listed":
        return _listed(name, text, kind, scatter)
    if not isinstance(kind, Quantity):
        what, example = "whole numbers", "1 | 2 | 3"
        if not isinstance(kind, Count):
            what, example = f"words: {', '.join(kind)}", " | ".join(kind[:2])
        raise InputError(
            f'{name} = "{text}" is a continuous distribution, but its values are {what}. List them: "{example}".',
            arguments=[name],
        )
    try:
        result = _continuous(name, text, kind, scatter)
    except InputError as error:
        raise InputError(f'{name} = "{text}" {error}', arguments=[name]) from error
    _require_allowed_ends(result, kind)
    return result


def _listed(name: str, text: str, kind: KeyKind, scatter: ScatterText) -> Distribution:
    values = tuple(single_value(name, kind, number_or_text(part)) for part in scatter.parts)
    if len(values) < 2 or len(set(values)) < len(values):
        raise InputError(
            f'{name} = "{text}" must list at least two different values; each has the same probability.',
            arguments=[name],
        )
    return Distribution(name, text, kind, "listed", listed=values)


def _continuous(name: str, text: str, kind: Quantity, scatter: ScatterText) -> Distribution:
    """Raises InputError without the name of the key."""
    unlimited = replace(kind, above=None, below=None, at_least=None, at_most=None)
    first = unlimited.parse(number_or_text(scatter.parts[0]))
    if scatter.form == "lognormal":
        factor = number_and_unit(scatter.parts[1])[0]
        if not first > 0.0 or not factor > 1.0:
            raise InputError("must have a median above 0 and a factor above 1.")
        return Distribution(name, text, kind, "lognormal", math.log(first), math.log(factor))
    fraction, unit = number_and_unit(scatter.parts[1])
    is_relative = unit == "%" and number_and_unit(scatter.parts[0])[1] != "%"
    if scatter.form == "normal":
        deviation = 0.01 * fraction * abs(first) if is_relative else unlimited.parse(number_or_text(scatter.parts[1]))
        if not deviation > 0.0:
            raise InputError("must have a standard deviation above 0.")
        return Distribution(name, text, kind, "normal", first, deviation)
    second = unlimited.parse(number_or_text(scatter.parts[1]))
    if not second > first:
        raise InputError("must begin with its smaller end.")
    if scatter.form == "uniform":
        return Distribution(name, text, kind, "uniform", first, second)
    if not first > 0.0:
        raise InputError('must start above 0, because it is uniform in the logarithm. Drop "log".')
    return Distribution(name, text, kind, "loguniform", math.log(first), math.log(second))


def _require_allowed_ends(distribution: Distribution, kind: Quantity) -> None:
    low, high = distribution.support
    margin = INSIDE * (high - low)
    for end, sample in ((low, low + margin), (high, high - margin)):
        try:
            kind.parse(f"{sample!r} {kind.si_unit}" if kind.si_unit else sample)
        except InputError as error:
            raise InputError(_beyond(distribution, kind, end, error), arguments=[distribution.name]) from error


def _beyond(distribution: Distribution, kind: Quantity, end: float, error: InputError) -> str:
    cut = f", cut at {CUT:g} standard deviations" if distribution.form in ("normal", "lognormal") else ""
    remedy = "Give a smaller spread"
    if distribution.form == "normal" and distribution.first > 0.0 >= end:
        remedy += f', or for example "lognormal {_shown(kind, distribution.first)} */ 1.3", which stays above 0'
    return (
        f'{distribution.name} = "{distribution.text}" reaches from {_range(distribution, kind)}{cut}, and '
        f"{_shown(kind, end)} {error} "
        f"{remedy}."
    )


def _shown(kind: Quantity, value: float) -> str:
    number, unit = shown_value(kind, value)
    return f"{number:.4g} {unit}".rstrip()


def described(distribution: Distribution) -> tuple[str, str, str, str]:
    """Key, text, form in words and range of a distribution, for a page."""
    if distribution.listed or not isinstance(distribution.kind, Quantity):
        return distribution.name, distribution.text, "listed values, equally probable", ""
    words = {
        "normal": f"normal: mean and standard deviation, cut at {CUT:g} standard deviations",
        "lognormal": f"lognormal: median and factor of one standard deviation, cut at {CUT:g} of them",
        "uniform": "uniform",
        "loguniform": "uniform in the logarithm",
    }
    return distribution.name, distribution.text, words[distribution.form], _range(distribution, distribution.kind)


def _range(distribution: Distribution, kind: Quantity) -> str:
    low, high = distribution.support
    if abs(low) < INSIDE * (high - low):  # round-off, such as that of 0.3 - 3 * 0.1
        low = 0.0
    return f"{_shown(kind, low)} to {_shown(kind, high)}"
