"""A bolted joint beside a face with dry friction: the resonance shifts with the force, from one study file.

Run ``python examples/joint_laws.py``; it takes some seconds.
"""

from __future__ import annotations

from pathlib import Path

import matplotlib.pyplot as plt

import stickslip as ss

STUDY = Path(__file__).parent / "own_mesh" / "bolted.toml"
FORCES_NEWTON = (0.1, 0.2, 0.4)


def main() -> dict[float, tuple[float, float]]:
    """Print and plot the response for three forces; return peak frequency in Hz and friction energy in J for each."""
    case = ss.load_case(STUDY)
    _, axes = plt.subplots(layout="constrained")
    peaks = {}
    for force in FORCES_NEWTON:
        solution = ss.solve_case(case.replace({"forces.push.amplitude": force}))
        response = solution.response
        amplitude = response.amplitude(solution.model.outputs["tip"])
        peak = int(amplitude.argmax())
        frequency_hz, energy = float(response.frequency_hz[peak]), float(response.friction_energy[peak].sum())
        print(f"{force} N: peak at {frequency_hz:.2f} Hz, the joints dissipate {1e6 * energy:.3g} uJ in each cycle")
        axes.semilogy(response.frequency_hz, 1e6 * amplitude / force, label=f"{force} N")
        peaks[force] = frequency_hz, energy
    axes.set(
        xlabel="frequency, Hz", ylabel="amplitude at the tip for 1 N, 0-to-peak, um/N", title="Block with a bolted lid"
    )
    axes.legend(title="force")
    return peaks


if __name__ == "__main__":
    main()
    plt.show()
