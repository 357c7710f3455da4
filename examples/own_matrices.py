"""Matrices of your own: resonance curve of a friction-damped blade, with time integration as a check.

The file contains a pre-twisted blade in SI units. It is reduced to 10 contacts with the ground (t1, t2, n each; n > 0
closes the contact) and 8 modes. M, C, K have the shape (38, 38). F1c and F1s are the force in the first harmonic.
The product of the row resp and the displacements is the motion of the tip.

Run ``python examples/own_matrices.py``. It takes some seconds.
"""

from __future__ import annotations

from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np

import stickslip as ss

DATA = Path(__file__).parent / "data" / "blade_10_contacts.npz"


def main() -> dict[str, float]:
    """Print the peak and the contact states at the peak, and return the numbers."""
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
    print(f"friction dissipates {energy * 1e6:.1f} uJ in each cycle")
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
    """Plot the response with its linear limits, and the number of contacts in each state."""
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
