"""Two blades with an under-platform damper, in Python: change keys of the study and compare the curves.

Goal: compare the peak at the blade tip for an excitation on one blade, on both blades in the same direction, and on
both in opposite directions. All three cases use the same reduced structure; only the force differs.
The faces are rough castings: a soft joint, whose curves are quick for all three.
"""

from __future__ import annotations

from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np

import stickslip as ss


def main(harmonics: int = 3, samples: int = 128) -> dict[str, float]:
    """Solve the three excitation modes and return the peak at A in micrometres for each mode."""
    casting = ss.load_case(Path(__file__).with_name("rough_casting.toml"))
    case = casting.replace({"solver.harmonics": harmonics, "solver.samples": samples})
    peaks = {}
    _, axes = plt.subplots(figsize=(7, 4.5), layout="constrained")
    for mode in ("single", "same", "opposite"):
        solution = ss.solve_case(case.replace({"excitation.mode": mode}))
        response = solution.response
        amplitude = response.amplitude(solution.model.outputs["blade tip A"])
        top = int(amplitude.argmax())
        stuck, slip, separating = np.bincount(response.contact_state[top], minlength=3)
        peaks[mode] = 1e6 * float(amplitude[top])
        axes.plot(response.frequency_hz, 1e6 * amplitude, label=f"{mode} excitation")
        print(
            f"{mode:<9} {peaks[mode]:6.1f} um 0-to-peak at {response.frequency_hz[top]:6.2f} Hz, "
            f"{stuck} stuck, {slip} stick-slip, {separating} separating"
        )
    axes.set(xlabel="frequency, Hz", ylabel="amplitude at blade tip A, um", title="Two blades with a friction damper")
    axes.legend()
    return peaks


if __name__ == "__main__":
    main()
    plt.show()
