"""What is computed: the base case with its choices and their reasons, and the curves with the hashes of their inputs.

The paper gives no friction coefficient, damping, hardness or centrifugal force, and no figure legend with numbers
survives, so these are choices. Each is varied alone, low and high, and the page shows what that does to every verdict.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from typing import Any

from stickslip.case.case import TwoBladeCase
from stickslip.contact.stiffness.fractal import StiffnessMode
from stickslip.core.errors import StudyFileError
from stickslip.model.rough_face import roughness_section
from stickslip.papers.rough_damper.table2 import SOURCE, table2
from stickslip.sweeps.plan import PlannedCase, case_hashes

EXCITATIONS = ("single", "same", "opposite")
BASE_CHOICE = "base"


LOAD_KEY = "preload.centrifugal_force"
LAW_KEY = "roughness.mode"
# Law as the page calls it -> roughness.mode of study files; "paper" is equation 8 as printed.
MODES: Mapping[str, StiffnessMode] = {
    "consistent": "consistent",
    "paper": "varying-curvature",
    "unloading": "unloading",
}
_LAWS = {mode: law for law, mode in MODES.items()}
Roughnesses = tuple[tuple[float, float], ...]  # (D, G in m)


@dataclass(frozen=True)
class Choice:
    """A value that the paper leaves open: key of the study file, base value, low and high ones beside it, and why."""

    name: str
    key: str
    base: Any
    others: tuple[Any, ...]
    reason: str


CHOICES = (
    Choice(
        "excitation height",
        "geometry.excitation_height",
        "18.35 mm",
        ("11.01 mm", "25.69 mm"),
        "middle of the shank. One element row above the root, 3.67 mm, 5 N at both blades move the tip by 11 to "
        "13 µm and no pair slips (checked at 5, 20 and 50 N centrifugal force); with the middle, pairs slip and open.",
    ),
    Choice(
        "damping",
        "damping.modal_damping_ratio",
        0.001,
        (0.0005, 0.002),
        "0.1 % of critical in each stuck mode, usual for a steel blade without aerodynamic damping.",
    ),
    Choice(
        "friction coefficient",
        "friction.coefficient",
        0.3,
        (0.15, 0.5),
        "dry metal has 0.1 to 0.8; 0.3 is common.",
    ),
    Choice(
        "hardness",
        "roughness.hardness",
        "3 GPa",
        ("2 GPa", "4 GPa"),
        "middle of the range of steels and nickel alloys. The critical spot area is proportional to H^(-2/(D-2)).",
    ),
    Choice(
        "centrifugal force",
        LOAD_KEY,
        "100 N",
        ("50 N", "200 N"),
        "with it 5 N and 2 N in the same direction make pairs slip and separate for most of the roughness, as in the "
        "paper's maps; at 200 N and 2 N most pairs remain stuck.",
    ),
    Choice(
        "stiffness law",
        LAW_KEY,
        "consistent",
        ("varying-curvature",),
        "the stiffness of a spot at fixed curvature (Hertz), in which equations 8 and 9 agree with each other.",
    ),
    Choice(
        "preload",
        "preload.method",
        "prescribed",
        ("solved",),
        "uniform pressure on each face, as the paper's preload of each pair suggests. The other one follows from the "
        "static load with contact and gaps, tractions at rest released.",
    ),
)


@dataclass(frozen=True)
class Setting:
    """What distinguishes one curve: the changed choice, excitation, force (N), load F_N (N), D, G (m), law."""

    choice: str
    excitation: str
    force: float
    load: float
    dimension: float
    scale: float
    law: str

    @property
    def words(self) -> str:
        """The setting as a page names it."""
        return (
            f"{self.choice}, excitation {self.excitation} with {self.force:g} N, F_N {self.load:g} N, "
            f"D {self.dimension:g}, G {self.scale:g} m, law {self.law}"
        )


@dataclass(frozen=True)
class Computation:
    """One curve to compute."""

    setting: Setting
    planned: PlannedCase


@dataclass(frozen=True)
class Scope:
    """How much is computed; the defaults are the whole study.

    dimensions at ``scale`` and scales (m) at ``dimension`` are the two roughness series of the base; the shorter ones
    are those of the varied choices. ``runs`` are (force N, load N) of the base, the first one the main run. A varied
    choice has the same runs, those after the first for the (D, G) of ``compared`` alone, which are among its series.
    ``extra`` are (D, G, law) beside them. ``changes`` apply to every case.
    """

    dimensions: tuple[float, ...] = (2.3, 2.35, 2.4, 2.45, 2.49)
    scales: tuple[float, ...] = (1e-8, 3e-9, 1e-9, 3e-10, 1e-10)
    short_dimensions: tuple[float, ...] = (2.35, 2.4, 2.49)
    short_scales: tuple[float, ...] = (1e-8, 1e-9, 1e-10)
    dimension: float = 2.4
    scale: float = 1e-9
    runs: tuple[tuple[float, float], ...] = ((5.0, 100.0), (2.0, 100.0), (5.0, 50.0))
    compared: Roughnesses = ((2.4, 1e-9), (2.4, 1e-10))
    extra: tuple[tuple[float, float, str], ...] = (
        (2.45, 1e-8, "consistent"),
        (2.49, 1e-8, "consistent"),
        (2.2, 1e-8, "unloading"),
        (2.3, 1e-8, "unloading"),
        (2.4, 1e-8, "unloading"),
        (2.49, 1e-8, "unloading"),
        (2.2, 1e-12, "consistent"),
        (2.3, 1e-10, "consistent"),
    )
    choices: tuple[Choice, ...] = CHOICES
    changes: Mapping[str, Any] = field(default_factory=dict)

    def roughness(self, short: bool) -> Roughnesses:
        """(D, G) of both series, each pair once."""
        dimensions = self.short_dimensions if short else self.dimensions
        scales = self.short_scales if short else self.scales
        settings = [(d, self.scale) for d in dimensions] + [(self.dimension, g) for g in scales]
        return tuple(dict.fromkeys(settings))

    def changed_runs(self, load: float | None = None) -> tuple[tuple[float, float, Roughnesses], ...]:
        """(force N, load N, its roughness) of the runs of a varied choice, or of the base where it is compared with
        one. Under another main load the loads of all runs change in proportion."""
        _, main = self.runs[0]
        factor = 1.0 if load is None else load / main
        return tuple(
            (force, factor * here, self.compared if place else self.roughness(short=True))
            for place, (force, here) in enumerate(self.runs)
        )


# The faces of the paper, and what it leaves open of them; each curve has its own D, G and law.
FACES: Mapping[str, Any] = {
    "roughness.law": "fractal",
    "roughness.fractal_dimension": 2.4,
    "roughness.fractal_roughness": "1e-8 m",
    "roughness.sample_length": "28 mm",
    "roughness.shortest_length": "1 um",
}
WINDOW: Mapping[str, Any] = {"solver.frequency_start": "405 Hz", "solver.frequency_stop": "535 Hz"}


def base_case(scope: Scope) -> TwoBladeCase:
    """The case that all others are made from. Raises StudyFileError for a wrong change."""
    chosen = {choice.key: choice.base for choice in CHOICES}
    compared = {"reference.mode_frequencies": [row["full_hz"] for row in table2()], "reference.source": SOURCE}
    return TwoBladeCase().replace({**FACES, **chosen, **WINDOW, **compared, **scope.changes})


def computations(scope: Scope) -> tuple[Computation, ...]:
    """Every curve of the study, the base first. Raises StudyFileError for a case that is not valid."""
    base, seen, result = base_case(scope), set(), []
    for choice, changed, force, load, dimension, scale, law in _wanted(scope):
        for excitation in EXCITATIONS:
            setting = Setting(choice, excitation, force, load, dimension, scale, law)
            case = base.replace({**changed, **_of(setting)})
            key, structure = case_hashes(case)
            if key in seen:
                raise StudyFileError(f"the study computes {setting} twice; remove one of them from the scope.")
            seen.add(key)
            result.append(Computation(setting, PlannedCase(_name(setting, key), key, structure, (), case)))
    return tuple(result)


def _wanted(scope: Scope) -> Iterator[tuple[str, dict[str, Any], float, float, float, float, str]]:
    """(choice, its changes, force, load, D, G, law) of every curve, without the excitation."""
    law = "consistent"
    for force, load in scope.runs:
        for dimension, scale in scope.roughness(short=False):
            yield BASE_CHOICE, {}, force, load, dimension, scale, law
    force, load = scope.runs[0]
    for dimension, scale, other in scope.extra:
        yield BASE_CHOICE, {}, force, load, dimension, scale, other
    for choice, value in changes(scope):
        changed, probe = variant(choice, value), base_case(scope).replace({choice.key: value})
        law_there = law_of(probe)
        for force, load, points in scope.changed_runs(changed_load(choice, probe)):
            if choice.key == LOAD_KEY and (force, load) in scope.runs:
                continue  # a run of the base already
            for dimension, scale in points:
                yield changed, {choice.key: value}, force, load, dimension, scale, law_there


def changes(scope: Scope) -> Iterator[tuple[Choice, Any]]:
    """Every choice with each of its other values."""
    for choice in scope.choices:
        for value in choice.others:
            yield choice, value


def changed_load(choice: Choice, case: TwoBladeCase) -> float | None:
    """The main centrifugal force (N) of a case if it is the choice that is varied, else None."""
    return case.preload.centrifugal_force if choice.key == LOAD_KEY else None


def law_of(case: TwoBladeCase) -> str:
    """The law of a case as the page calls it."""
    return _LAWS[roughness_section(case).fractal_mode]


def words_of(choice: Choice, value: Any) -> str:
    """A value of a choice as the page calls it."""
    return _LAWS[value] if choice.key == LAW_KEY else str(value)


def variant(choice: Choice, value: Any) -> str:
    """The label of a changed choice."""
    return f"{choice.name} {value:g}" if isinstance(value, float) else f"{choice.name} {words_of(choice, value)}"


def _of(setting: Setting) -> dict[str, Any]:
    return {
        "excitation.mode": setting.excitation,
        "excitation.amplitude": setting.force,
        LOAD_KEY: setting.load,
        "roughness.fractal_dimension": setting.dimension,
        "roughness.fractal_roughness": f"{setting.scale!r} m",
        LAW_KEY: MODES[setting.law],
    }


def _name(setting: Setting, key: str) -> str:
    words = f"{setting.choice}_{setting.excitation}_{setting.force:g}N_{setting.load:g}N_D{setting.dimension:g}"
    return f"{words}_G{setting.scale:g}_{setting.law}_{key[:12]}".replace(" ", "-")
