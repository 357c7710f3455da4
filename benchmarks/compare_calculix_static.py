"""Our static preload beside contact of CalculiX on the reference mesh of the two blades; needs ``ccx`` on the path.

``python benchmarks/compare_calculix_static.py [surface] [node]``: forces, open nodes and peak pressure of both programs
for three stiffnesses per area, with and without friction, F_N = 500 N. Both formulations take a few minutes.
"""

from __future__ import annotations

import sys
import tempfile
from itertools import product
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).parents[1] / "tests"))

from calculix_contact import NODE, SURFACE, FaceContact, PressedBlades, calculix_contact, our_contact

FORCE = 500.0
STIFFNESS = (3e11, 1e12, 1e13)
FRICTION = (0.0, 0.3)
KINDS = {"surface": SURFACE, "node": NODE}


def row(name: str, stiffness: float, friction: float, contact: FaceContact) -> str:
    """One line of the table; pressures in MPa, area in mm2."""
    area = "-" if contact.closed_area is None else f"{1e6 * contact.closed_area[0]:.1f}"
    return (
        f"| {stiffness:.0e} | {friction:g} | {name} | {contact.normal[0]:.2f} | {contact.shear[0]:.2f} | "
        f"{(contact.closure <= 0.0).sum()} | {area} | {1e-6 * contact.pressure.max():.2f} | "
        f"{1e-6 * stiffness * contact.closure.max():.2f} | {contact.seconds:.2f} |"
    )


def compare(kinds: list[str]) -> None:
    """Print the table."""
    model = PressedBlades.build(None, FORCE)
    print(f"{model.mesh.n_nodes} nodes, {model.pairs.area.size} pairs, face {1e6 * model.face_areas[0]:.1f} mm2")
    print("| N/m3 | mu | program | N | T | open nodes | closed mm2 | peak MPa | kappa x closure MPa | s |")
    print("|---|---|---|---|---|---|---|---|---|---|")
    for stiffness, friction in product(STIFFNESS, FRICTION):
        own = our_contact(model, stiffness, friction)
        wedge = FORCE / (2.0 * (np.cos(np.pi / 6) + friction * np.sin(np.pi / 6)))
        print(row(f"ours (wedge {wedge:.2f} N)", stiffness, friction, own), flush=True)
        for kind in kinds:
            with tempfile.TemporaryDirectory() as folder:
                found = calculix_contact(Path(folder), model, stiffness, friction, KINDS[kind])
            differ = int(((own.closure > 0.0) != (found.closure > 0.0)).sum())
            print(row(f"CalculiX {kind} ({differ} nodes differ)", stiffness, friction, found), flush=True)


if __name__ == "__main__":
    compare(sys.argv[1:] or list(KINDS))
