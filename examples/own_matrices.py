"""A user's own matrices: resonance curve of a friction-damped blade, checked against time integration.

The file holds a pre-twisted blade, reduced to 10 contacts with the ground (t1, t2, n each, n > 0 closes) and 8 modes,
in SI units: M, C, K (38, 38), a first-harmonic force F1c, F1s, and resp, the row that reads the motion of the tip.

Run ``python examples/own_matrices.py``; it takes some seconds.
"""

from __future__ import annotations

from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np

import stickslip as ss

DATA = Path(__file__).parent / "data" / "blade_10_contacts.npz"


def main() -> dict[str, float]:
    """Print the peak and what the contacts do there; returns the numbers."""
    with np.load(DATA) as data:
        superelement = ss.Superelement(data["M"], data["K"], data["C"])
        n_contacts = int(data["Nc"])
        pairs = ss.ContactPairs(
            np.eye(3 * n_contacts, superelement.size),  # the contact displacements are the first unknowns
            normal_stiffness=data["kn"],
            tangential_stiffness=data["kt"],
            friction_coefficient=data["mu"],
            preload=data["N0"],
        )
        force_cos, force_sin, tip = data["F1c"], data["F1s"], data["resp"]

    response = ss.forced_response(
        superelement, pairs, force_cos, force_sin, frequency_hz=(635.0, 775.0), harmonics=9, samples=512
    )
    print(response.message)
    amplitude = response.amplitude(tip)
    peak = int(amplitude.argmax())
    frequency_hz = float(response.frequency_hz[peak])
    slipping, separating = (int((response.contact_state[peak] == state).sum()) for state in (1, 2))
    energy = float(response.friction_energy[peak].sum())
    print(f"peak {amplitude[peak] * 1e6:.2f} um (0-peak, mean included) at {frequency_hz:.2f} Hz")
    print(f"{slipping} contacts slip, {separating} separate, {n_contacts - slipping - separating} stick")
    print(f"friction takes {energy * 1e6:.1f} uJ in each cycle")
    draw(response, tip)

    transient = ss.integrate_to_steady_state(
        superelement, pairs, force_cos, force_sin, frequency_hz, **ss.start_from_response(response, peak)
    )
    print(transient.message)
    difference = transient.amplitude(tip) / float(amplitude[peak]) - 1.0
    print(f"time integration: {transient.amplitude(tip) * 1e6:.2f} um, {100.0 * difference:+.2f} %")
    return {
        "peak": float(amplitude[peak]),
        "peak_frequency_hz": frequency_hz,
        "slipping": slipping,
        "separating": separating,
        "dissipated_energy": energy,
        "difference": difference,
    }


def draw(response: ss.ForcedResponse, tip: np.ndarray) -> None:
    """A figure: the response between its linear limits, and what the contacts do."""
    _, (top, bottom) = plt.subplots(2, 1, sharex=True, figsize=(7, 6), layout="constrained")
    top.semilogy(response.frequency_hz, 1e6 * response.amplitude(tip), label="with friction", linewidth=2)
    for limit in ("free", "stuck"):
        linear = response.linear
        top.semilogy(linear.frequency_hz, 1e6 * response.linear_amplitude(tip, limit), "--", label=f"linear, {limit}")
    top.set(ylabel="amplitude at the tip, um", title="A blade on ten friction contacts")
    top.legend()
    for state, name in enumerate(("stuck", "stick-slip", "separating")):
        bottom.plot(response.frequency_hz, (response.contact_state == state).sum(axis=1), ".-", label=name)
    bottom.set(
        xlabel="frequency, Hz", ylabel="contacts", xlim=(response.frequency_hz.min(), response.frequency_hz.max())
    )
    bottom.legend()


if __name__ == "__main__":
    main()
    plt.show()
