"""A bolted joint beside a face with dry friction: how the resonance softens with the force, from one study file.

Run ``python examples/joint_laws.py``; it takes some seconds.
"""

from __future__ import annotations

from pathlib import Path

import stickslip as ss

STUDY = Path(__file__).parent / "own_mesh" / "bolted.toml"


def main() -> dict[str, tuple[float, float]]:
    """Print peak frequency and friction energy for three forces; returns them by force."""
    case = ss.load_case(STUDY)
    found = {}
    for force in ("0.1 N", "0.2 N", "0.4 N"):
        solution = ss.solve_case(case.replace({"forces.push.amplitude": force}))
        response, tip = solution.response, solution.model.outputs["tip"]
        peak = int(response.amplitude(tip).argmax())
        frequency_hz, energy = float(response.frequency_hz[peak]), float(response.friction_energy[peak].sum())
        print(f"{force}: peak at {frequency_hz:.2f} Hz, the joints take {1e6 * energy:.3g} uJ in each cycle")
        found[force] = frequency_hz, energy
    return found


if __name__ == "__main__":
    main()
