"""Items made of the state at the peak: pairs over a period, motion of the damper, states of the pairs."""

from __future__ import annotations

import numpy as np

from stickslip.papers.rough_damper.claims import MICRO, Solutions, series
from stickslip.papers.rough_damper.further_claims import rotation_words
from stickslip.papers.rough_damper.items import Item, Picture, base, judged
from stickslip.papers.rough_damper.plan import Scope
from stickslip.papers.rough_damper.records import SHOWN_PLACES, Solved
from stickslip.papers.rough_damper.tables import Cell, Table, columns


def main_run(solutions: Solutions, scope: Scope, force: float | None = None) -> list[Solved]:
    """The base curves under the main centrifugal force, and the main or another force."""
    first, load = scope.runs[0]
    wanted = first if force is None else force
    return [one for one in base(solutions) if (one.setting.force, one.setting.load) == (wanted, load)]


def main_series(chosen: Solutions, along: str) -> list[Solved]:
    """The curves of the longest series of D or G for each excitation, in its order."""
    longest: dict[str, list[Solved]] = {}
    for line in series(chosen, along):
        name = line[0].setting.excitation
        if len(line) > len(longest.get(name, [])):
            longest[name] = line
    return [one for line in longest.values() for one in line]


def shown_place(solutions: Solutions) -> int:
    """Which of the three pairs shows most: the one that is in most different states within its periods."""
    kinds = [sum(len(np.unique(one.phase_state[place])) for one in solutions) for place in range(len(SHOWN_PLACES))]
    return int(np.argmax(kinds))


def period_item(solutions: Solutions, scope: Scope) -> Item:
    """Figures 7 and 8."""
    chosen = [one for one in main_run(solutions, scope) if one.setting.excitation != "single"]
    rows: list[tuple[Cell, ...]] = []
    for one in chosen:
        s = one.setting
        for place, name in enumerate(SHOWN_PLACES):
            shares = [100.0 * float((one.phase_state[place] == code).mean()) for code in range(3)]
            normal = one.signals[place, 5]
            friction = np.hypot(*one.signals[place, 3:5]).max()
            rows.append(
                (
                    s.excitation,
                    s.dimension,
                    s.scale,
                    name,
                    *shares,
                    float(normal.min()),
                    float(normal.max()),
                    float(friction),
                )
            )
    table = Table(
        "fig07_08_period",
        "Fractions of the period, and forces, of three pairs at mid-length of the left face, at the peak",
        columns(
            "excitation||Excitation",
            "dimension||D",
            "scale|m|G",
            "pair||Pair",
            "stuck|%|Stuck",
            "slipping|%|Slipping",
            "open|%|Open",
            "least_normal|N|Least N",
            "largest_normal|N|Largest N",
            "largest_friction|N|Largest friction",
        ),
        tuple(rows),
    )
    place = shown_place(chosen)
    return Item(
        "period",
        "Figures 7 and 8: one pair over one period",
        "Within one period a pair sticks, slips and may separate; which of these depends on D, G and the excitation.",
        (f"The paper does not number its pair. The figure shows the {SHOWN_PLACES[place]} one of the table.",),
        (table,),
        tuple(
            Picture(
                f"fig{number}_period_{along}",
                f"Friction forces, normal force and state of one pair over a period, a line for each {along}; same "
                "direction left, opposite right.",
                table.name,
            )
            for number, along in (("07", "D"), ("08", "G"))
        ),
        judged(chosen, "three states"),
    )


def damper_item(solutions: Solutions, scope: Scope) -> Item:
    """Figure 9 with the rigid-body fit."""
    chosen = main_run(solutions, scope)
    rows: list[tuple[Cell, ...]] = []
    for one in chosen:
        s = one.setting
        shares = [100.0 * float(share) for share in one.shares]
        swing = MICRO * 0.5 * np.ptp(one.sides, axis=2)
        rows.append((s.excitation, s.dimension, s.scale, *shares, *(float(value) for value in swing.ravel())))
    table = Table(
        "fig09_damper",
        "Rigid-body fit over the 110 contact nodes of the damper, and its middle nodes, at the peak",
        columns(
            "excitation||Excitation",
            "dimension||D",
            "scale|m|G",
            "translation|%|Translation",
            "rotation|%|Rotation",
            "deformation|%|Deformation",
            "left_x|um|Left x",
            "left_y|um|Left y",
            "left_z|um|Left z",
            "right_x|um|Right x",
            "right_y|um|Right y",
            "right_z|um|Right z",
        ),
        tuple(rows),
    )
    pair = pick_pair(chosen, scope)
    return Item(
        "damper",
        "Figure 9: does the damper translate or rotate?",
        "Same direction moves the damper as a translation, opposite directions rotate it.",
        (
            "Least squares on the first harmonic: translation plus rotation about the centre of the nodes; the "
            "fractions are those of the sum of squared displacements. Swings are half of peak to peak.",
            "Two mirrored blades under opposite forces along x move as mirror images, and a rigid body that "
            "mirrors itself can move up, down and tilt along its length, but not rotate about its length. "
            + mirror_words(pair[1]),
            "A verdict needs more than a half of the motion, so a translation may contain much rotation. "
            f"{rotation_words(chosen)}",
        ),
        (table,),
        (
            Picture(
                "fig09_damper",
                "Displacement of the damper's left and right middle node in x, y and z over a period; same direction "
                "left, opposite right.",
                table.name,
            ),
        ),
        judged(chosen, "translation", "rotation", "rotation, larger"),
    )


def mirror_words(one: Solved) -> str:
    """How well the motion under opposite forces mirrors itself, in words with numbers."""
    left, right = one.sides[0], one.sides[1]
    unlike = np.abs(left[2] - right[2]).max() / max(
        np.abs(one.sides - one.sides.mean(axis=2, keepdims=True)).max(), 1e-30
    )
    return f"Here z of the two nodes differs by {100.0 * unlike:.2g} % of the largest swing at most."


def pick_pair(chosen: Solutions, scope: Scope) -> tuple[Solved, Solved]:
    """Same and opposite at the roughness in which both series meet; the first of each if it has no result."""

    def pick(excitation: str) -> Solved:
        kind = [one for one in chosen if one.setting.excitation == excitation]
        centre = [one for one in kind if (one.setting.dimension, one.setting.scale) == (scope.dimension, scope.scale)]
        return (centre or kind)[0]

    return pick("same"), pick("opposite")


def states_item(solutions: Solutions, scope: Scope) -> Item:
    """Figures 10 and 11."""
    forces = list(dict.fromkeys(force for force, load in scope.runs if load == scope.runs[0][1]))
    chosen = [one for force in forces for one in main_run(solutions, scope, force)]
    rows: list[tuple[Cell, ...]] = []
    for one in chosen:
        s, n = one.setting, one.numbers
        rows.append(
            (s.force, s.excitation, s.dimension, s.scale, int(n["stuck"]), int(n["stick_slip"]), int(n["separating"]))
        )
    table = Table(
        "fig10_11_states",
        "Pairs in each state at the peak",
        columns(
            "force|N|Force",
            "excitation||Excitation",
            "dimension||D",
            "scale|m|G",
            "stuck||Stuck",
            "stick_slip||Stick-slip",
            "separating||Separating",
        ),
        tuple(rows),
    )
    figures = tuple(
        Picture(
            f"fig{number}_states_{along}_{force:g}N",
            f"State of each of the pairs at the peak under {force:g} N: a row for each {along}, a column for each "
            "excitation, the two faces side by side.",
            table.name,
        )
        for number, along in ((10, "D"), (11, "G"))
        for force in forces
    )
    return Item(
        "states",
        "Figures 10 and 11: states of the pairs",
        "With larger D and smaller G fewer pairs remain stuck; 5 N leaves fewer stuck than 2 N; opposite forces leave "
        "nearly all stuck.",
        (),
        (table,),
        figures,
        judged(chosen, "slip, D", "slip, G", "force, slip", "force, separation"),
    )
