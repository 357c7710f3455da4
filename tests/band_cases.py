"""A linear case whose band has a closed form: one mass with a joint that a large normal load keeps stuck."""

from __future__ import annotations

import math
from pathlib import Path

from law_studies import REST, interface_text, write_masses, write_study

DIRECTION = (1.0, 0.5, 0.7)
STIFFNESS = 1e4 + 8e3  # N/m along x: of the structure and of the stuck joint
FORCE, DAMPING = "forces.push.amplitude", "damping.modal_damping_ratio"


def linear_study(folder: Path) -> Path:
    """A study file: 21.35 Hz, forced by 2 mN."""
    write_masses(folder)
    joint = interface_text("joint", "coulomb").replace('"3 N"', '"300 N"')
    rest = REST.replace('"2 N"', '"2 mN"').replace("[solver]", "[solver]\nharmonics = 1\nsamples = 16")
    rest = rest.replace("15 Hz", "19 Hz").replace("30 Hz", "24 Hz")
    return write_study(folder, joint, rest=rest)


def peak_m(force_n: float, damping_ratio: float) -> float:
    """The peak along x: F_x / (2 k zeta sqrt(1 - zeta^2))."""
    along = force_n / math.hypot(*DIRECTION)
    return along / (2.0 * STIFFNESS * damping_ratio * math.sqrt(1.0 - damping_ratio**2))
