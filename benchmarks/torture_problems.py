"""The problems of the torture set: ``make(kind, seed)`` is one of them, the same on each call.

A problem is a random structure (torture_structures.py) with random but sensible constants of its joint, damping,
excitation and frequency range. A class sets the ranges of the draws; nobody tunes a single problem. The class "narrow"
differs: two to five resonances of a few hertz or less in one range, given by their modes.

How the load is chosen: at the stuck resonance of the mode that the excitation moves most, the linear traction of the
pair nearest to slip is ``load`` times its friction limit. A light structure would need a preload beyond all sense by
this rule, so the rule uses a damping ratio of at least 1e-3.
"""

from __future__ import annotations

import warnings
from dataclasses import dataclass
from functools import cached_property
from typing import Any, Literal

import numpy as np
import scipy.linalg
from torture_structures import STRUCTURES, FloatArray, Random, Structure, log_uniform, static_stiffness

import stickslip as ss

Range = tuple[float, float]
ResidualTraction = Literal["released", "kept"]

LEAST_DAMPING_OF_LOAD = 1e-3
# Only low modes choose the frequency range, and it spans at most this ratio (except in the class "wide").
LOW_MODES, WIDEST_RANGE = 6, 2.5
# A mode below this fraction of the stuck resonance is a rigid motion of a body that only the joint supports.
RIGID = 1e-3


@dataclass(frozen=True)
class ProblemClass:
    """Ranges from which the problems of a class are drawn."""

    structures: tuple[str, ...]
    joint_stiffness: Range = (1e-2, 1e2)  # sum over the pairs, over that of the structure at its output
    damping_ratio: Range = (5e-4, 1e-2)
    load: Range = (2.0, 100.0)  # largest linear traction at the stuck resonance over the friction limit
    force_harmonics: tuple[int, int] = (1, 1)
    is_light: bool = False  # then the damping is by modes only
    is_anisotropic: bool = False
    has_gaps: bool = False
    is_wide: bool = False
    friction: Range = (0.05, 1.0)
    stiffness_scatter: float = 1.0  # each pair is up to this factor stiffer or softer than the mean


CLASSES: dict[str, ProblemClass] = {
    "sdof": ProblemClass(("mass",)),
    "chain": ProblemClass(("chain",)),
    "beam": ProblemClass(("beam",)),
    "plate": ProblemClass(("plate",)),
    "twins": ProblemClass(("twins",)),
    "damper": ProblemClass(("damper",)),
    "light": ProblemClass(("mass", "chain", "beam"), damping_ratio=(1e-5, 3e-4), load=(0.7, 30.0), is_light=True),
    "stiff": ProblemClass(("mass", "chain", "beam", "twins"), joint_stiffness=(1e3, 1e4)),
    "aniso": ProblemClass(("chain", "beam", "plate"), is_anisotropic=True),
    "gaps": ProblemClass(("mass", "chain", "beam", "plate"), load=(3.0, 200.0), has_gaps=True),
    "multi": ProblemClass(("mass", "chain", "beam"), force_harmonics=(2, 3)),
    "close": ProblemClass(("chain pair",)),
    "wide": ProblemClass(("chain", "beam", "plate"), is_wide=True),
    "high": ProblemClass(("mass", "chain", "beam", "damper"), load=(100.0, 2000.0)),
    "low": ProblemClass(("chain", "beam", "plate", "twins"), load=(0.8, 3.0)),
}
# The classes of the torture set, and others on which nobody worked: a set that is known is soon tuned for.
SET_KINDS = (*CLASSES, "narrow")
OTHER_CLASSES: dict[str, ProblemClass] = {
    "row": ProblemClass(("damper row",)),
    "shaken": ProblemClass(("shaken damper",)),
    "mixed": ProblemClass(
        ("mass", "chain", "beam", "plate", "twins"),
        friction=(0.01, 1.2),
        stiffness_scatter=100.0,
    ),
    "orders": ProblemClass(("chain", "plate", "twins", "damper"), force_harmonics=(3, 3)),
}
KINDS = (*SET_KINDS, *OTHER_CLASSES)  # the position of a class seeds its problems
SEEDS = {kind: range(60 if kind == "narrow" else 14) for kind in KINDS}


@dataclass(frozen=True)
class Resonance:
    """A natural frequency of a linear limit, and its half-power width."""

    frequency_hz: float
    width_hz: float


@dataclass(frozen=True)
class Problem:
    """All arguments of one forced response."""

    kind: str
    seed: int
    structure: Structure
    damping: FloatArray | None  # (n, n) N s/m
    modal_damping_ratio: float | None  # of the stuck modes, in place of a matrix
    normal_stiffness: FloatArray  # (n_pairs,) N/m
    tangential_stiffness: FloatArray  # (n_pairs, 2) N/m
    friction_coefficient: FloatArray  # (n_pairs,)
    preload: FloatArray  # (n_pairs,) N, below zero a gap
    force_cos: FloatArray  # (n, harmonics) N
    force_sin: FloatArray
    window_hz: tuple[float, float]  # start, stop

    def superelement(self) -> ss.Superelement:
        """The structure without its joint."""
        return ss.Superelement(self.structure.mass, self.structure.stiffness, self.damping)

    def pairs(self, residual_traction: ResidualTraction = "released") -> ss.ContactPairs:
        """The joint; ``kept`` begins from a rest without tractions and retains them."""
        tractions = np.zeros((self.preload.size, 2)) if residual_traction == "kept" else None
        return ss.ContactPairs(
            self.structure.operator,
            self.normal_stiffness,
            self.tangential_stiffness,
            self.friction_coefficient,
            self.preload,
            tractions,
        )

    def excitation(self) -> ss.Excitation:
        """The force."""
        return ss.Excitation.force(self.force_cos, self.force_sin)

    def solve(
        self,
        residual_traction: ResidualTraction = "released",
        window_hz: tuple[float, float] | None = None,
        harmonics: int = 3,
        **options: Any,
    ) -> ss.ForcedResponse:
        """The response, by default over the range of the problem, with 128 samples and one thread."""
        with warnings.catch_warnings():  # the tables have a column for curves that end early
            warnings.simplefilter("ignore", ss.NotConvergedWarning)
            return ss.forced_response(
                self.superelement(),
                self.pairs(residual_traction),
                self.excitation(),
                frequency_hz=window_hz or self.window_hz,
                modal_damping_ratio=self.modal_damping_ratio,
                harmonics=harmonics,
                outputs=self.structure.output,
                **{"samples": 128, "threads": 1} | options,
            )

    @cached_property
    def resonances(self) -> list[Resonance]:
        """Stuck and free natural frequencies inside the range, in order, with widths ``phi^T C phi / (2 pi)`` Hz."""
        mass, stiffness = self.structure.mass, self.structure.stiffness
        springs = np.column_stack([self.tangential_stiffness, self.normal_stiffness])
        springs = np.where(self.preload[:, None] >= 0.0, springs, 0.0)
        stuck = modes_of(mass, with_springs(self.structure, springs))
        damping = self.damping
        if damping is None:
            assert self.modal_damping_ratio is not None
            damping = modal_damping_matrix(mass, *stuck, self.modal_damping_ratio)
        low, high = sorted(self.window_hz)
        answer = []
        for omega, modes in (stuck, modes_of(mass, stiffness)):
            width = np.einsum("ij,ik,kj->j", modes, damping, modes) / (2.0 * np.pi)
            hertz = omega / (2.0 * np.pi)
            answer += [Resonance(float(f), float(w)) for f, w in zip(hertz, width, strict=True) if low < f < high]
        return sorted(answer, key=lambda each: each.frequency_hz)


def with_springs(structure: Structure, springs: FloatArray) -> FloatArray:
    """(n, n) N/m: the structure with springs (n_pairs, 3) in its pairs."""
    operator = structure.operator
    return np.asarray(structure.stiffness + operator.T @ (springs.ravel()[:, None] * operator))


def modes_of(mass: FloatArray, stiffness: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Circular frequencies (n,) rad/s and mass-normalised modes (n, n)."""
    squares, modes = scipy.linalg.eigh(stiffness, mass)
    return np.sqrt(np.maximum(squares, 0.0)), modes


def modal_damping_matrix(mass: FloatArray, omega: FloatArray, modes: FloatArray, ratio: float) -> FloatArray:
    """(n, n) N s/m with the same damping ratio of all modes; a rigid motion has that of the lowest elastic mode."""
    elastic = omega > 1e-6 * omega.max()
    forces = mass @ modes
    matrix = (forces * (2.0 * ratio * np.where(elastic, omega, omega[elastic].min()))) @ forces.T
    return np.asarray(0.5 * (matrix + matrix.T))


def strongest(structure: Structure, omega: FloatArray, modes: FloatArray, lowest: float) -> int:
    """Of the low modes above ``lowest`` rad/s, the one with which the force moves the output most."""
    candidates = np.flatnonzero(omega > lowest)[:LOW_MODES]
    moves = np.abs((structure.force @ modes) * (structure.output @ modes))[candidates]
    return int(candidates[(moves / omega[candidates]).argmax()])


def make(kind: str, seed: int) -> Problem:
    """The problem of a class with a seed."""
    random = np.random.default_rng([KINDS.index(kind), seed])
    return _narrow(seed, random) if kind == "narrow" else _of_class(kind, seed, random)


def _of_class(kind: str, seed: int, random: Random) -> Problem:
    ranges = (CLASSES | OTHER_CLASSES)[kind]
    structure = STRUCTURES[str(random.choice(ranges.structures))](random)
    n_pairs = len(structure.operator) // 3
    tangential, normal = _contact_springs(random, ranges, structure.stiffness_at_output, n_pairs)
    friction = _friction(random, ranges, n_pairs)
    is_open = _open_pairs(random, n_pairs) if ranges.has_gaps else np.zeros(n_pairs, dtype=bool)
    springs = np.column_stack([tangential, normal])
    omega, modes = modes_of(structure.mass, with_springs(structure, np.where(is_open[:, None], 0.0, springs)))
    first = strongest(structure, omega, modes, 1e-6 * omega.max())
    free = modes_of(structure.mass, structure.stiffness)
    ratio = log_uniform(random, *ranges.damping_ratio)
    damping, modal_ratio = _damping(random, ranges, structure, ratio, omega[first], free)
    newton = log_uniform(random, 0.5, 50.0)
    # Relative displacement of the pairs at the stuck resonance, m.
    damped = 2.0 * max(ratio, LEAST_DAMPING_OF_LOAD) * omega[first] ** 2
    amplitude = newton * (modes[:, first] @ structure.force) / damped
    motion = (structure.operator @ modes[:, first] * amplitude).reshape(-1, 3)
    scatter = np.exp(random.normal(0.0, 0.4, n_pairs))
    traction = np.linalg.norm(tangential * motion[:, :2], axis=1)
    preload = scatter * float((traction / (friction * scatter)).max()) / log_uniform(random, *ranges.load)
    gap = np.abs(motion[:, 2]).max() * np.exp(random.uniform(np.log(0.01), np.log(0.7), n_pairs))
    cosine, sine = _forces(random, ranges, newton * structure.force)
    return Problem(
        kind,
        seed,
        structure,
        damping,
        modal_ratio,
        normal,
        tangential,
        friction,
        np.where(is_open, -normal * gap, preload),
        cosine,
        sine,
        _window(random, ranges, structure, (omega, first), free),
    )


def _contact_springs(
    random: Random, ranges: ProblemClass, reference: float, n_pairs: int
) -> tuple[FloatArray, FloatArray]:
    """Tangential (n_pairs, 2) and normal (n_pairs,) stiffness in N/m; in half of the problems equal in all pairs."""
    along = np.full(n_pairs, log_uniform(random, *ranges.joint_stiffness) * reference / n_pairs)
    if random.random() < 0.5:
        along *= np.exp(random.normal(0.0, 0.3, n_pairs))
    if ranges.stiffness_scatter > 1.0:
        along *= ranges.stiffness_scatter ** random.uniform(-1.0, 1.0, n_pairs)
    if ranges.is_anisotropic:
        across, normal = log_uniform(random, 0.2, 5.0) * along, along * random.uniform(0.2, 5.0, n_pairs)
    else:
        across, normal = along, along * random.uniform(0.2, 5.0)
    return np.column_stack([along, across]), normal


def _friction(random: Random, ranges: ProblemClass, n_pairs: int) -> FloatArray:
    """(n_pairs,) friction coefficients; they differ in about a third of the problems, and in all anisotropic ones."""
    if ranges.is_anisotropic:
        return np.asarray(random.uniform(*ranges.friction, n_pairs))
    mean, differ = random.uniform(*ranges.friction), random.random() < 0.3
    scatter = np.exp(random.normal(0.0, 0.3, n_pairs)) if differ else np.ones(n_pairs)
    return np.asarray(np.clip(mean * scatter, *ranges.friction))


def _open_pairs(random: Random, n_pairs: int) -> FloatArray:
    """(n_pairs,) whether a pair is open at rest; at least one is."""
    is_open = random.random(n_pairs) < random.uniform(0.1, 0.7)
    is_open[random.integers(n_pairs)] = True
    return np.asarray(is_open)


def _damping(
    random: Random,
    ranges: ProblemClass,
    structure: Structure,
    ratio: float,
    stuck_omega: float,
    free: tuple[FloatArray, FloatArray],
) -> tuple[FloatArray | None, float | None]:
    """A damping matrix, or a ratio of the stuck modes."""
    kinds = ("stuck modes", "free modes") if ranges.is_light else ("stuck modes", "free modes", "Rayleigh")
    match random.choice(kinds):
        case "stuck modes":
            return None, ratio
        case "free modes":
            return modal_damping_matrix(structure.mass, *free, ratio), None
        case _:  # the ratio at the stuck resonance, half of it from the mass
            return ratio * (stuck_omega * structure.mass + structure.stiffness / stuck_omega), None


def _forces(random: Random, ranges: ProblemClass, force: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Cosine and sine parts (n, harmonics) in N; in a third of the problems the first harmonic has a phase."""
    harmonics = int(random.integers(ranges.force_harmonics[0], ranges.force_harmonics[1] + 1))
    cosine, sine = random.uniform(-0.5, 0.5, (2, harmonics))
    cosine[0] = 1.0
    sine[0] = random.uniform(-1.0, 1.0) if random.random() < 0.3 else 0.0
    return np.outer(force, cosine), np.outer(force, sine)


def _window(
    random: Random,
    ranges: ProblemClass,
    structure: Structure,
    stuck: tuple[FloatArray, int],
    free: tuple[FloatArray, FloatArray],
) -> tuple[float, float]:
    """Start and stop in Hz: around the strongest stuck and free mode, or all low modes; a third sweeps downward."""
    omega, first = stuck
    lowest = RIGID * omega[first]
    if ranges.is_wide:
        last = min(int(random.integers(3, 8)), omega.size - 1)
        window = [0.5 * free[0][free[0] > lowest].min(), 1.05 * omega[last]]
    else:
        ends = sorted([omega[first], free[0][strongest(structure, *free, lowest)]])
        if ends[1] > WIDEST_RANGE * ends[0]:  # at one of both, which are too far from each other for one range
            ends = [ends[0], WIDEST_RANGE * ends[0]] if random.random() < 0.5 else [ends[1] / WIDEST_RANGE, ends[1]]
        window = [ends[0] * random.uniform(0.7, 0.97), ends[1] * random.uniform(1.03, 1.3)]
    if random.random() < 0.35:
        window.reverse()
    return float(window[0] / (2.0 * np.pi)), float(window[1] / (2.0 * np.pi))


def _narrow(seed: int, random: Random) -> Problem:
    """Two to five lightly damped modes in one range, 1 to 3 pairs with the same constants.

    The unknowns are the amplitudes of mass-normalised modes; six stiff modes above the range make the pairs flexible
    independently of each other.
    """
    in_range = int(random.integers(2, 6))
    hertz = log_uniform(random, 50.0, 300.0) * np.exp(np.cumsum(random.uniform(0.08, 0.5, in_range)))
    hertz = np.concatenate([hertz, hertz[-1] * np.exp(random.uniform(1.5, 3.0, 6))])
    n_pairs, size = int(random.integers(1, 4)), hertz.size
    is_low = np.arange(size) < in_range
    mode_shapes = random.normal(size=(3 * n_pairs, size)) * np.where(is_low, 1.0, 3.0)
    force = random.normal(size=size) * np.where(is_low, 1.0, 0.3)
    output = random.normal(size=size) * np.where(is_low, 1.0, 0.1)
    stiffness = np.diag((2.0 * np.pi * hertz) ** 2)
    at_pair = static_stiffness(stiffness, mode_shapes[0])
    spring = log_uniform(random, 3e-3, 3.0) * at_pair
    structure = Structure(np.eye(size), stiffness, mode_shapes, force, output, at_pair)
    tangential, normal = np.full((n_pairs, 2), spring), np.full(n_pairs, spring)
    omega, modes = modes_of(structure.mass, with_springs(structure, np.full((n_pairs, 3), spring)))
    amplitude = (modes[:, 0] @ force) / (2.0 * LEAST_DAMPING_OF_LOAD * omega[0] ** 2)
    motion = (mode_shapes @ modes[:, 0] * amplitude).reshape(-1, 3)
    friction = 0.3
    preload = float(spring * np.linalg.norm(motion[:, :2], axis=1).max()) / friction / log_uniform(random, 0.5, 50.0)
    return Problem(
        "narrow",
        seed,
        structure,
        None,
        log_uniform(random, 1e-5, 5e-4),
        normal,
        tangential,
        np.full(n_pairs, friction),
        np.full(n_pairs, preload),
        force[:, None],
        np.zeros((size, 1)),
        (0.8 * float(hertz[0]), 1.15 * float(hertz[in_range - 1])),
    )
