"""The result of a ridge of peaks: the maxima of an output against a parameter, and the highest of them."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field, replace
from os import PathLike
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.signal import find_peaks

from stickslip.core.errors import InputError
from stickslip.core.validation import FloatArray, finite_array, require_positive
from stickslip.results import highest_peak
from stickslip.results.checked_peak import CheckedPeak, doubtful_words, is_doubtful, uncertain_line_words
from stickslip.results.groups import read_groups, write_groups
from stickslip.results.highest_peak import HighestPeak, Optimum, log_interpolated, optimum_at
from stickslip.results.ridge_figure import RidgePicture, ridge_figure
from stickslip.results.ridge_table import POINT_COLUMNS, ridge_table
from stickslip.results.ridge_words import GRID_PER_INTERVAL, STUCK_OPTIMUM, error_words
from stickslip.results.table import Table, column_of
from stickslip.results.variables import Attribute, Flags, Json, Labelled, Numbers, Text, WholeNumbers, stored

if TYPE_CHECKING:
    from matplotlib.figure import Figure

_POINTS, _STUCK, _FREE = ("ridge_point",), ("stuck_point",), ("free_point",)
# chosen: rise of the logarithm on both sides of an optimum; smaller valleys are blurred by sampling.
LEAST_RISE = 0.01


@dataclass(frozen=True, eq=False)
class PeakRidge(Labelled):
    """Maxima of the 0-to-peak amplitude of an output over the frequency, against one parameter.

    A ridge is one local maximum of the frequency curve, followed while the parameter changes. Points are in the order
    of the ridges, and in each of them in that of the parameter. Theory: docs/theory_ridge.md.

    Parameters
    ----------
    parameter_name, parameter_unit, output_name:
        the parameter, such as "preload.centrifugal_force" and "N", and the output.
    start, stop:
        range of the parameter, start below stop.
    parameter, amplitude, frequency_hz:
        (n_points,) value of the parameter, peak amplitude (0-to-peak, mean included; m for a displacement), and
        frequency of the peak in Hz.
    ridge:
        (n_points,) number from 0 of the ridge of a point.
    is_corner:
        (n_points,) whether the frequency curve has a corner at the peak, not a tangent of zero slope.
    curvature:
        (n_points,) second derivative of the logarithm of the amplitude by the phase lag in rad, -1 for a linear
        resonance. (At a corner it has no meaning.)
    pairs_stuck, pairs_stick_slip, pairs_separating:
        (n_points,) numbers of pairs in each contact state at the peak.
    residual:
        (n_points,) relative error of the balance at the last point of the search.
    iterations:
        (n_points,) of Newton's method for the peak.
    stuck_parameter, stuck_amplitude, stuck_frequency_hz:
        (n_stuck,) highest peaks of the linear structure with stuck contacts at values of the parameter; those at an end
        of the frequency range are omitted.
    free_parameter, free_amplitude, free_frequency_hz:
        (n_free,) the same without contacts.
    estimated_error:
        (n_points,) relative error of the amplitude by neglected harmonics; where a point has no estimate of its own,
        the larger one of its neighbours on the ridge. None if nothing was estimated.
    point_harmonics:
        (n_points,) numbers of harmonics. None in files of versions before 1.1.
    slope:
        (n_points,) derivative of the logarithm of the amplitude by that of the parameter.
        None in files of earlier versions.
    checked:
        the highest peaks at some values of the parameter by whole curves with more harmonics.
    unknown:
        (n_unknown, 2) ranges of the parameter, ends excluded, in which the highest ridge is not the highest motion for
        certain: a higher one ended beside them.
    ends:
        for each ridge the reasons why it ends below and above; "" where it reaches the end of the range.
    converged, message:
        whether the highest peak is known over the whole range, and a message.
    warnings:
        messages, for example on a curve at an end of the range that is not complete.
    settings, provenance:
        options of the run; software and machine.

    Raises
    ------
    InputError
        for an array of the wrong shape or with an entry that is not finite.
    """

    DATASET_TITLE: ClassVar[str] = "Ridge of peaks of a structure with rough, dry-friction joints"

    parameter: FloatArray = field(metadata=stored(Numbers(_POINTS, "1", "parameter, in parameter_unit")))
    amplitude: FloatArray = field(metadata=stored(Numbers(_POINTS, "m", "peak amplitude of the output, 0-to-peak")))
    frequency_hz: FloatArray = field(metadata=stored(Numbers(_POINTS, "Hz", "frequency of the peak", name="frequency")))
    ridge: NDArray[np.int64] = field(metadata=stored(WholeNumbers(_POINTS, "1", "number of the ridge")))
    is_corner: NDArray[np.bool_] = field(metadata=stored(Flags(_POINTS, "1", "1 at a corner of the frequency curve")))
    curvature: FloatArray = field(
        metadata=stored(Numbers(_POINTS, "rad-2", "second derivative of log amplitude by the phase lag"))
    )
    pairs_stuck: NDArray[np.int64] = field(metadata=stored(WholeNumbers(_POINTS, "1", "pairs stuck")))
    pairs_stick_slip: NDArray[np.int64] = field(metadata=stored(WholeNumbers(_POINTS, "1", "pairs in stick-slip")))
    pairs_separating: NDArray[np.int64] = field(metadata=stored(WholeNumbers(_POINTS, "1", "pairs separating")))
    residual: FloatArray = field(metadata=stored(Numbers(_POINTS, "1", "relative residual of the balance")))
    iterations: NDArray[np.int64] = field(metadata=stored(WholeNumbers(_POINTS, "1", "Newton iterations")))
    stuck_parameter: FloatArray = field(metadata=stored(Numbers(_STUCK, "1", "parameter of the stuck limit")))
    stuck_amplitude: FloatArray = field(metadata=stored(Numbers(_STUCK, "m", "highest linear peak, contacts stuck")))
    stuck_frequency_hz: FloatArray = field(metadata=stored(Numbers(_STUCK, "Hz", "frequency of that peak")))
    free_parameter: FloatArray = field(metadata=stored(Numbers(_FREE, "1", "parameter of the free limit")))
    free_amplitude: FloatArray = field(metadata=stored(Numbers(_FREE, "m", "highest linear peak, no contact")))
    free_frequency_hz: FloatArray = field(metadata=stored(Numbers(_FREE, "Hz", "frequency of that peak")))
    parameter_name: str = field(metadata=stored(Text("name of the parameter")))
    parameter_unit: str = field(metadata=stored(Text("unit of the parameter")))
    output_name: str = field(metadata=stored(Text("name of the output")))
    start: FloatArray = field(metadata=stored(Numbers((), "1", "lower end of the range")))
    stop: FloatArray = field(metadata=stored(Numbers((), "1", "upper end of the range")))
    ends: tuple[tuple[str, str], ...] = field(
        metadata=stored(Json(list[tuple[str, str]], "reasons for the ends of each ridge, JSON list"))
    )
    converged: bool = field(metadata=stored(Attribute(0, 1, bool)))
    message: str = field(metadata=stored(Text("message at the end")))
    warnings: tuple[str, ...] = field(metadata=stored(Json(list[str], "warnings, JSON list")))
    settings: dict[str, str | float | int] = field(
        metadata=stored(Json(dict[str, str | float | int | None], "settings, JSON object"))
    )
    provenance: dict[str, str] = field(metadata=stored(Json(dict[str, str], "software and machine, JSON object")))

    unknown: FloatArray = field(
        default_factory=lambda: np.zeros((0, 2)),
        metadata=stored(
            Numbers(("unknown_range", "end"), "1", "ranges in which the highest peak is unknown", optional=True)
        ),
    )

    estimated_error: FloatArray | None = field(
        default=None, metadata=stored(Numbers(_POINTS, "1", "estimated error by neglected harmonics", optional=True))
    )
    point_harmonics: NDArray[np.int64] | None = field(
        default=None, metadata=stored(WholeNumbers(_POINTS, "1", "number of harmonics", optional=True))
    )
    slope: FloatArray | None = field(
        default=None,
        metadata=stored(Numbers(_POINTS, "1", "slope of log amplitude by log parameter", optional=True)),
    )
    checked: tuple[CheckedPeak, ...] = field(
        default=(),
        metadata=stored(
            Json(list[tuple[float, float, float, float, int]], "checks with more harmonics, JSON list", optional=True)
        ),
    )

    def __post_init__(self) -> None:
        sizes = {
            "unknown_range": len(self.unknown),
            "end": 2,
            "ridge_point": np.size(self.parameter),
            "stuck_point": np.size(self.stuck_parameter),
            "free_point": np.size(self.free_parameter),
        }
        self._require_sizes(sizes)
        if not sizes["ridge_point"]:
            raise InputError("a ridge requires at least one point.", arguments=["parameter"])
        require_positive("parameter", self.parameter, "A ridge is over its logarithm.")
        object.__setattr__(self, "warnings", tuple(self.warnings))
        object.__setattr__(self, "ends", tuple((below, above) for below, above in self.ends))
        object.__setattr__(self, "checked", tuple(CheckedPeak(*each) for each in self.checked))

    def __repr__(self) -> str:
        return (
            f"PeakRidge({self.parameter_name} from {float(self.start):g} to {float(self.stop):g} "
            f"{self.parameter_unit}: {self.n_points} points on {self.n_ridges} ridge(s), "
            f"{'converged' if self.converged else 'NOT converged'})"
        )

    @property
    def n_points(self) -> int:
        """Number of points of all ridges."""
        return int(self.parameter.size)

    @property
    def n_ridges(self) -> int:
        """Number of ridges."""
        return len(self.ends)

    def over(self, scale: float, name: str, unit: str) -> PeakRidge:
        """The same ridges over the parameter divided by ``scale``, with another name and unit."""
        scaled: dict[str, Any] = {
            key: np.asarray(getattr(self, key)) / scale
            for key in ("parameter", "stuck_parameter", "free_parameter", "start", "stop", "unknown")
        }
        checked = tuple(each._replace(parameter=each.parameter / scale) for each in self.checked)
        return replace(self, **scaled, checked=checked, parameter_name=name, parameter_unit=unit)

    def of(self, ridge: int) -> NDArray[np.int64]:
        """The points of a ridge."""
        return np.flatnonzero(self.ridge == ridge)

    def at(self, parameter: ArrayLike) -> HighestPeak:
        """The highest peak at values of the parameter (n,): between the points, by cubic interpolation of logarithms.

        Raises InputError for a value that is not above zero.
        """
        values = np.atleast_1d(finite_array("parameter", parameter))
        require_positive("parameter", values, "A ridge is over its logarithm.")
        amplitude = np.full(values.size, -np.inf)
        frequency = np.full(values.size, np.nan)
        number = np.full(values.size, -1)
        for ridge in range(self.n_ridges):
            height, hertz = self._interpolated(ridge, values)
            higher = height > amplitude
            amplitude[higher], frequency[higher], number[higher] = height[higher], hertz[higher], ridge
        for low, high in self.unknown:
            number[(values > low * (1.0 + 1e-12)) & (values < high * (1.0 - 1e-12))] = -1
        frequency[number < 0] = np.nan
        return HighestPeak(values, np.where(number >= 0, amplitude, np.nan), frequency, number)

    def _interpolated(self, ridge: int, values: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Amplitude and frequency of a ridge at values; not a number outside of its range."""
        points = self.of(ridge)
        low, high = self.parameter[points[[0, -1]]]
        inside = (values >= low * (1.0 - 1e-12)) & (values <= high * (1.0 + 1e-12))
        places, known = np.log(self.parameter[points]), None if self.slope is None else self.slope[points]
        answer = []
        for curve, slopes in ((self.amplitude[points], known), (self.frequency_hz[points], None)):
            value = np.full(values.size, np.nan)
            value[inside] = np.exp(log_interpolated(places, np.log(curve), np.log(values[inside]), slopes))
            answer.append(value)
        return answer[0], answer[1]

    def error_at(self, parameter: ArrayLike) -> FloatArray:
        """Estimated relative error of :meth:`at` at values of the parameter (n,), NaN where no ridge is known.

        It contains the neglected harmonics, if they were estimated, and the interpolation. Raises InputError for a
        value that is not above zero.
        """
        number = self.at(parameter).ridge
        of_harmonics = np.zeros(self.n_points) if self.estimated_error is None else self.estimated_error
        places = np.log(np.atleast_1d(np.asarray(parameter, dtype=float)))
        error = self._interpolation_error(places, number)
        for ridge in np.unique(number[number >= 0]):
            here, points = number == ridge, self.of(int(ridge))
            error[here] += highest_peak.larger_neighbour(
                np.log(self.parameter[points]), of_harmonics[points], places[here]
            )
        return error

    def _interpolation_error(self, places: FloatArray, number: NDArray[np.int64]) -> FloatArray:
        """Estimated errors of the interpolation at logarithms of the parameter, on ridges by number."""
        error = np.full(places.size, np.nan)
        for ridge in np.unique(number[number >= 0]):
            here, points = number == ridge, self.of(int(ridge))
            curve, known = np.log(self.amplitude[points]), None if self.slope is None else self.slope[points]
            error[here] = highest_peak.interpolation_errors(np.log(self.parameter[points]), curve, places[here], known)
        return error

    @property
    def grid(self) -> FloatArray:
        """(n,) values of the parameter from start to stop, with all points and others between them."""
        places = np.unique(np.log(np.append(self.parameter, [self.start, self.stop])))
        between = np.linspace(places[:-1], places[1:], GRID_PER_INTERVAL, endpoint=False)
        return np.asarray(np.exp(np.append(between.T.ravel(), places[-1])))

    def highest(self) -> HighestPeak:
        """The highest peak on :attr:`grid`."""
        return self.at(self.grid)

    def switches(self) -> tuple[float, ...]:
        """Values of the parameter at which another ridge becomes the highest, rising."""
        top = self.highest()
        known = np.flatnonzero(top.ridge >= 0)
        changes = known[:-1][np.diff(top.ridge[known]) != 0]
        return tuple(self._crossing(top.parameter[i], top.parameter[i + 1]) for i in changes if i + 1 in known)

    def _crossing(self, low: float, high: float) -> float:
        """The value at which the highest ridge changes, between two neighbours of the grid, by bisection."""
        before = self.at(low).ridge[0]
        while high / low > 1.0 + 1e-9:
            middle = float(np.sqrt(low * high))
            if self.at(middle).ridge[0] == before:
                low = middle
            else:
                high = middle
        return float(np.sqrt(low * high))

    @property
    def optimum(self) -> Optimum:
        """The lowest of all highest peaks that were followed, also at an end of them (``edge``)."""
        top = self.highest()
        return optimum_at(top, int(np.nanargmin(top.amplitude)))

    @property
    def other_minima(self) -> tuple[Optimum, ...]:
        """Other local minima of the highest peak, between rises of at least 1 %, lowest first."""
        top, best = self.highest(), self.optimum
        known = np.flatnonzero(top.ridge >= 0)
        valleys, _ = find_peaks(-np.log(top.amplitude[known]), prominence=LEAST_RISE)
        minima = [optimum_at(top, int(place)) for place in known[valleys]]
        return tuple(
            sorted((each for each in minima if each.parameter != best.parameter), key=lambda each: each.amplitude)
        )

    @property
    def has_stuck_optimum(self) -> bool:
        """Whether no pair slips or separates at the optimum, and it is not at an end of the followed range, where a
        heavy damper is stuck."""
        best = self.optimum
        return not self._slips_at(best) and not best.edge.endswith("range")

    @property
    def slipping_minimum(self) -> Optimum | None:
        """The lowest minimum inside at which pairs slip or separate, None without one."""
        minima = (self.optimum, *self.other_minima)
        return next((each for each in minima if each.is_inside and self._slips_at(each)), None)

    def _slips_at(self, at: Optimum) -> bool:
        """Whether pairs slip or separate at the point nearest to an optimum."""
        point = int(np.argmin(np.abs(np.log(self.parameter / at.parameter))))
        return bool(self.pairs_stick_slip[point] + self.pairs_separating[point])

    def tables(self, name: str, outputs: Mapping[str, FloatArray]) -> Iterator[Table]:
        """See :class:`stickslip.results.part.ResultPart`."""
        points = {key: getattr(self, key) for key in POINT_COLUMNS} | {"ridge": self.ridge + 1}
        parameter = column_of(self.parameter_name, self.parameter_unit, self.parameter)
        yield ridge_table(name, parameter, self.output_name, points)

    def closing_words(self, name: str) -> Iterator[str]:
        """See :class:`stickslip.results.part.ResultPart`."""
        title = "Ridge of peaks" if name == "peak_ridge" else name.replace("_", " ").capitalize()
        yield f"{title}: {self.message} {self.n_points} peaks."
        yield from (f"  {sentence}" for sentence in self.words())
        yield from (f"Warning: {sentence}" for sentence in self.warnings)

    def plot(self) -> Figure:
        """Peak amplitude and frequency against the parameter, as a figure of matplotlib, on logarithmic axes.

        The highest peak is a thick line, the other ridges are thin; linear limits beside, the optimum marked.
        """
        return ridge_figure(self.picture())

    def picture(self) -> RidgePicture:
        """The data of figures."""
        top, best = self.highest(), self.optimum
        return RidgePicture(
            top.parameter, top.amplitude, top.frequency_hz, self.parameter, self.amplitude, self.frequency_hz,
            self.ridge, self.stuck_parameter, self.stuck_amplitude, self.stuck_frequency_hz, self.free_parameter,
            self.free_amplitude, self.free_frequency_hz, best.parameter, best.amplitude, best.frequency_hz,
            best.is_inside, self.parameter_name, self.parameter_unit, self.output_name,
            is_doubtful(self.estimated_error, self.n_points), self.checked,
        )  # fmt: skip

    def save(self, path: str | PathLike[str]) -> None:
        """Write one NetCDF-4 file, completely or not at all. Raises ResultsFileError if it cannot be written."""
        write_groups(path, self.to_groups())

    @classmethod
    def load(cls, path: str | PathLike[str]) -> PeakRidge:
        """Read a file of :meth:`save`; the object is equal. Raises ResultsFileError."""
        return read_groups(path, cls.from_group)

    def words(self) -> Iterator[str]:
        """Sentences on the optimum, other minima and switches."""
        best = self.optimum
        if best.is_inside:
            yield f"The optimum is {self._place(best)}."
        else:
            yield f"The lowest peak is at {best.edge}, so a lower one may be beyond: {self._place(best)}."
        if self.has_stuck_optimum:
            yield STUCK_OPTIMUM
        for other in self.other_minima:
            yield f"Another local minimum is {self._place(other)}."
        yield from self.words_on_trust(self._named)
        for value in self.switches():
            yield f"At {self._named(value)} another peak becomes the highest."

    def words_on_trust(self, named: Callable[[float], str]) -> Iterator[str]:
        """Sentences on checks and estimated errors; ``named`` is a value of the parameter in words."""
        for check in self.checked:
            yield check.words(named(check.parameter), float(self.at(check.parameter).amplitude[0]))
        yield from doubtful_words(self.parameter, self.estimated_error, named)
        top = self.highest()
        error = self._interpolation_error(np.log(top.parameter), top.ridge)
        yield from uncertain_line_words(top.parameter, error, named)

    def _place(self, at: Optimum) -> str:
        where = f"{1e6 * at.amplitude:.4g} µm at {at.frequency_hz:.2f} Hz, with {self._named(at.parameter)}"
        return where + self.words_on_error(at)

    def words_on_error(self, at: Optimum) -> str:
        """The estimated error of a minimum, to follow its amplitude; "" where nothing was estimated."""
        return "" if self.estimated_error is None else error_words(self.grid, self.error_at, at.parameter)

    def _named(self, value: float) -> str:
        return f"{self.parameter_name} = {value:.4g} {self.parameter_unit}".rstrip()
