"""The stored data of one curve: plain arrays and labels, in a small file that is written whole or not at all."""

from __future__ import annotations

import io
import json
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass, field, fields, replace
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from stickslip.contact.pairing.pairing import FacePairs
from stickslip.core.files import source_digest
from stickslip.core.seal import require_seal, seal
from stickslip.core.validation import FloatArray
from stickslip.model.model import ReducedModel
from stickslip.papers.rough_damper.plan import Setting
from stickslip.results.measures import equivalent_damping, state_counts
from stickslip.results.peaks import Peak, half_power_width, peaks
from stickslip.results.response import ForcedResponse
from stickslip.structure.superelement import Superelement

# chosen: fraction of the largest motion, and of the friction limit, below which a difference is round-off.
LEAST_SLIP = 1e-6
SHOWN_PLACES = ("lower edge", "middle", "upper edge")


@dataclass(frozen=True, eq=False)
class Solved:
    """One curve and its state at the highest peak of the tip's amplitude, or what a slow sweep sees of it.

    numbers:
        name -> value, SI: peak_m, peak_hz, stuck_peak_m, stuck_hz, energies per cycle in J and so on.
    peak_list:
        (m, 2) Hz and m of the peaks inside the curve, or on the path of the sweep, highest first.
    frequency_hz, amplitude_m, stable, energy_j, counts:
        (n,), (n,), (n,), (n,), (n, 3): along the curve; whether the motion is stable, friction energy per cycle, pairs
        stuck, stick-slip, separating.
    pair_state, pair_energy_j, pair_position:
        (n_pairs,), (n_pairs,), (n_pairs, 2) at the peak; m along the damper and up the slope.
    pair_face:
        (n_pairs,) 0 left, 1 right.
    signals:
        (3 places, 6, samples) of pairs at mid-length of the left face, lower edge, middle, upper edge: relative
        displacement t1, t2, n in m, force T1, T2, N in N.
    phase_state:
        (3 places, samples) 0 stuck, 1 slipping, 2 open at each sample of those pairs.
    sides:
        (2, 3, samples) m, displacement x, y, z of the damper's middle nodes on its left and right face.
    shares:
        (3,) translation, rotation and deformation in the damper's motion, see ``rigid_fractions``.
    mode_table:
        (10, 5) mode, Hz of the full and of the reduced model, difference in %, MAC.
    warnings:
        sentences of the solver and of the contact law.
    swept:
        "up" and "down" -> what a slow sweep sees where that differs from the curve: the same numbers at the peak that
        it reaches, and the points on its path; None if no point of the curve is stable.
    """

    setting: Setting
    numbers: Mapping[str, float]
    frequency_hz: FloatArray
    amplitude_m: FloatArray
    stable: NDArray[np.bool_]
    energy_j: FloatArray
    counts: NDArray[Any]
    pair_state: NDArray[Any]
    pair_energy_j: FloatArray
    pair_position: FloatArray
    pair_face: NDArray[Any]
    signals: FloatArray
    phase_state: NDArray[Any]
    sides: FloatArray
    shares: FloatArray
    mode_table: FloatArray
    peak_list: FloatArray
    warnings: tuple[str, ...]
    swept: Mapping[str, Solved | None] = field(default_factory=dict)

    def peaks(self) -> list[tuple[float, float]]:
        """(Hz, m) of every peak inside the curve that reaches 2 % of the highest, by frequency."""
        least = 0.02 * float(self.peak_list[:, 1].max(initial=0.0))
        return sorted((float(hertz), float(top)) for hertz, top in self.peak_list if top > least)

    def seen_by(self, reading: str) -> Solved | None:
        """All of it for "curve", or what a slow sweep "up" or "down" sees; None if the sweep has no stable point."""
        return self.swept.get(reading, self)

    def to_bytes(self, key: str) -> bytes:
        """The content of its file, sealed; ``key`` is the hash of the inputs."""
        words: dict[str, Any] = {
            "setting": asdict(self.setting),
            "numbers": {"": dict(self.numbers)},
            "warnings": list(self.warnings),
            "unstable": [name for name, one in self.swept.items() if one is None],
        }
        arrays = {name: getattr(self, name) for name in _arrays()}
        for reading, one in self.swept.items():
            if one is not None:
                words["numbers"][reading] = dict(one.numbers)
                arrays |= {f"{reading}.{name}": getattr(one, name) for name in _arrays()}
        stream = io.BytesIO()
        np.savez_compressed(stream, words=json.dumps(words), **arrays)
        seal(stream, _subject(key))
        return stream.getvalue()

    @classmethod
    def from_bytes(cls, content: bytes, key: str) -> Solved:
        """Read it back. Raises ResultsFileError for a damaged file, or one of other inputs or another version."""
        stream = io.BytesIO(content)
        require_seal(stream, _subject(key))
        with np.load(stream, allow_pickle=False) as data:
            words = json.loads(str(data["words"]))
            parts = {
                reading: (numbers, {name: data[f"{reading}.{name}" if reading else name] for name in _arrays()})
                for reading, numbers in words["numbers"].items()
            }
        setting, warnings = Setting(**words["setting"]), tuple(words["warnings"])
        whole, *readings = (
            (reading, cls(setting, numbers, warnings=warnings, **arrays))
            for reading, (numbers, arrays) in parts.items()
        )
        swept = {**dict(readings), **dict.fromkeys(words["unstable"])}
        return replace(whole[1], swept=swept)


def _subject(key: str) -> str:
    """Subject of the seal of the file of a curve. The hash of its inputs covers the code that solves, not this
    folder."""
    return f"computation {key}, records {_code()}"


@cache
def _code() -> str:
    """Digest of this module, which determines the content of the file."""
    return source_digest([Path(__file__)])


def _arrays() -> tuple[str, ...]:
    return tuple(item.name for item in fields(Solved) if item.name not in ("setting", "numbers", "warnings", "swept"))


def rigid_fractions(points: FloatArray, motion: NDArray[Any]) -> FloatArray:
    """(3,) shares of translation, rotation and deformation in a harmonic motion; they sum to 1.

    ``u_i = t + w x (x_i - c) + e_i`` with ``t``, ``w`` complex by least squares over the points and c their centre;
    then ``sum |u|^2 = sum |t|^2 + sum |w x (x - c)|^2 + sum |e|^2`` and the shares are the parts of this sum.
    ``points`` (n, 3) m; ``motion`` (n, 3) complex amplitudes in m.
    """
    arm = points - points.mean(axis=0)
    translation = motion.mean(axis=0)
    about = motion - translation
    # w x a = -a x w as a matrix on w
    skew = np.zeros((len(arm), 3, 3))
    skew[:, 0, 1], skew[:, 0, 2], skew[:, 1, 2] = arm[:, 2], -arm[:, 1], arm[:, 0]
    skew -= skew.transpose(0, 2, 1)
    matrix = skew.reshape(-1, 3).astype(complex)
    turn, *_ = np.linalg.lstsq(matrix, about.reshape(-1), rcond=None)
    rotated = matrix @ turn
    parts = np.array(
        [
            len(points) * float(np.sum(np.abs(translation) ** 2)),
            float(np.sum(np.abs(rotated) ** 2)),
            float(np.sum(np.abs(about.reshape(-1) - rotated) ** 2)),
        ]
    )
    total = parts.sum()
    return parts / total if total > 0 else parts


def record(
    setting: Setting,
    model: ReducedModel,
    response: ForcedResponse,
    mode_table: Sequence[Any],
    warnings: Sequence[str],
) -> Solved:
    """What is kept of a solved case: the curve at its highest peak, and what slow sweeps see where that differs."""
    tip = next(iter(model.outputs.values()))

    def reading(tops: Sequence[Peak], points: NDArray[np.int64]) -> Solved:
        return _reading(setting, model, response, mode_table, warnings, tops, points)

    everything = np.arange(response.n_points)
    whole = reading(peaks(response.frequency_hz, response.amplitude(tip), response.part), everything)
    swept: dict[str, Solved | None] = {}
    for sweep in response.slow_sweeps(tip):
        points = sweep.points()
        if points.size < response.n_points:
            swept[sweep.direction] = reading(sweep.peaks, points) if sweep.peaks else None
    return replace(whole, swept=swept)


def _reading(
    setting: Setting,
    model: ReducedModel,
    response: ForcedResponse,
    mode_table: Sequence[Any],
    warnings: Sequence[str],
    tops: Sequence[Peak],
    points: NDArray[np.int64],
) -> Solved:
    """The points of a curve and its state at the first of the peaks ``found``."""
    tip = next(iter(model.outputs.values()))
    amplitude, peak = response.amplitude(tip), tops[0]
    stuck = peaks(response.linear.frequency_hz, response.linear_amplitude(tip, "stuck"))[0]
    face_pairs, point = model.joint.face_pairs, peak.point
    energy, counts = response.friction_energy.sum(axis=1), state_counts(response.contact_state)
    width = half_power_width(response.frequency_hz, amplitude, peak, response.part)
    stuck_hz = response.linear.stuck_frequency_hz
    numbers = {
        "peak_m": peak.amplitude,
        "peak_hz": peak.frequency_hz,
        "peak_inside": float(peak.bracketed),
        "stuck_peak_m": stuck.amplitude,
        "stuck_peak_hz": stuck.frequency_hz,
        "first_stuck_hz": float(stuck_hz[0]),
        "second_stuck_hz": float(stuck_hz[1]),
        "half_power_width": float("nan") if width is None else width,
        "equivalent_damping": float(equivalent_damping(response)[point]),
        "friction_energy_j": float(energy[point]),
        "viscous_energy_j": float(response.viscous_energy[point]),
        "input_energy_j": float(response.input_energy[point]),
        "normal_stiffness": float(model.joint.face_sum(model.joint.normal_stiffness)[0]),
        "tangential_stiffness": float(model.joint.face_sum(model.joint.tangential_stiffness)[0]),
        "stuck": float(counts[point][0]),
        "stick_slip": float(counts[point][1]),
        "separating": float(counts[point][2]),
        "unknowns_reduced": float(model.superelement.size),
    }
    signals, phase = _pair_signals(response, point, _places(face_pairs))
    sides = [
        [response.signal(model.outputs[f"damper {side} {axis}"], point, response.samples) for axis in "xyz"]
        for side in ("left", "right")
    ]
    inside = [(each.frequency_hz, each.amplitude) for each in tops if each.bracketed]
    return Solved(
        setting=setting,
        numbers=numbers,
        frequency_hz=response.frequency_hz[points],
        amplitude_m=amplitude[points],
        stable=response.stable_points[points],
        energy_j=energy[points],
        counts=counts[points],
        pair_state=response.contact_state[point],
        pair_energy_j=response.friction_energy[point],
        pair_position=face_pairs.face_position[:, ::-1],
        pair_face=face_pairs.face,
        signals=signals,
        phase_state=phase,
        sides=np.array(sides),
        shares=rigid_fractions(face_pairs.points, _damper_motion(model.superelement, face_pairs, response, point)),
        mode_table=np.array([[r.mode, r.full_hz, r.reduced_hz, r.difference_percent, r.mac] for r in mode_table]),
        peak_list=np.array(inside).reshape(-1, 2),
        warnings=tuple(warnings),
    )


def _damper_motion(
    superelement: Superelement, face_pairs: FacePairs, response: ForcedResponse, point: int
) -> NDArray[np.complex128]:
    """(n_pairs, 3) first harmonic of the damper's contact nodes."""
    rows = np.array([superelement.unknowns_of(int(node)) for node in face_pairs.first_node])
    coefficients = response.displacement[point][rows]
    motion: NDArray[np.complex128] = coefficients[..., 1] - 1j * coefficients[..., 2]
    return motion


def _places(face_pairs: FacePairs) -> list[int]:
    """Pairs of the left face at mid-length: lower edge, middle, upper edge."""
    up, along = face_pairs.face_position.T
    left = np.flatnonzero(face_pairs.face == 0)
    column = left[np.abs(along[left]) <= np.abs(along[left]).min() + 1e-9]
    column = column[np.argsort(up[column])]
    return [int(column[0]), int(column[len(column) // 2]), int(column[-1])]


def _pair_signals(response: ForcedResponse, point: int, pairs: list[int]) -> tuple[FloatArray, NDArray[Any]]:
    cycle = response.pair_cycle(point)
    motion = response.pair_displacement(point, response.samples)[:, pairs]
    force, slider = cycle.force[:, pairs], cycle.slider[:, pairs]
    signals = np.concatenate([motion, force], axis=2).transpose(1, 2, 0)
    return signals, phase_states(motion, force, slider, response.pairs.friction_coefficient[pairs]).T


def phase_states(motion: FloatArray, force: FloatArray, slider: FloatArray, friction: FloatArray) -> NDArray[np.int64]:
    """(samples, n) 0 stuck, 1 slipping, 2 open, from motion and force (samples, n, 3) and slider (samples, n, 2).

    A pair slips where its slider moves and ``|T| = mu N``. The slider of an open pair follows the motion, so at
    touchdown it has moved since the last sample although the pair sticks; the friction force tells the two apart.
    """
    moved = np.abs(slider - np.roll(slider, 1, axis=0)).max(axis=2) > LEAST_SLIP * np.abs(motion[..., :2]).max()
    at_limit = np.linalg.norm(force[..., :2], axis=2) >= (1.0 - LEAST_SLIP) * friction * force[..., 2]
    state: NDArray[np.int64] = np.where(force[..., 2] <= 0.0, 2, np.where(moved & at_limit, 1, 0))
    return state
