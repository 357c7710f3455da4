"""The problems of stability_check.py: constructed ones with a known answer or kind of motion, and random ones."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
from blade_problem import load_blade_problem
from rough_casting import rough_casting
from torture_problems import make as torture_problem
from torture_problems import modal_damping_matrix, modes_of, with_springs

import stickslip as ss

FloatArray = np.ndarray


@dataclass(frozen=True)
class Problem:
    """A structure with a joint, its force, and how to integrate it."""

    name: str
    superelement: ss.Superelement
    pairs: ss.ContactPairs
    force_cos: FloatArray
    window_hz: tuple[float, float]
    harmonics: int = 7
    samples: int = 256
    force_sin: FloatArray | None = None
    steps: int = 240
    is_random: bool = False  # then only changes of the verdict have points, each on a short curve


def solve(problem: Problem) -> ss.ForcedResponse:
    """The curve of a problem."""
    return ss.forced_response(
        problem.superelement, problem.pairs, problem.force_cos, problem.force_sin, frequency_hz=problem.window_hz,
        harmonics=problem.harmonics, samples=problem.samples,
    )  # fmt: skip


def oscillator(mass: float, damping: float, stiffness: float) -> ss.Superelement:
    """One degree of freedom."""
    return ss.Superelement(np.array([[mass]]), np.array([[stiffness]]), np.array([[damping]]))


def along(axis: int, size: int = 1, unknown: int = 0) -> FloatArray:
    """The operator (3, size) of one pair between an unknown and the ground, along t1 (0), t2 (1) or n (2)."""
    operator = np.zeros((3, size))
    operator[axis, unknown] = 1.0
    return operator


def _hertz(low: float, high: float) -> tuple[float, float]:
    """Hz of circular frequencies."""
    return low / (2.0 * np.pi), high / (2.0 * np.pi)


def duffing(cubic: float, force: float, window: tuple[float, float], name: str) -> Problem:
    """``x'' + 0.05 x' + x + cubic x^3 = force cos(w t)`` (Nayfeh and Mook 1979, sec. 4.1)."""
    law = ss.CubicSpring(np.array([[1.0, 0.0, 0.0]]), np.array([[cubic, 0.0, 0.0]]))
    pairs = ss.ContactPairs.with_laws(along(0), [law])
    return Problem(name, oscillator(1.0, 0.05, 0.0), pairs, np.array([force]), _hertz(*window), samples=128)


def stop(
    stiffness: float, gap: float, force: float, window: tuple[float, float], name: str, two_sided: bool = False
) -> Problem:
    """An oscillator of frequency 1 with an elastic stop (Shaw and Holmes 1983); impacts double the period near twice
    its frequency."""
    law = ss.ElasticStop(np.array([stiffness]), np.array([gap]), two_sided=two_sided)
    pairs = ss.ContactPairs.with_laws(along(2), [law])
    return Problem(name, oscillator(1.0, 0.1, 1.0), pairs, np.array([force]), _hertz(*window), harmonics=15)


def jenkins_with_cubic(force: float, name: str) -> Problem:
    """A hardening oscillator with a friction element of constant limit beside it."""
    laws = [
        ss.CubicSpring(np.array([[1.0, 0.0, 0.0]]), np.array([[0.3, 0.0, 0.0]])),
        ss.JenkinsElement(np.array([[0.6, 0.0]]), np.array([[0.1, 0.1]])),
    ]
    pairs = ss.ContactPairs.with_laws(np.vstack([along(0), along(0)]), laws)
    return Problem(name, oscillator(1.0, 0.02, 0.0), pairs, np.array([force]), _hertz(0.7, 2.2))


def coulomb_with_gap(gap: float, force: float, name: str) -> Problem:
    """A mass that swings along n and t1 against a pair that is open at rest: it hardens where it closes."""
    structure = ss.Superelement(np.eye(2), np.array([[1.0, 0.1], [0.1, 1.3]]), 0.06 * np.eye(2))
    operator = np.array([[0.0, 1.0], [0.0, 0.0], [1.0, 0.0]])
    pairs = ss.ContactPairs(operator, 2.0, 1.5, 0.3, normal_load=0.0, gap=gap)
    return Problem(name, structure, pairs, np.array([force, 0.0]), _hertz(0.6, 1.9), steps=500)


def separating(load: float, force: float, name: str) -> Problem:
    """A mass pressed on a pair that lifts off, with friction across: it softens, and its peak folds to the left."""
    structure = ss.Superelement(np.eye(2), np.array([[0.5, 0.0], [0.0, 0.7]]), 0.04 * np.eye(2))
    operator = np.array([[0.0, 1.0], [0.0, 0.0], [1.0, 0.2]])
    pairs = ss.ContactPairs(operator, 2.0, 1.0, 0.4, normal_load=load)
    return Problem(name, structure, pairs, np.array([force, 0.3 * force]), _hertz(0.9, 2.0), steps=500)


def slipping(load: float, name: str) -> Problem:
    """Two masses, one of them on a pair that always stays closed: friction damps and nothing folds."""
    stiffness = np.array([[2.0, -1.0, 0.0], [-1.0, 1.5, 0.0], [0.0, 0.0, 4.0]])
    structure = ss.Superelement(np.diag([1.0, 0.7, 1.0]), stiffness, 0.01 * np.eye(3))
    operator = np.zeros((3, 3))
    operator[0, 1], operator[2, 2] = 1.0, 1.0
    pairs = ss.ContactPairs(operator, 3.0, 2.0, 0.5, normal_load=load)
    force = np.array([0.3, 0.0, 0.2])
    return Problem(name, structure, pairs, force, _hertz(0.6, 2.2), steps=500)


def blade(preload: float, force: float, name: str) -> Problem:
    """The bench blade with ten contacts, its preload and force multiplied."""
    data = load_blade_problem(10)
    pairs = ss.ContactPairs(
        data.contact_operator(),
        data.normal_stiffness,
        data.tangential_stiffness,
        data.friction_coefficient,
        preload * data.preload,
    )
    structure = ss.Superelement(data.mass, data.stiffness, data.damping)
    return Problem(name, structure, pairs, force * data.force_cos, data.window_hz, 5, 256, force * data.force_sin, 400)


def two_blades(name: str) -> Problem:
    """The two blades with the faces of a rough casting, around their folds; the damping of their modes as a matrix."""
    case = rough_casting()
    model, ratio = ss.build_model(case), case.damping.modal_damping_ratio
    structure, pairs = model.superelement, model.pairs
    operator = pairs.operator
    stuck = structure.stiffness + operator.T @ (pairs.resting_stiffness()[:, None] * operator)
    damping = modal_damping_matrix(structure.mass, *modes_of(structure.mass, stuck), ratio)
    force = model.excitation.on(structure, 1).coefficients(1.0)
    return Problem(
        name, ss.Superelement(structure.mass, structure.stiffness, damping), pairs, force[1], (450.0, 458.0), 9, 256,
        force[2], 400,
    )  # fmt: skip


def random_problem(kind: str, seed: int, name: str) -> Problem:
    """A problem of the torture set, with so many harmonics that its points are motions of the equation."""
    made = torture_problem(kind, seed)
    structure, damping = made.structure, made.damping
    if damping is None:
        assert made.modal_damping_ratio is not None
        springs = np.column_stack([made.tangential_stiffness, made.normal_stiffness])
        stuck = modes_of(structure.mass, with_springs(structure, np.where(made.preload[:, None] >= 0.0, springs, 0.0)))
        damping = modal_damping_matrix(structure.mass, *stuck, made.modal_damping_ratio)
    return Problem(
        name, ss.Superelement(structure.mass, structure.stiffness, damping), made.pairs(), made.force_cos,
        made.window_hz, 11, 256, made.force_sin, 480, True,
    )  # fmt: skip


def twins_beside_a_torus(name: str) -> Problem:
    """A random problem around the torus at which its motion with five rattling pairs becomes stable."""
    return replace(random_problem("twins", 0, name), window_hz=(240.5, 243.5), is_random=False)


def rigid_damper(seed: int, name: str) -> Problem:
    """A random rigid damper that friction alone supports: it rattles, and walks on in each cycle."""
    made = torture_problem("damper", seed)
    assert made.damping is not None
    force = made.force_cos[:, 0], made.force_sin[:, 0]
    return Problem(name, made.superelement(), made.pairs(), force[0], made.window_hz, 9, 256, force[1], 480)


RANDOM = (
    ("high", 0), ("high", 10), ("low", 2), ("light", 1), ("narrow", 0), ("narrow", 1), ("narrow", 2), ("twins", 0),
    ("twins", 2), ("twins", 5), ("multi", 2), ("wide", 0), ("chain", 1), ("beam", 2),
)  # fmt: skip
PROBLEMS: dict[str, Callable[[str], Problem]] = {
    "duffing, hardening": lambda name: duffing(0.4, 0.25, (0.5, 3.0), name),
    "duffing, softening": lambda name: duffing(-0.05, 0.12, (0.4, 1.4), name),
    "duffing, force of 0.5": lambda name: duffing(0.4, 0.5, (0.8, 3.5), name),
    "stop, soft": lambda name: stop(2.0, 1.0, 0.3, (0.6, 2.0), name),
    "stop, stiff": lambda name: stop(20.0, 1.0, 0.5, (1.0, 3.2), name),
    "stop, near twice its frequency": lambda name: stop(4.0, 0.05, 1.0, (1.8, 4.0), name),
    "stop, two-sided": lambda name: stop(3.0, 1.0, 0.3, (0.6, 2.0), name, two_sided=True),
    "friction element beside a cubic spring": lambda name: jenkins_with_cubic(0.25, name),
    "friction element, more force": lambda name: jenkins_with_cubic(0.4, name),
    "coulomb pair with a gap": lambda name: coulomb_with_gap(1.0, 0.2, name),
    "coulomb pair with a gap, more force": lambda name: coulomb_with_gap(1.0, 0.35, name),
    "separating pair": lambda name: separating(1.0, 0.15, name),
    "separating pair, more force": lambda name: separating(1.0, 0.25, name),
    "slipping pair": lambda name: slipping(1.0, name),
    "blade": lambda name: blade(1.0, 1.0, name),
    "blade, half the preload": lambda name: blade(0.5, 1.0, name),
    "two blades": two_blades,
    "torus of twins 0": twins_beside_a_torus,
    "rigid damper 3": lambda name: rigid_damper(3, name),
    "rigid damper 9": lambda name: rigid_damper(9, name),
    **{
        f"{kind} {seed}": lambda name, kind=kind, seed=seed: random_problem(kind, seed, name)  # type: ignore[misc]
        for kind, seed in RANDOM
    },
}
