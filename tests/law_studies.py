"""Studies of one mass on springs, with a joint to the ground whose contact law the study file names."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

import stickslip as ss

WINDOW_HZ = (15.0, 30.0)
SETTINGS: dict[str, Any] = {"harmonics": 5, "samples": 256, "modal_damping_ratio": 0.02}
HEADER = """\
[structure]
kind = "matrices"
file = "masses.npz"
"""
JOINT = """\
normal = [0, 0, 1]
tangent = [1, 0, 0]
area = "100 mm^2"
"""
REST = """\
[forces.push]
node = 1
direction = [1, 0.5, 0.7]
amplitude = "2 N"
[responses.mass]
node = 1
direction = [1, 0, 0]
[damping]
modal_damping_ratio = 0.02
[solver]
frequency_start = "15 Hz"
frequency_stop = "30 Hz"
[output]
figure_formats = []
"""
# Law -> what stands in the section of the interface, and in that of the constants.
STUDIES: dict[str, tuple[str, str]] = {
    "coulomb": ('normal_load = "3 N"\nnormal_stiffness = "1e4 N/m"\ntangential_stiffness = "8e3 N/m"\n', ""),
    "cubic": ("", 'stiffness = ["1e4 N/m", "9 kN/m", 0]\ncubic_stiffness = "1e9 N/m^3"\n'),
    "elastic-stop": ('gap = "0.3 mm"\n', 'stiffness = "2e4 N/m"\nspring = "1e4 N/m"\ntwo_sided = true\n'),
    "jenkins": ('tangential_stiffness = "1e4 N/m"\nnormal_stiffness = "5e3 N/m"\n', 'friction_limit = "1.5 N"\n'),
    "iwan": (
        'tangential_stiffness = "1e4 N/m"\n',
        'slip_force = "4 N"\nexponent = -0.5\nratio = 0.3\n',
    ),
    "exponential": ('normal_load = "3 N"\nnormal_stiffness = "1e4 N/m"\ntangential_stiffness = "8e3 N/m"\n', ""),
}


def write_masses(folder: Path, n: int = 1) -> ss.Superelement:
    """``n`` masses of 1 kg, each with springs of 1e4 N/m along x, y and z: 15.9 Hz without the joint."""
    numbers = np.arange(1, n + 1)
    sets = {"all": numbers, **{f"mass{number}": numbers[[number - 1]] for number in numbers}}
    masses = ss.Superelement(np.eye(3 * n), 1e4 * np.eye(3 * n), boundary_nodes=numbers, node_sets=sets)
    ss.write_superelement(folder / "masses.npz", masses)
    return masses


def interface_text(name: str, law: str, first: str = "all") -> str:
    """The sections of an interface with a law."""
    keys, constants = STUDIES[law]
    text = f'[interfaces.{name}]\nfirst = "{first}"\nsecond = "ground"\n{JOINT}{keys}law = "{law}"\n'
    return text + (f"[interfaces.{name}.constants]\n{constants}" if constants else "")


def write_study(folder: Path, *interfaces: str, rest: str = REST) -> Path:
    """A study file with the text of its interfaces."""
    target = folder / "study.toml"
    target.write_text(HEADER + "".join(interfaces) + rest, encoding="utf-8")
    return target


def law_of(name: str, n: int = 1) -> Any:
    """The same law in Python: constants of the whole face in ``n`` equal parts."""
    part = np.full(n, 1.0 / n)
    match name:
        case "coulomb":
            return ss.CoulombLaw(1e4 * part, 8e3 * part, np.full(n, 0.3), 3.0 * part, np.zeros(n))
        case "cubic":
            return ss.CubicSpring(np.multiply.outer(part, [1e4, 9e3, 0.0]), 1e9 * part)
        case "elastic-stop":
            return ss.ElasticStop(2e4 * part, np.full(n, 3e-4), 1e4 * part, two_sided=True)
        case "jenkins":
            return ss.JenkinsElement(1e4 * part, 1.5 * part, 5e3 * part)
        case "iwan":
            return ss.IwanJoint(1e4 * part, 4.0 * part, np.full(n, -0.5), np.full(n, 0.3))
        case "exponential":
            return ss.ExponentialContact(1e4 * part, 8e3 * part, np.full(n, 0.3), 3.0 * part)
    raise AssertionError(name)
